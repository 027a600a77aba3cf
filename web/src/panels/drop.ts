import { h } from '../base/dom';
import type { Files } from '../document/files';

/** Files may be dropped anywhere on the page. */
export function acceptDrops(files: Files): void {
  let depth = 0;
  const over = (is: boolean) => document.body.classList.toggle('dropping', is);
  const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
  window.addEventListener('dragenter', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    depth += 1;
    over(true);
  });
  window.addEventListener('dragleave', () => {
    depth = Math.max(depth - 1, 0);
    if (depth === 0) over(false);
  });
  window.addEventListener('dragover', (event) => {
    if (hasFiles(event)) event.preventDefault();
  });
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    depth = 0;
    over(false);
    void files.take([...(event.dataTransfer?.files ?? [])]);
  });
}

/** Opens the system's dialog for files. */
export function pickFiles(files: Files, accept = ''): void {
  const input = h('input', { type: 'file', multiple: true, accept });
  input.addEventListener('change', () => void files.take([...(input.files ?? [])]));
  input.click();
}
