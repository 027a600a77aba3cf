// Draws a storyboard with a pen in a real browser, makes an animation of it, and takes it home.
//
//   node storyboard.mjs CHROMIUM PROGRAM PICTURES

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import typescript from 'typescript';

import { openPage, penStroke, picture, startBrowser, startStudio, until, violations } from './driver.mjs';

const [chromium, program, pictures] = process.argv.slice(2);
if (!pictures) {
  console.error('usage: node storyboard.mjs CHROMIUM PROGRAM PICTURES');
  process.exit(2);
}
// What is drawn: the strokes of a sample, thinned as a quick pen would.
const read = (name) => JSON.parse(readFileSync(new URL(`../../samples/storyboards/${name}.json`, import.meta.url), 'utf8'));
const sample = read('kick').frames[0];
// All that this project drew, and whose ways each frame has.
const ALL = {
  'walk-and-wave': [['pelvis|hip|spine'], ['right_wrist|left_wrist|elbow']],
  jump: [['pelvis|hip|spine'], ['pelvis|hip|spine']],
  'sit-down-and-stand-up': [['pelvis|hip|spine'], ['pelvis|hip|spine']],
  dance: [['wrist|elbow', 'wrist|elbow'], ['foot|ankle'], []],
  'turn-and-run': [[], ['pelvis|hip|spine']],
};
const SHEET = '.sheet canvas';
const folder = mkdtempSync(join(tmpdir(), 'inkrig-storyboard-'));
const project = join(folder, 'project');
// The page's own reader of poses.
const reader = typescript.transpileModule(readFileSync(new URL('../src/api/poses.ts', import.meta.url), 'utf8'), { compilerOptions: { module: 'esnext', target: 'esnext' } });
writeFileSync(join(folder, 'poses.mjs'), reader.outputText);
const { readPoses, rigOf } = await import(pathToFileURL(join(folder, 'poses.mjs')).href);
const browser = await startBrowser(chromium);
let studio = await startStudio(program, project);
// STUDIO_ONLY=regexp runs some steps.
const wanted = new RegExp(process.env.STUDIO_ONLY ?? '');
let failures = 0;
let seen = [];
let pageOf = () => null;

const kept = async () => (await fetch(new URL('api/storyboard', studio.address))).json();

