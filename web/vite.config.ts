import { defineConfig } from 'vite';

// Relative addresses: the program serves the page wherever it likes. three.js comes in one piece of 650 kB.
export default defineConfig({
  base: './',
  build: { target: 'es2022', assetsInlineLimit: 0, chunkSizeWarningLimit: 800, modulePreload: { polyfill: false } },
});
