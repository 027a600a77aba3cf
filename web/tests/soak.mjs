// Draws at random for some minutes; fails on a word in the console or when page or program grow.
//
//   node soak.mjs CHROMIUM PROGRAM [MINUTES]

import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { openPage, penStroke, rest, startBrowser, startStudio } from './driver.mjs';

const [chromium, program, minutes = '30'] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'inkrig-soak-'));
const browser = await startBrowser(chromium);
const studio = await startStudio(program, join(folder, 'project'));
let seed = 7;
const random = () => (seed = (seed * 48_271) % 2_147_483_647) / 2_147_483_647;
try {
  const { page, problems } = await openPage(browser, studio.address);
  const session = await page.context().newCDPSession(page);
  const heap = async () => {
    await session.send('HeapProfiler.collectGarbage');
    return (await session.send('Runtime.getHeapUsage')).usedSize / 1e6;
  };
  const end = Date.now() + Number(minutes) * 60_000;
  const seen = [];
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
    if (stroke % 25 === 24) {
      seen.push({ page: await heap(), program: studio.memory() });
      console.log(`${stroke + 1} strokes: page ${seen.at(-1).page.toFixed(0)} MB, program ${seen.at(-1).program.toFixed(0)} MB`);
    }
    assert.deepEqual(problems, []);
  }
  // Caches fill at first; from a third of the time on nothing may grow by more than a quarter.
  const settled = seen.slice(Math.floor(seen.length / 3));
  const [first, last] = [settled[0], settled.at(-1)];
  if (first && last) {
    assert.ok(last.page < 1.25 * first.page + 5, `the page grew from ${first.page} to ${last.page} MB`);
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
