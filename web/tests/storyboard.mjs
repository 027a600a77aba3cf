// Draws a storyboard with a pen in a real browser, makes an animation of it, and takes it home.
//
//   node storyboard.mjs CHROMIUM PROGRAM PICTURES

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { openPage, penStroke, picture, startBrowser, startStudio, until, violations } from './driver.mjs';

const [chromium, program, pictures] = process.argv.slice(2);
if (!pictures) {
  console.error('usage: node storyboard.mjs CHROMIUM PROGRAM PICTURES');
  process.exit(2);
}
// What is drawn: the strokes of a sample, thinned as a quick pen would.
const sample = JSON.parse(readFileSync(new URL('../../samples/storyboards/kick.json', import.meta.url), 'utf8')).frames[0];
const SHEET = '.sheet canvas';
const folder = mkdtempSync(join(tmpdir(), 'inkrig-storyboard-'));
const project = join(folder, 'project');
const browser = await startBrowser(chromium);
let studio = await startStudio(program, project);
let failures = 0;
let seen = [];

const kept = async () => (await fetch(new URL('api/storyboard', studio.address))).json();

try {
  const opened = await openPage(browser, studio.address);
  let { page } = opened;
  const { problems, state } = opened;
  seen = problems;

  await step('a frame is drawn with the pens', async () => {
    await page.getByRole('radio', { name: 'Storyboard' }).check({ force: true });
    const places = await scaled(page);
    for (const line of sample.body) await penStroke(page, SHEET, places(line), { pause: 4 });
    await page.keyboard.press('r');
    for (const way of sample.trajectories) await penStroke(page, SHEET, places(way.points), { pause: 12 });
    await page.getByRole('button', { name: 'Draw what stands around' }).click();
    await penStroke(page, SHEET, places(sample.scene[0]), { pause: 4 });
    await page.getByLabel('Word of the frame').fill('kick');
    await page.getByLabel('Word of the frame').press('Tab');
    const { board } = await until('the board in the project', async () => {
      const now = await kept();
      return now.board?.frames[0]?.word === 'kick' && now;
    });
    const [frame] = board.frames;
    assert.equal(frame.body.length, sample.body.length);
    assert.equal(frame.trajectories.length, sample.trajectories.length);
    assert.equal(frame.scene.length, 1);
    assert.equal(frame.trajectories[0].points[0].length, 3, 'the pen\u2019s time was lost');
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'storyboard-drawn-dark-1440') });
  });

  await step('the eraser takes a line, and undo brings it back', async () => {
    await page.locator(SHEET).focus();
    await page.keyboard.press('e');
    const places = await scaled(page);
    const [, trunk] = sample.body;
    const middle = trunk[Math.floor(trunk.length / 2)];
    await penStroke(page, SHEET, places([middle, [middle[0] + 1, middle[1]]]), { pause: 4 });
    await until('a line less', async () => (await kept()).board.frames[0].body.length === sample.body.length - 1);
    await page.locator(SHEET).focus();
    await page.keyboard.press('Control+z');
    await until('the line again', async () => (await kept()).board.frames[0].body.length === sample.body.length);
  });

  await step('frames are added, copied, moved and deleted by keys', async () => {
    await page.locator(SHEET).focus();
    await page.keyboard.press('Shift+N');
    await page.keyboard.press('n');
    await until('three frames', async () => (await kept()).board.frames.length === 3);
    await page.keyboard.press('{');
    await until('the empty one is the second', async () => !(await kept()).board.frames[1].body);
    assert.equal(await page.locator('.frame').count(), 3);
    await page.keyboard.press('Delete');
    await page.keyboard.press('Delete');
    await until('one frame', async () => (await kept()).board.frames.length === 1);
  });

  await step('the character does what was drawn', async () => {
    const before = await page.locator('#stage').screenshot();
    await page.getByRole('button', { name: 'Generate all' }).click();
    await page.getByRole('progressbar', { name: 'Progress' }).waitFor();
    const { made } = await until('the animation', async () => {
      const now = await kept();
      const said = await page.locator('.board-said.bad').count();
      assert.equal(said, 0, said ? await page.locator('.board-said').textContent() : '');
      return now.made && now;
    }, 240_000);
    const [frame] = made.frames;
    console.log(`  ${frame.frames} frames, ways of ${frame.ways.map((way) => way.joint).join(', ')}, ${(100 * frame.meanMiss).toFixed(1)} cm off the drawing`);
    assert.equal(frame.ways.length, sample.trajectories.length);
    assert.match(frame.ways[0].joint, /foot|ankle/);
    assert.ok(frame.joints.length >= 15, `${frame.joints.length} joints`);
    await until('the words of the result', async () => /off the drawing/.test(await page.locator('.board-said').textContent()));
    await page.locator(SHEET).focus();
    await until('another character', async () => !before.equals(await page.locator('#stage').screenshot()));
    const still = await page.locator('#stage').screenshot();
    await page.keyboard.press('End');
    await until('another pose at the end', async () => !still.equals(await page.locator('#stage').screenshot()));
    await page.screenshot({ path: picture(pictures, 'storyboard-made-dark-1440') });
    assert.deepEqual(await violations(page), []);
    await page.keyboard.press('Shift+D');
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'storyboard-made-light-1440') });
    await page.keyboard.press('Shift+D');
  });

  await step('it is taken home as a file', async () => {
    await page.getByRole('button', { name: 'Export', exact: true }).click();
    await page.locator('dialog select').first().selectOption('bvh');
    const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save file' }).click()]);
    const path = join(folder, 'kick.bvh');
    await file.saveAs(path);
    const [command, ...first] = [program].flat();
    const facts = JSON.parse(execFileSync(command, [...first, 'inspect', path, '--json'], { encoding: 'utf8' }));
    assert.match(JSON.stringify(facts), /right_foot/);
    await page.keyboard.press('Escape');
  });

  await step('another one is stopped', async () => {
    const { clip } = (await kept()).made;
    await page.locator(SHEET).focus();
    await page.keyboard.press('Control+Enter');
    await page.getByRole('button', { name: 'Cancel' }).click();
    await until('that it was stopped', async () => /Stopped/.test(await page.locator('.board-said').textContent()));
    const now = await kept();
    assert.equal(now.job, null);
    assert.equal(now.made.clip, clip);
  });

  await step('the storyboard is there after the program was killed', async () => {
    state.gone = true;
    await studio.kill();
    studio = await startStudio(program, project);
    const again = await openPage(browser, studio.address);
    page = again.page;
    await until('the drawing', async () => (await page.locator('.frame').count()) === 1);
    assert.ok(await page.locator(SHEET).isVisible(), 'the studio does not open with the storyboard');
    assert.equal(await page.getByLabel('Word of the frame').inputValue(), 'kick');
    assert.deepEqual(again.problems, []);
  });
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures > 0 ? 1 : 0);

/** From the sample's canvas to parts of the sheet: a figure of a good size in its middle. */
async function scaled(page) {
  const box = await page.locator(SHEET).boundingBox();
  const scale = (0.72 * box.height) / 330;
  return (line) => line.filter((_, i) => i % 2 === 0 || i === line.length - 1).map(([x, y]) => [0.54 + (scale * x) / box.width, 0.86 - (scale * y) / box.height]);
}

async function step(name, work) {
  const begun = Date.now();
  try {
    await work();
    console.log(`ok ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
  } catch (error) {
    failures += 1;
    console.log(`FAILED ${name}: ${error.stack}\n  the console said: ${seen.join('; ') || 'nothing'}`);
  }
}