try {
  const opened = await openPage(browser, studio.address);
  let { page } = opened;
  pageOf = () => page;
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

  await step('another motion of the frame is taken', async () => {
    const before = await made(null);
    const takes = page.getByRole('group', { name: 'Motions of the frame' }).getByRole('button');
    assert.equal(await takes.count(), 4);
    assert.equal(await takes.first().getAttribute('aria-pressed'), 'true');
    const misses = before.frames[0].takes.map((take) => take.meanMiss);
    assert.ok(misses.every((miss) => miss > 0 && miss < 0.5), String(misses));
    const begun = Date.now();
    await takes.nth(2).click();
    const after = await made(before.job);
    console.log(`  another motion after ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    assert.ok(Date.now() - begun < 8000, 'motions that were kept are made again');
    assert.equal((await kept()).board.frames[0].take, 2);
    assert.deepEqual(after.frames[0].takes, before.frames[0].takes, 'the motions themselves are the same');
    assert.notEqual(after.clip, before.clip);
    await until('the mark of the one that is taken', async () => (await takes.nth(2).getAttribute('aria-pressed')) === 'true');
    const { document } = await (await fetch(new URL('api/project', studio.address))).json();
    assert.ok(document.clips.every((clip) => clip.id !== before.clip), 'a clip is added each time');
    await takes.first().click();
    await made(after.job);
  });

  await step('joints are pinned by dragging, and freed', async () => {
    const joint = (await made(null)).frames[0].joints.find(({ name }) => name === 'left_wrist');
    await page.locator(SHEET).focus();
    await page.keyboard.press('v');
    const at = await seenAt(page, joint);
    const [dx, dy] = [0.05, -0.06];
    await penStroke(page, SHEET, Array.from({ length: 8 }, (_, i) => [at[0] + (dx * i) / 7, at[1] + (dy * i) / 7]), { pause: 8 });
    const pin = await until('the pin', async () => (await kept()).board.frames[0].pins?.find((one) => one.joint === 'left_wrist'));
    assert.ok(pin.at[0] > joint.x + 5 && pin.at[1] > joint.y + 5, JSON.stringify([joint, pin]));
    assert.match(await page.locator('.board-said').textContent(), /Changed since/);
    const before = await made(null);
    await page.keyboard.press('m');
    const after = await made(before.job);
    const now = after.frames[0].joints.find(({ name }) => name === 'left_wrist');
    assert.ok(now.pinned && Math.hypot(now.x - pin.at[0], now.y - pin.at[1]) < 0.11, JSON.stringify([now, pin]));
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'storyboard-pin-dark-1440') });
    await page.keyboard.press('Control+z');
    await until('no pin', async () => !(await kept()).board.frames[0].pins);
    await page.keyboard.press('Control+Shift+Z');
    await until('the pin again', async () => (await kept()).board.frames[0].pins?.length === 1);
    // A tap twice, or the eraser, or Delete on the chosen joint.
    const there = [at[0] + dx, at[1] + dy];
    for (let tap = 0; tap < 2; tap += 1) await penStroke(page, SHEET, [there, there], { pause: 4 });
    await until('it is free', async () => !(await kept()).board.frames[0].pins);
    for (let times = 0; times < 3; times += 1) await page.keyboard.press('j');
    await page.keyboard.press('Shift+ArrowRight');
    await until('a pin by keys', async () => (await kept()).board.frames[0].pins?.length === 1);
    await page.keyboard.press('Delete');
    await until('it is free again', async () => !(await kept()).board.frames[0].pins);
  });

  await step('camera and length of a frame', async () => {
    const gizmo = await page.locator('.gizmo').boundingBox();
    await page.mouse.move(gizmo.x + 22, gizmo.y + 22);
    await page.mouse.down();
    await page.mouse.move(gizmo.x + 2, gizmo.y + 12, { steps: 5 });
    await page.mouse.up();
    await until('the turned camera', async () => (await kept()).board.frames[0].camera?.yaw_degrees === 0);
    assert.equal((await kept()).board.frames[0].camera.pitch_degrees, 5);
    await page.getByLabel('Yaw of the camera').fill('20');
    await page.getByLabel('Pitch of the camera').fill('15');
    await page.getByLabel('Seconds of the frame').fill('1.5');
    await page.getByLabel('Seconds of the frame').press('Tab');
    await until('numbers', async () => {
      const { camera, seconds } = (await kept()).board.frames[0];
      return camera.yaw_degrees === 20 && camera.pitch_degrees === 15 && seconds === 1.5;
    });
    const before = await made(null);
    await page.getByRole('button', { name: 'Generate frame' }).click();
    assert.equal((await made(before.job)).frames[0].frames, 30);
    await page.locator(SHEET).focus();
    await page.keyboard.press('Control+z');
    await until('as long as is needed', async () => (await kept()).board.frames[0].seconds === undefined);
  });

  await step('one frame alone, then with the others', async () => {
    await page.keyboard.press('n');
    await page.getByLabel('Word of the frame').fill('walk');
    await page.getByLabel('Word of the frame').press('Tab');
    const before = await made(null);
    await page.locator(SHEET).focus();
    await page.keyboard.press('m');
    const alone = await made(before.job);
    assert.deepEqual(alone.frames.map(({ number, begins }) => [number, begins]).filter(([, begins]) => begins !== null), [[2, 0]], 'the first waits to be made');
    await page.getByRole('button', { name: 'Generate all' }).click();
    const all = await made(alone.job);
    assert.equal(all.frames.filter(({ begins }) => begins !== null).length, 2);
    assert.equal(all.transitions.length, 1);
    await page.keyboard.press('[');
    await page.getByLabel('Seconds of the frame').fill('1.2');
    await page.getByLabel('Seconds of the frame').press('Tab');
    await page.locator(SHEET).focus();
    await page.keyboard.press('m');
    const joined = await made(all.job);
    assert.equal(joined.frames.filter(({ begins }) => begins !== null).length, 2, 'the second was made already');
    assert.equal(joined.frames[0].frames, 24);
    assert.deepEqual(joined.frames[1].takes, all.frames[1].takes);
    // Moved frames keep their motions.
    await page.keyboard.press('}');
    await until('the other order', async () => (await kept()).board.frames[1].number === 1);
    await page.getByRole('button', { name: 'Generate all' }).click();
    const moved = await made(joined.job);
    assert.deepEqual(moved.frames.map(({ takes }) => takes), joined.frames.map(({ takes }) => takes).reverse());
    await page.locator(SHEET).focus();
    await page.keyboard.press('[');
    await page.keyboard.press('Delete');
    await until('one frame', async () => (await kept()).board.frames.length === 1);
    await page.getByRole('button', { name: 'Generate all' }).click();
    await made(moved.job);
  });

  await step('a joint is dragged in space', async () => {
    const before = await made(null);
    const stage = await page.locator('#stage').boundingBox();
    await page.keyboard.press('Home');
    for (let i = 0; i < 10; i += 1) await page.keyboard.press('.');
    // The camera stands still: were it to follow the character, what is moved would shift with the pelvis.
    await page.keyboard.press('c');
    // Somewhere over the character a joint lights up.
    const at = await (async () => {
      for (let y = 0.2; y < 0.8; y += 0.025) {
        for (let x = 0.3; x < 0.7; x += 0.02) {
          await page.mouse.move(stage.x + x * stage.width, stage.y + y * stage.height);
          if (/wrist/.test(await page.evaluate(() => document.querySelector('.handle:not([hidden])')?.textContent ?? ''))) return [stage.x + x * stage.width, stage.y + y * stage.height];
        }
      }
      throw new Error('no joint lights up');
    })();
    await page.mouse.down();
    await page.mouse.move(at[0] + 30, at[1] - 40, { steps: 6 });
    await page.screenshot({ path: picture(pictures, 'storyboard-space-dark-1440') });
    const begun = Date.now();
    await page.mouse.up();
    const after = await made(before.job);
    console.log(`  moved after ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    const [edit] = (await kept()).board.frames[0].edits;
    assert.match(edit.joint, /wrist/);
    assert.equal(edit.frame, 10);
    assert.ok(edit.at.every((value) => Math.abs(value) < 3), JSON.stringify(edit));
    assert.deepEqual(after.frames[0].takes, before.frames[0].takes, 'nothing is sampled again');
    await until('the joint where it was let go', async () => {
      await page.mouse.move(at[0] + 31, at[1] - 41);
      await page.mouse.move(at[0] + 30, at[1] - 40);
      return (await page.evaluate(() => document.querySelector('.handle:not([hidden])')?.textContent ?? '')) === edit.joint.replace('_', ' ');
    }, 5000);
    await page.keyboard.press('c');
    await page.getByRole('switch', { name: 'Lock ends' }).check({ force: true });
    const locked = await made(after.job);
    assert.equal((await kept()).board.frames[0].lock_ends, true);
    assert.deepEqual(await violations(page), []);
    await page.getByRole('button', { name: 'Undo all moves' }).click();
    await made(locked.job);
    assert.equal((await kept()).board.frames[0].edits, undefined);
    assert.equal(await page.getByRole('button', { name: 'Undo all moves' }).count(), 0);
  });

  await step('joints of a turned frame are moved in space, from another side and by keys', async () => {
    await page.locator(SHEET).focus();
    await page.keyboard.press('n');
    await page.getByLabel('Word of the frame').fill('walk');
    await page.getByLabel('Word of the frame').press('Tab');
    const alone = await made(null);
    await page.getByRole('button', { name: 'Generate all' }).click();
    const before = await made(alone.job);
    const { turn, begins, frames } = before.frames[1];
    assert.ok(Math.abs(turn) > 0.05, `the second frame is turned by ${turn} only, which shows nothing`);
    const now = begins + Math.floor(frames / 2);
    await page.locator(SHEET).focus();
    await page.keyboard.press('Home');
    for (let i = 0; i < now; i += 1) await page.keyboard.press('.');
    // The camera goes around by about a quarter; what stands in a corner of the picture is no joint.
    const stage = await page.locator('#stage').boundingBox();
    await page.mouse.move(stage.x + 0.9 * stage.width, stage.y + 0.15 * stage.height);
    await page.mouse.down();
    await page.mouse.move(stage.x + 0.9 * stage.width - 200, stage.y + 0.15 * stage.height + 20, { steps: 6 });
    await page.mouse.up();
    const lit = () => page.evaluate(() => document.querySelector('.handle:not([hidden])')?.textContent ?? '');
    const find = async (name) => {
      for (let y = 0.15; y < 0.85; y += 0.025) {
        for (let x = 0.2; x < 0.8; x += 0.02) {
          await page.mouse.move(stage.x + x * stage.width, stage.y + y * stage.height);
          if (name.test(await lit())) return [stage.x + x * stage.width, stage.y + y * stage.height];
        }
      }
      throw new Error(`${name} does not light up`);
    };
    const drag = async (name, [dx, dy], since) => {
      const at = await find(name);
      // The clip is replaced by the next one.
      const joint = (await lit()).replace(' ', '_');
      const [was, head] = [await jointOf(since.clip, joint, now), await jointOf(since.clip, 'head', 5)];
      await page.mouse.down();
      await page.mouse.move(at[0] + dx, at[1] + dy, { steps: 6 });
      await page.mouse.up();
      const after = await made(since.job);
      const edits = (await kept()).board.frames[1].edits;
      assert.equal(edits.length, 1, JSON.stringify(edits));
      const [edit] = edits;
      assert.equal(edit.joint, joint);
      assert.equal(edit.frame, now - begins);
      const put = inWorld(since.frames[1], edit.at);
      const off = apart(await jointOf(after.clip, joint, now), put);
      assert.ok(off < 0.015, `${edit.joint} is ${(100 * off).toFixed(1)} cm from where it was put`);
      assert.ok(apart(await jointOf(after.clip, 'head', 5), head) < 0.001, 'the first frame has moved');
      await until('the joint under the pointer', async () => {
        await page.mouse.move(at[0] + dx + 1, at[1] + dy);
        await page.mouse.move(at[0] + dx, at[1] + dy);
        return name.test(await lit());
      }, 5000);
      console.log(`  ${joint} moved by ${(100 * apart(was, put)).toFixed(1)} cm, ${(1000 * off).toFixed(1)} mm off`);
      return after;
    };
    const first = await drag(/wrist/, [24, -32], before);
    await page.locator(SHEET).focus();
    await page.keyboard.press('Control+z');
    await until('no edit', async () => !(await kept()).board.frames[1].edits?.length);
    const second = await drag(/left (ankle|foot|knee)/, [-22, -18], first);
    await page.screenshot({ path: picture(pictures, 'storyboard-space-turned') });
    // By keys: the next joints in turn, then up and to the right, as the camera stands.
    await page.mouse.move(stage.x + 4, stage.y + 4);
    await page.locator('#stage').focus();
    for (let times = 0; !/^head/.test(await lit()); times += 1) {
      assert.ok(times < 20, 'the head is never chosen');
      await page.keyboard.press('j');
    }
    await page.keyboard.press('Shift+ArrowUp');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('PageUp');
    await page.keyboard.press('PageUp');
    assert.match(await page.locator('#said').textContent(), /head: 4 cm up, 2 cm away; Enter puts it there/);
    await page.screenshot({ path: picture(pictures, 'storyboard-space-keys') });
    const was = await jointOf(second.clip, 'head', now);
    await page.keyboard.press('Enter');
    const third = await made(second.job);
    const is = await jointOf(third.clip, 'head', now);
    const { edits } = (await kept()).board.frames[1];
    assert.equal(edits.length, 2);
    const off = apart(is, inWorld(second.frames[1], edits[1].at));
    console.log(`  head by keys: ${is.map((value, i) => (100 * (value - was[i])).toFixed(1)).join(', ')} cm, ${(1000 * off).toFixed(1)} mm off`);
    assert.ok(off < 0.015 && Math.abs(is[1] - was[1] - 0.04) < 0.015, String(off));
    assert.match(await lit(), /^head/, 'the joint is not chosen any more');
    assert.deepEqual(await violations(page), []);
    await page.keyboard.press('Escape');
    assert.equal(await lit(), '');
    // Free again, the arrows turn the camera.
    const seen = await page.locator('#stage').screenshot();
    await page.keyboard.press('ArrowLeft');
    await until('the turned camera', async () => !seen.equals(await page.locator('#stage').screenshot()));
    await page.locator(SHEET).focus();
    await page.keyboard.press(']');
    await page.keyboard.press('Delete');
    await until('one frame', async () => (await kept()).board.frames.length === 1);
    await page.getByRole('button', { name: 'Generate all' }).click();
    await made(third.job);
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

  await step('a moving picture of one plays in the browser', async () => {
    const [command, ...first] = [program].flat();
    const board = new URL('../../samples/storyboards/kick.json', import.meta.url).pathname;
    execFileSync(command, [...first, 'storyboard', board, '-o', join(folder, 'kick.glb'), '--video', join(folder, 'kick.webm')], { stdio: 'pipe' });
    const bytes = readFileSync(join(folder, 'kick.webm'));
    const tab = await (await browser.newContext()).newPage();
    const shown = await tab.evaluate(async (text) => {
      const video = document.createElement('video');
      const heard = (name) => new Promise((done, fail) => {
        video.addEventListener(name, done, { once: true });
        video.addEventListener('error', () => fail(new Error(video.error.message)), { once: true });
      });
      const loaded = heard('loadeddata');
      video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], { type: 'video/webm; codecs="av01.0.04M.08"' }));
      await loaded;
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
      const at = async (seconds) => {
        const sought = heard('seeked');
        video.currentTime = seconds;
        await sought;
        const context = canvas.getContext('2d', { willReadFrequently: true });
        context.drawImage(video, 0, 0);
        return context.getImageData(0, 0, canvas.width, canvas.height).data;
      };
      // How many pixels of a half differ between two moments, and the paper's colour.
      const [early, late, again] = [await at(0.225), await at(1.525), await at(0.225)];
      const differ = (a, b, from, to) => {
        let count = 0;
        for (let y = 0; y < canvas.height; y += 1) {
          for (let x = from; x < to; x += 1) count += Math.abs(a[4 * (y * canvas.width + x) + 1] - b[4 * (y * canvas.width + x) + 1]) > 60 ? 1 : 0;
        }
        return count;
      };
      const half = canvas.width / 2;
      return { size: [canvas.width, canvas.height], duration: video.duration, drawing: differ(early, late, 0, half - 2), motion: differ(early, late, half + 2, canvas.width), same: differ(early, again, 0, canvas.width), paper: [...early.slice(0, 3)], seekable: video.seekable.end(0) };
    }, bytes.toString('base64'));
    await tab.context().close();
    console.log(`  ${(bytes.length / 1000).toFixed(0)} kB, ${shown.duration} s, ${shown.motion} pixels moved`);
    assert.deepEqual(shown.size, [680, 360]);
    assert.ok(shown.duration === 2 && shown.seekable === 2, JSON.stringify(shown));
    assert.ok(shown.motion > 300 && shown.drawing < 20 && shown.same === 0, JSON.stringify(shown));
    assert.ok(shown.paper.every((part) => part > 250), 'the paper is not white');
  });

  await step('another one is stopped', async () => {
    const { clip } = (await kept()).made;
    // What was made already would be there at once.
    await page.getByLabel('Seconds of the frame').fill('2.5');
    await page.getByLabel('Seconds of the frame').press('Tab');
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
    await until('what was made of it', async () => (await page.getByRole('group', { name: 'Motions of the frame' }).getByRole('button').count()) === 4);
    assert.equal(await page.getByRole('button', { name: 'Drawn poses and ways' }).count(), 1, 'the key pose is not shown');
    assert.deepEqual(again.problems, []);
  });

  for (const [name, frames] of Object.entries(ALL)) {
    await step(`${name}, drawn with a pen`, async () => {
      await clear(page);
      await page.locator('label.switch', { hasText: 'Pen' }).locator('input').uncheck({ force: true });
      const { frames: drawn } = read(name);
      const places = await scaled(page, drawn.flatMap((frame) => [...frame.body, ...(frame.trajectories ?? []).map((way) => way.points), ...(frame.scene ?? [])]));
      for (const [i, frame] of drawn.entries()) {
        if (i > 0) await page.keyboard.press('n');
        for (const [key, lines] of [['s', frame.scene], ['d', frame.body], ['r', frame.trajectories?.map((way) => way.points)], ['q', frame.speed_lines]]) {
          if (!lines?.length) continue;
          await page.keyboard.press(key);
          for (const line of lines) await penStroke(page, SHEET, places(line), { pause: 3 });
        }
        await page.getByLabel('Word of the frame').fill(frame.word);
        if (frame.seconds) await page.getByLabel('Seconds of the frame').fill(String(frame.seconds));
        await page.getByLabel('Word of the frame').focus();
        await page.getByLabel('Word of the frame').press('Tab');
        await page.locator(SHEET).focus();
      }
      await until('all of it', async () => {
        const { board } = await kept();
        return board.frames.length === drawn.length && board.frames.every((frame, i) => frame.body?.length === drawn[i].body.length && frame.word === drawn[i].word);
      });
      const before = await made(null);
      await page.getByRole('button', { name: 'Generate all' }).click();
      const done = await made(before?.job);
      await page.waitForTimeout(700);
      await page.screenshot({ path: picture(pictures, `storyboard-${name}`) });
      for (const [i, joints] of frames.entries()) {
        const { ways, meanMiss, worstMiss, word } = done.frames[i];
        console.log(`  ${word}: ways of ${ways.map((way) => way.joint).join(', ') || 'nothing'}, ${(100 * meanMiss).toFixed(1)} cm off the drawing, ${(100 * worstMiss).toFixed(1)} at most`);
        assert.equal(ways.length, joints.length, `frame ${i + 1}`);
        ways.forEach((way, k) => assert.match(way.joint, new RegExp(joints[k]), `frame ${i + 1}`));
        assert.ok(meanMiss < 0.15, `frame ${i + 1}: ${meanMiss} m`);
      }
      assert.equal(done.transitions.length, drawn.length - 1);
      assert.deepEqual(await violations(page), []);
    });
  }

  await step('on a narrow page, light', async () => {
    await page.setViewportSize({ width: 820, height: 1100 });
    await page.keyboard.press('Shift+D');
    assert.deepEqual(await violations(page), []);
    await page.waitForTimeout(500);
    await page.screenshot({ path: picture(pictures, 'storyboard-narrow-light') });
  });
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures > 0 ? 1 : 0);

