// What every test of the studio needs: the program, a browser that fails on any word in its console, a pen.

import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { setTimeout as rest } from 'node:timers/promises';

const require = createRequire(import.meta.url);
const { chromium: driver } = require('playwright-core');
const AXE = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

// The driver's own notes on reading pixels back: caused by our screenshots, and never seen by a user.
const NOT_THE_PAGE = /GL Driver Message/;
// What a browser says when the program is gone; only while a test has stopped it.
const GONE = /ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY_RESPONSE|ERR_NETWORK|WebSocket connection|Failed to load resource/;

export { rest };

/** Starts `inkrig studio` on a free port; resolves when it says where it is. `program` may be a list, of what starts it too. */
export async function startStudio(program, project, files = [], more = []) {
  const [command, ...first] = [program].flat();
  const child = spawn(command, [...first, 'studio', '--port', '0', '--project', project, ...more, ...files], { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  const address = await new Promise((done, fail) => {
    const hear = (data) => {
      said += data;
      const found = /http:\/\/[^\s]+/.exec(said);
      if (found) done(found[0]);
    };
    child.stdout.on('data', hear);
    child.stderr.on('data', hear);
    child.on('exit', (code) => fail(new Error(`the studio ended (${code}): ${said}`)));
    setTimeout(() => fail(new Error(`the studio said no address within 60 s: ${said}`)), 60_000).unref();
  });
  return {
    address,
    kill: () => new Promise((done) => (child.exitCode === null && child.signalCode === null ? (child.on('exit', done), child.kill('SIGKILL')) : done())),
    said: () => said,
    memory: () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${child.pid}/status`, 'utf8'))?.[1] ?? 0) / 1024,
  };
}

export async function startBrowser(chromium, more = []) {
  return driver.launch({
    executablePath: chromium,
    headless: true,
    args: [
      '--no-sandbox',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
      '--autoplay-policy=no-user-gesture-required',
      // Build servers have no graphics card; said outright, Chromium does not warn of it in the console.
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      // Putting the page together by simulated graphics would cost more than the page.
      '--disable-gpu-compositing',
      ...more,
    ],
  });
}

/** A page that remembers every warning, error and request that leaves the program. */
export async function openPage(browser, address, { size = { width: 1440, height: 900 }, scheme = 'dark', guided = true, device = {} } = {}) {
  const context = await browser.newContext({ viewport: size, colorScheme: scheme, acceptDownloads: true, ...device });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  const problems = [];
  const state = { gone: false };
  page.on('console', (message) => {
    if (message.type() !== 'error' && message.type() !== 'warning') return;
    if (NOT_THE_PAGE.test(message.text()) || (state.gone && GONE.test(message.text()))) return;
    problems.push(`console ${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => problems.push(`page error: ${error.message}`));
  page.on('crash', () => problems.push('the page crashed'));
  page.on('request', (request) => {
    if (!request.url().startsWith(new URL(address).origin) && !/^(data|blob):/.test(request.url())) problems.push(`a request left the program: ${request.url()}`);
  });
  if (guided) await page.addInitScript(() => localStorage.setItem('inkrig.guided', '1'));
  await page.goto(address);
  await page.locator('#status .spring').waitFor({ state: 'attached' });
  await page.waitForFunction(() => /Saved/.test(document.querySelector('#status')?.textContent ?? ''));
  return { page, context, problems, state };
}

/** Saves what the page downloads when `act` is done. */
export async function saved(page, path, act) {
  const [got] = await Promise.all([page.waitForEvent('download'), act()]);
  await got.saveAs(path);
}

/** Runs the steps of a test by name; where one fails, says what `tell` knows and takes pictures of the open pages. */
export function stepper(browser, pictures, wanted, tell) {
  return async (name, work) => {
    if (!wanted(name)) return;
    const begin = Date.now();
    try {
      await work();
      console.log(`ok    ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    } catch (error) {
      console.error(`FAILED ${name}`);
      console.error(...(await tell().catch((problem) => [String(problem)])));
      for (const page of browser.contexts().flatMap((context) => context.pages())) {
        console.error(await page.locator('.toast').allInnerTexts());
        await page.screenshot({ path: picture(pictures, 'failed') });
      }
      throw error;
    }
  };
}

/** Draws with a pen whose pressure changes; `places` are parts (0 to 1) of an element. */
export async function penStroke(page, selector, places, { pause = 12, during = null } = {}) {
  const session = await page.context().newCDPSession(page);
  const box = await page.locator(selector).boundingBox();
  const send = (type, [x, y], i) =>
    session.send('Input.dispatchMouseEvent', {
      type,
      x: box.x + x * box.width,
      y: box.y + y * box.height,
      button: 'left',
      buttons: type === 'mouseReleased' ? 0 : 1,
      pointerType: 'pen',
      force: 0.25 + 0.6 * Math.abs(Math.sin(i / 14)),
      clickCount: 1,
    });
  await send('mousePressed', places[0], 0);
  const waits = [];
  for (let i = 1; i < places.length; i += 1) {
    waits.push(send('mouseMoved', places[i], i));
    await rest(pause);
    if (during && i === Math.floor(places.length / 2)) {
      await Promise.all(waits.splice(0));
      await during();
    }
  }
  await Promise.all(waits);
  if (during !== KEEP_DOWN) await send('mouseReleased', places.at(-1), places.length);
  await session.detach();
}

/** As `during` of a stroke: the pen stays on the paper. */
export const KEEP_DOWN = async () => undefined;

/** A spiral of some turns about the middle. */
export function spiral(turns = 4, count = 160, [cx, cy] = [0.55, 0.5], size = 0.36) {
  return Array.from({ length: count }, (_, i) => {
    const part = i / (count - 1);
    const angle = 2 * Math.PI * turns * part;
    const radius = size * (0.12 + 0.88 * part);
    return [cx + radius * Math.cos(angle) * 0.9, cy + radius * Math.sin(angle)];
  });
}

/** Drops files on the page as a file manager does. */
export async function dropFiles(page, files) {
  const data = files.map(({ name, bytes }) => ({ name, text: Buffer.from(bytes).toString('base64') }));
  await page.evaluate((list) => {
    const transfer = new DataTransfer();
    for (const { name, text } of list) transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    window.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, data);
}

/** What axe-core finds on the page as it is. */
export async function violations(page) {
  await page.evaluate(AXE);
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return found.violations.map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map(({ target, failureSummary }) => `${target.join(' ')} (${failureSummary.split('\n').slice(1).join(' ').trim()})`).join('; ')}`);
}

export function picture(folder, name) {
  return join(folder, `${name}.png`);
}

/** Waits until `check` gives something true. */
export async function until(what, check, patience = 60_000) {
  const end = Date.now() + patience;
  for (;;) {
    const found = await check();
    if (found) return found;
    if (Date.now() > end) throw new Error(`not within ${patience / 1000} s: ${what}`);
    await rest(60);
  }
}

/** The full result of what the project is now is shown. */
export async function finished(page) {
  await until('the full result', () => page.evaluate(() => document.querySelector('#status .chip') !== null && !/Preview|Solving/.test(document.querySelector('#status')?.textContent ?? '')), 90_000);
  const pause = page.getByRole('button', { name: 'Pause', exact: true });
  if (await pause.isVisible()) await pause.click();
}

/** Six seconds of two beats that take turns, as a WAV file. */
export function beat() {
  const rate = 16_000;
  const samples = new Int16Array(6 * rate);
  for (let i = 0; i < samples.length; i += 1) {
    const t = i / rate;
    const since = t % 0.5;
    const tone = Math.floor(t / 0.5) % 2 === 0 ? 110 : 440;
    samples[i] = 20_000 * Math.exp(-9 * since) * Math.sin(2 * Math.PI * tone * t);
  }
  const head = Buffer.alloc(44);
  head.write('RIFF', 0);
  head.writeUInt32LE(36 + samples.byteLength, 4);
  head.write('WAVEfmt ', 8);
  head.writeUInt32LE(16, 16);
  head.writeUInt16LE(1, 20);
  head.writeUInt16LE(1, 22);
  head.writeUInt32LE(rate, 24);
  head.writeUInt32LE(2 * rate, 28);
  head.writeUInt16LE(2, 32);
  head.writeUInt16LE(16, 34);
  head.write('data', 36);
  head.writeUInt32LE(samples.byteLength, 40);
  return Buffer.concat([head, Buffer.from(samples.buffer)]);
}
