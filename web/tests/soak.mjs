// Draws at random for some minutes; fails on a word in the console or when page or program grow.
//
//   node soak.mjs CHROMIUM PROGRAM [MINUTES] [WHAT ELSE THE STUDIO IS TOLD...]

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { openPage, penStroke, rest, startBrowser, startStudio } from './driver.mjs';

const [chromium, program, minutes = '30', ...more] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'inkrig-soak-'));
const browser = await startBrowser(chromium);
const studio = await startStudio(program, join(folder, 'project'), [], more);
let seed = 7;
const random = () => (seed = (seed * 48_271) % 2_147_483_647) / 2_147_483_647;
try {
  const { page, problems } = await openPage(browser, studio.address);
  const session = await page.context().newCDPSession(page);
  const heap = async () => {
    await session.send('HeapProfiler.collectGarbage');
    return (await session.send('Runtime.getHeapUsage')).usedSize / 1e6;
  };
  const whole = await browser.newBrowserCDPSession();
  const browserMemory = async () => {
    const { processInfo } = await whole.send('SystemInfo.getProcessInfo');
    return processInfo.reduce((sum, { id }) => sum + resident(id), 0);
  };
  const begin = Date.now();
  const end = begin + Number(minutes) * 60_000;
  const seen = [];
  let next = begin;
  const look = async (strokes) => {
    const now = { page: await heap(), browser: await browserMemory(), program: studio.memory() };
    seen.push(now);
    const minute = (Date.now() - begin) / 60_000;
    console.log(`${minute.toFixed(1)} min, ${strokes} strokes: page's objects ${now.page.toFixed(1)} MB, browser ${now.browser.toFixed(0)} MB, program ${now.program.toFixed(0)} MB, ${problems.length} words in the console`);
  };
  for (let stroke = 0; Date.now() < end; stroke += 1) {
    await page.keyboard.press(['d', 'd', 'r', 'a'][Math.floor(random() * 4)] ?? 'd');
    let [x, y, dx, dy] = [0.3 + 0.4 * random(), 0.3 + 0.4 * random(), 0, 0];
    const places = Array.from({ length: 40 + Math.floor(80 * random()) }, () => {
      [dx, dy] = [0.85 * dx + 0.012 * (random() - 0.5) - 0.002 * (x - 0.5), 0.85 * dy + 0.012 * (random() - 0.5) - 0.002 * (y - 0.5)];
      [x, y] = [Math.min(Math.max(x + dx, 0.15), 0.95), Math.min(Math.max(y + dy, 0.05), 0.95)];
      return [x, y];
    });
    await penStroke(page, '#pen', places, { pause: 8 });
    if (random() < 0.3) await page.keyboard.press('Control+z');
    if (random() < 0.2) await page.keyboard.press('Space');
    await rest(100 + 300 * random());
    if (Date.now() >= next) {
      await look(stroke + 1);
      next += 60_000;
    }
    assert.deepEqual(problems, []);
  }
  await look('all');
  // Caches fill at first; from a third of the time on nothing may grow by more than a quarter.
  const settled = seen.slice(Math.floor(seen.length / 3));
  const [first, last] = [settled[0], settled.at(-1)];
  if (first && last) {
    assert.ok(last.page < 1.25 * first.page + 5, `the page grew from ${first.page} to ${last.page} MB`);
    assert.ok(last.browser < 1.25 * first.browser + 50, `the browser grew from ${first.browser} to ${last.browser} MB`);
    assert.ok(last.program < 1.25 * first.program + 20, `the program grew from ${first.program} to ${last.program} MB`);
  }
} catch (error) {
  console.error(error);
  process.exitCode = 1;
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}

/** Megabytes that a process holds; 0 when it is gone. */
function resident(id) {
  try {
    return Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${id}/status`, 'utf8'))?.[1] ?? 0) / 1024;
  } catch {
    return 0;
  }
}