/** The newest animation once it is another job's than `before`. */
async function made(before) {
  return until('the animation', async () => {
    const now = await kept();
    const said = await pageOf().locator('.board-said.bad').count();
    assert.equal(said, 0, said ? await pageOf().locator('.board-said').textContent() : '');
    return now.job === null && now.made?.job !== before && (now.made ?? before === null);
  }, 240_000);
}

/** A place of a frame's own space in the whole animation's. */
function inWorld({ turn, shift }, [x, y, z]) {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return [shift[0] + c * x + s * z, shift[1] + y, shift[2] + c * z - s * x];
}

function apart(a, b) {
  return Math.hypot(...a.map((value, i) => value - b[i]));
}

/** Where a joint of a clip of the project is, metres. */
async function jointOf(clip, name, frame) {
  const [facts, poses] = await Promise.all([fetch(new URL(`api/clips/${clip}`, studio.address)).then((answer) => answer.json()), fetch(new URL(`api/clips/${clip}/poses`, studio.address)).then((answer) => answer.arrayBuffer())]);
  const { body, positions } = readPoses(poses, rigOf(facts)).motion;
  const at = 3 * (frame * body.names.length + body.names.indexOf(name));
  return [...positions.subarray(at, at + 3)];
}

/** From the sample's canvas to parts of the sheet: all lines of a good size in its middle. */
async function scaled(page, lines = [...sample.body, ...sample.trajectories.map((way) => way.points), ...sample.scene]) {
  const box = await page.locator(SHEET).boundingBox();
  const all = lines.flat();
  const ends = (axis) => [Math.min(...all.map((row) => row[axis])), Math.max(...all.map((row) => row[axis]))];
  const [[x0, x1], [y0, y1]] = [ends(0), ends(1)];
  const scale = Math.min((0.62 * box.width) / (x1 - x0), (0.84 * box.height) / (y1 - y0));
  const place = ([x, y]) => [0.5 + (scale * (x - (x0 + x1) / 2)) / box.width, 0.5 - (scale * (y - (y0 + y1) / 2)) / box.height];
  const step = (line) => Math.max(2, Math.ceil(line.length / 16));
  return (line) => line.filter((_, i) => i % step(line) === 0 || i === line.length - 1).map(place);
}

/** Where a place of the frame's canvas is on the sheet, as parts of it: by a line whose places are known on both. */
async function seenAt(page, { x, y }) {
  const box = await page.locator(SHEET).boundingBox();
  const view = await page.locator(SHEET).evaluate((canvas) => JSON.parse(canvas.dataset.view));
  return [(view.x + view.scale * x) / box.width, (view.y - view.scale * y) / box.height];
}

/** An empty frame, whatever was there. */
async function clear(page) {
  await page.locator(SHEET).focus();
  await page.keyboard.press('d');
  await page.keyboard.press('n');
  while ((await page.locator('.frame').count()) > 1) {
    await page.keyboard.press('[');
    await page.keyboard.press('Delete');
  }
}

async function step(name, work) {
  if (!wanted.test(name)) return;
  const begun = Date.now();
  try {
    await work();
    console.log(`ok ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
  } catch (error) {
    failures += 1;
    console.log(`FAILED ${name}: ${error.stack}\n  the console said: ${seen.join('; ') || 'nothing'}`);
  }
}
