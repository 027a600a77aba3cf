// Drives the real program in a real browser as a user would, and fails on any word in the console.
//
//   node studio.mjs CHROMIUM PROGRAM PICTURES
//
// INKRIG_REFERENCE is a folder of motion and sound that is dropped on the page when it is there.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

import { beat, dropFiles, finished, KEEP_DOWN, openPage, penStroke, picture, rest, saved, spiral, startBrowser, startStudio, stepper, until, violations } from './driver.mjs';

const [chromium, program, pictures] = process.argv.slice(2);
if (!pictures) {
  console.error('usage: node studio.mjs CHROMIUM PROGRAM PICTURES');
  process.exit(2);
}
const reference = process.env.INKRIG_REFERENCE ?? '';
const only = process.env.STUDIO_ONLY ?? '';
const folder = mkdtempSync(join(tmpdir(), 'inkrig-studio-'));
const browser = await startBrowser(chromium);
let studio = await startStudio(program, join(folder, 'project'));
let failures = 0;
/** Words in the console, to be told when a step fails. */
let seen = [];

const begins = (name) => name.startsWith('the first') || name.startsWith('a pen');
const step = stepper(browser, pictures, (name) => new RegExp(only).test(name) || begins(name), async () => [seen, await solved()]);

const history = async () => (await (await fetch(new URL('api/project', studio.address))).json());
const doc = async () => (await history()).document;

try {
  const opened = await openPage(browser, studio.address, { guided: false });
  const { page, problems, state } = opened;
  seen = problems;

  await step('the first run opens the sample and the tour', async () => {
    await page.locator('.coach').waitFor();
    await page.screenshot({ path: picture(pictures, 'first-dark-1440') });
    assert.deepEqual(await violations(page), []);
    await page.getByRole('button', { name: 'Leave' }).click();
    const load = await page.evaluate(() => ({
      files: performance.getEntriesByType('resource').map((entry) => entry.name).filter((name) => /assets/.test(name)),
      milliseconds: performance.getEntriesByType('navigation')[0].loadEventEnd,
    }));
    const bodies = await Promise.all(load.files.map(async (file) => gzipSync(new Uint8Array(await (await fetch(file)).arrayBuffer())).length));
    load.bytes = bodies.reduce((sum, bytes) => sum + bytes, 0);
    console.log(`  first load ${(load.bytes / 1000).toFixed(0)} kB gzip, ${load.milliseconds.toFixed(0)} ms`);
    assert.ok(load.bytes < 300_000, `first load of ${load.bytes} bytes`);
    if (process.env.STUDIO_TIMES) assert.ok(load.milliseconds < 1000, `first load took ${load.milliseconds} ms`);
  });

  await step('a pen stroke moves the character while the pen is down', async () => {
    await page.getByRole('tab', { name: 'Poses' }).click();
    const before = await page.locator('#stage').screenshot();
    let during = before;
    await penStroke(page, '#pen', spiral(), {
      during: async () => {
        await until('poses while the pen is down', () => page.evaluate(() => performance.getEntriesByName('pen to pose').length > 0));
        during = await page.locator('#stage').screenshot();
      },
    });
    assert.ok(!before.equals(during), 'the picture did not change while the pen was down');
    const control = await until('the drawing in the project', async () => (await doc()).control);
    assert.equal(control.kind, 'curve');
    const pressures = control.strokes.flat().map((point) => point[3]);
    assert.ok(Math.max(...pressures) - Math.min(...pressures) > 0.3, 'pressure was lost');
    await finished(page);
    await page.screenshot({ path: picture(pictures, 'drawn-dark-1440') });
    await latency(page);
    await frames(page);
  });

  await step('every kind of key', async () => {
    for (const kind of ['soft', 'hard', 'avoid', 'never']) {
      await page.locator(`#side input[value="${kind}"]`).first().check({ force: true });
      await drag(page, page.locator('.pose').nth(['soft', 'hard', 'avoid', 'never'].indexOf(kind)), '#pen', 0.62, 0.3);
      await until(`a key of kind ${kind}`, async () => (await doc()).keys.some((key) => key.kind === kind));
    }
    const { keys } = await doc();
    assert.equal(keys.find((key) => key.kind === 'hard').place.kind, 'time');
    assert.equal(keys.find((key) => key.kind === 'soft').place.kind, 'point');
    await page.locator('.pose').nth(4).focus();
    await page.keyboard.press('Enter');
    await until('a key by keyboard', async () => (await doc()).keys.length === 5);
    await finished(page);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'keys-dark-1440') });
  });

  await step('a link pulled on the plan becomes a key', async () => {
    const { keys } = await doc();
    const used = await page.evaluate(async (base) => {
      const project = await (await fetch(new URL('api/project', base))).json();
      return (await fetch(new URL(`api/results/${project.result}`, base))).json();
    }, studio.address);
    const box = await page.locator('#head').boundingBox();
    const [frame] = used.used.frame.slice(Math.floor(used.used.frame.length / 2));
    const source = await (await fetch(new URL(`api/clips/${used.clipForSkeleton}`, studio.address))).json();
    const x = box.x + 76 + (box.width - 90) / 2;
    const top = 46;
    const y = box.y + top + (box.height - top - 10) * (1 - frame / (source.frames - 1));
    await page.mouse.move(x, y);
    await page.mouse.down();
    const to = y > box.y + box.height / 2 ? box.y + top + 12 : box.y + box.height - 22;
    await page.mouse.move(x, to, { steps: 5 });
    await page.mouse.up();
    await until('the key of the link', async () => (await doc()).keys.length === keys.length + 1);
  });

  await step('undo and redo', async () => {
    const { keys } = await doc();
    await page.keyboard.press('Control+z');
    await until('one key less', async () => (await doc()).keys.length === keys.length - 1);
    await page.keyboard.press('Control+Shift+z');
    await until('the key again', async () => (await doc()).keys.length === keys.length);
    await page.keyboard.press('Control+z');
    await page.reload();
    await page.locator('#status .spring').waitFor({ state: 'attached' });
    await page.keyboard.press('Control+Shift+z');
    await until('redo outlives a reload', async () => (await doc()).keys.length === keys.length);
  });

  await step('redrawing a stretch keeps the rest', async () => {
    const before = (await doc()).control.strokes.flat();
    await page.keyboard.press('r');
    await penStroke(page, '#pen', Array.from({ length: 24 }, (_, i) => [0.8 + 0.05 * Math.sin(i / 4), 0.45 + (0.14 * i) / 24]));
    await until('another drawing', async () => JSON.stringify((await doc()).control.strokes.flat()) !== JSON.stringify(before));
    const after = (await doc()).control.strokes.flat();
    const kept = after.filter((point) => before.some((other) => Math.abs(other[0] - point[0]) + Math.abs(other[1] - point[1]) < 1e-3));
    assert.ok(kept.length > 0.4 * after.length, `only ${kept.length} of ${after.length} points were kept`);
    await page.keyboard.press('d');
  });

  await step('adjusting: structure, loop, in place, alternatives', async () => {
    await page.getByRole('tab', { name: 'Adjust' }).click();
    const slider = page.getByRole('slider', { name: 'Structure or naturalness' });
    await slider.focus();
    for (let i = 0; i < 5; i += 1) await page.keyboard.press('ArrowLeft');
    await page.getByRole('switch', { name: 'Seamless loop' }).click();
    await page.getByLabel('Root').selectOption('inPlace');
    await until('the settings', async () => {
      const { settings } = await doc();
      return settings.loop && settings.root === 'inPlace' && settings.structure !== null;
    });
    await finished(page);
    await page.getByRole('button', { name: 'Find alternatives' }).click();
    await until('an end of the search', () => page.getByRole('button', { name: 'Find alternatives' }).isEnabled(), 120_000);
    assert.deepEqual(await violations(page), []);
    await page.getByLabel('Root').selectOption('travel');
    await page.getByRole('switch', { name: 'Seamless loop' }).click();
  });

  await step('a waveform by expression and by pen', async () => {
    await page.getByRole('radio', { name: 'Wave' }).check({ force: true });
    await until('the expression', async () => (await doc()).control?.kind === 'wave');
    await finished(page);
    await page.screenshot({ path: picture(pictures, 'wave-dark-1440') });
    await penStroke(page, '.editor:not([hidden]) > canvas', Array.from({ length: 50 }, (_, i) => [0.3 + (0.4 * i) / 50, 0.4 + 0.2 * Math.sin(i / 5)]));
    await until('the drawn wave', async () => (await doc()).control?.kind === 'drawnWave');
    assert.deepEqual(await violations(page), []);
  });

  await step('labels', async () => {
    await page.getByRole('radio', { name: 'Labels' }).check({ force: true });
    await until('the labels', async () => (await doc()).control?.kind === 'labels');
    await page.getByLabel('Name of segment 1').fill('walk');
    await page.getByLabel('Name of segment 1').press('Enter');
    const border = await page.locator('.border').first().boundingBox();
    await page.mouse.move(border.x + 6, border.y + 30);
    await page.mouse.down();
    await page.mouse.move(border.x + 60, border.y + 30, { steps: 6 });
    await page.mouse.up();
    await until('the border', async () => {
      const { segments } = (await doc()).control;
      return segments[0].name === 'walk' && segments[0].seconds > 3;
    });
    await page.getByRole('button', { name: 'Add a segment' }).click();
    await until('one more label', async () => (await doc()).control.segments.length === 4);
    await finished(page);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'labels-dark-1440') });
  });

  await step('a sound', async () => {
    await dropFiles(page, [{ name: 'beat.wav', bytes: beat() }]);
    await until('the sound', async () => (await doc()).control?.kind === 'sound');
    await finished(page);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'sound-dark-1440') });
    await page.getByRole('button', { name: 'Play', exact: true }).click();
    await rest(1200);
    const apart = await until('the sound in time with the motion', () =>
      page.evaluate(() => {
        const audio = document.querySelector('audio');
        const time = Number(document.querySelector('.scrubber').value) / Number(document.querySelector('.scrubber').max);
        return !audio.paused && audio.currentTime > 0.3 ? Math.abs(audio.currentTime - time * audio.duration) : null;
      }),
    );
    assert.ok(apart < 0.25, `the sound is ${apart} s off`);
    await page.getByRole('button', { name: 'Pause', exact: true }).click();
  });

  await step('another motion as control', async () => {
    await page.getByRole('radio', { name: 'Motion' }).check({ force: true });
    await page.getByRole('tab', { name: 'Files' }).click();
    await page.getByRole('button', { name: 'quadruped' }).click();
    await until('the motion', async () => (await doc()).control?.kind === 'motion');
    await finished(page);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'motion-dark-1440') });
  });

  await step('a dropped file', async () => {
    const [file] = existsSync(join(reference, 'data/cmu')) ? readdirSync(join(reference, 'data/cmu'), { recursive: true }).filter((name) => name.endsWith('.bvh')) : [];
    if (!file) {
      console.log(`  skipped: no folder ${reference}/data/cmu`);
      assert.ok(!process.env.CI, 'the reference data is missing');
      return;
    }
    await page.getByRole('radio', { name: 'Draw' }).check({ force: true });
    const before = (await doc()).clips.length;
    await dropFiles(page, [{ name: 'dropped.bvh', bytes: readFileSync(join(reference, 'data/cmu', file)) }]);
    await until('the clip', async () => (await doc()).clips.length > before);
    await until('it is arranged', async () => {
      const { clips, source } = await doc();
      return source.clips.includes(clips.at(-1).id);
    });
    await finished(page);
  });

  await step('the report and the map', async () => {
    for (const name of ['Report', 'Map', 'Files']) {
      await page.getByRole('tab', { name }).click();
      await rest(300);
      assert.deepEqual(await violations(page), [], name);
      await page.screenshot({ path: picture(pictures, `${name.toLowerCase()}-dark-1440`) });
    }
  });

  await step('export to BVH and GLB, read back', async () => {
    await page.keyboard.press('Control+e');
    await page.locator('dialog[open]').waitFor();
    await rest(400);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'export-dark-1440') });
    for (const format of ['bvh', 'glb']) {
      await page.getByLabel('Format').selectOption(format);
      const path = join(folder, `out.${format}`);
      await saved(page, path, () => page.getByRole('button', { name: 'Save file' }).click());
      const said = execFileSync(program, ['inspect', path], { encoding: 'utf8' });
      assert.match(said, /frames/i);
    }
    await page.keyboard.press('Escape');
    await page.keyboard.press('?');
    await page.locator('dialog[open]').waitFor();
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'shortcuts-dark-1440') });
    await page.keyboard.press('Escape');
  });

  await step('a dropped character takes the motion, with a certificate', async () => {
    const file = join(reference, 'data/creatures/human-model.glb');
    if (!existsSync(file)) {
      console.log(`  skipped: no ${file}`);
      assert.ok(!process.env.CI, 'the reference data is missing');
      return;
    }
    await finished(page);
    const { source } = await doc();
    await page.keyboard.press('Control+e');
    await page.locator('dialog[open]').waitFor();
    await dropFiles(page, [{ name: 'hero.glb', bytes: readFileSync(file) }]);
    const rows = page.locator('dialog[open] table tbody tr');
    await rows.first().waitFor();
    assert.ok((await rows.count()) > 8, 'the certificate has few rows');
    assert.match(await page.locator('dialog[open] .note').first().innerText(), /\d+ joints follow/);
    assert.deepEqual((await doc()).source, source, 'the character was arranged');
    assert.deepEqual(await violations(page), []);
    await page.locator('dialog[open] table').scrollIntoViewIfNeeded();
    await page.screenshot({ path: picture(pictures, 'certificate-dark-1440') });
    await page.getByLabel('Format').selectOption('glb');
    const path = join(folder, 'hero-out.glb');
    await saved(page, path, () => page.getByRole('button', { name: 'Save file' }).click());
    assert.match(execFileSync(program, ['inspect', path], { encoding: 'utf8' }), /frames/i);
    assert.ok(readFileSync(path).length > readFileSync(file).length, 'no copy of the character with a clip more');
    await page.keyboard.press('Escape');

    await page.getByRole('tab', { name: 'Files' }).click();
    const show = page.getByRole('button', { name: 'Show the motion on hero' });
    const capsules = await page.locator('#stage').screenshot();
    await show.click();
    await until('the mesh', async () => !capsules.equals(await page.locator('#stage').screenshot()));
    await rest(1500);
    await page.screenshot({ path: picture(pictures, 'character-dark-1440') });
    const still = await page.locator('#stage').screenshot();
    for (let i = 0; i < 12; i += 1) await page.keyboard.press('.');
    await until('the mesh moves', async () => !still.equals(await page.locator('#stage').screenshot()));
    await show.click();
    await until('the capsules again', async () => (await show.getAttribute('aria-pressed')) === 'false');
  });

  await step('a reference video plays beside the motion', async () => {
    const bytes = await page.evaluate(async () => {
      const canvas = document.createElement('canvas');
      const context = canvas.getContext('2d');
      const recorder = new MediaRecorder(canvas.captureStream(15), { mimeType: 'video/webm' });
      const parts = [];
      recorder.ondataavailable = ({ data }) => parts.push(data);
      const done = new Promise((stop) => (recorder.onstop = stop));
      recorder.start();
      for (let i = 0; i < 20; i += 1) {
        context.fillStyle = `hsl(${18 * i} 80% 50%)`;
        context.fillRect(0, 0, 300, 150);
        await new Promise((next) => setTimeout(next, 60));
      }
      recorder.stop();
      await done;
      return [...new Uint8Array(await new Blob(parts).arrayBuffer())];
    });
    await dropFiles(page, [{ name: 'take.webm', bytes }]);
    await until('the video', () => page.evaluate(() => [...document.querySelectorAll('video')].some((video) => video.readyState >= 2 && video.offsetWidth > 0)));
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(pictures, 'video-dark-1440') });
    await page.getByRole('button', { name: 'Remove the reference video' }).click();
  });

  await step('killed in the middle of a stroke, nothing is lost', async () => {
    await page.getByRole('radio', { name: 'Draw' }).check({ force: true });
    const drawn = await doc();
    const steps = (await history()).history.undo.length;
    await penStroke(page, '#pen', spiral(3, 90), { during: KEEP_DOWN });
    state.gone = true;
    await rest(500);
    await studio.kill();
    studio = await startStudio(program, join(folder, 'project'));
    const again = await doc();
    assert.deepEqual(again.keys, drawn.keys);
    assert.equal(again.control?.kind, 'curve');
    assert.ok(again.control.strokes.flat().length > 30, 'the stroke so far was lost');
    const past = (await history()).history.undo.length;
    assert.ok(past > steps, `undo had ${steps} steps before the stroke and has ${past} after the crash`);
  });
  assert.deepEqual(problems, [], 'the console is not silent');
  await opened.context.close();

  await step('light, and on a tablet', async () => {
    for (const [size, name] of [[{ width: 1440, height: 900 }, '1440'], [{ width: 1024, height: 768 }, '1024']]) {
      for (const scheme of ['light', 'dark']) {
        const other = await openPage(browser, studio.address, { size, scheme });
        await finished(other.page);
        await rest(500);
        assert.deepEqual(await violations(other.page), [], `${scheme} ${name}`);
        const wide = await other.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
        assert.ok(wide <= 0, `the page is ${wide} px wider than the window`);
        for (const tab of ['Poses', 'Map', 'Adjust', 'Report', 'Files']) {
          await other.page.getByRole('tab', { name: tab }).click();
          await rest(250);
          await other.page.screenshot({ path: picture(pictures, `${tab.toLowerCase()}-${scheme}-${name}`) });
        }
        assert.deepEqual(other.problems, []);
        await other.context.close();
      }
    }
  });
} catch (error) {
  failures += 1;
  console.error(error);
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}
process.exitCode = failures === 0 ? 0 : 1;

async function drag(page, handle, target, fx, fy) {
  const from = await handle.boundingBox();
  const to = await page.locator(target).boundingBox();
  await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
  await page.mouse.down();
  await page.mouse.move(from.x, from.y + 20);
  await page.mouse.move(to.x + fx * to.width, to.y + fy * to.height, { steps: 4 });
  await page.mouse.up();
}

/** What the program says when it solves the document once more. */
async function solved() {
  const ask = async (path, more = {}) => (await fetch(new URL(path, studio.address), more)).json();
  const headers = { 'Content-Type': 'application/json' };
  const job = await ask('api/jobs', { method: 'POST', headers, body: JSON.stringify({ kind: 'solve' }) });
  return until('an end of the job', async () => {
    const now = await ask(`api/jobs/${job.id}`);
    return now.state === 'running' ? null : now;
  });
}

/** Says how long it took from the pen's move to the new pose. Judged only where STUDIO_TIMES is set: other load counts. */
async function latency(page) {
  const all = await page.evaluate(() => performance.getEntriesByName('pen to pose').map((entry) => entry.duration));
  all.sort((a, b) => a - b);
  const [median, late] = [all[Math.floor(all.length / 2)], all[Math.floor(all.length * 0.95)]];
  console.log(`  pen to pose: median ${median.toFixed(0)} ms, P95 ${late.toFixed(0)} ms over ${all.length}`);
  if (process.env.STUDIO_TIMES) assert.ok(median <= 60 && late <= 150);
}

/** Pictures a second while it plays, in a viewport of at least 1000 x 500. */
async function frames(page) {
  const before = page.viewportSize();
  await page.setViewportSize({ width: 2300, height: 840 });
  await rest(600);
  const { width, height } = await page.locator('#stage').boundingBox();
  assert.ok(width >= 1000 && height >= 500, `the stage is ${width} x ${height}`);
  await page.getByRole('button', { name: 'Play', exact: true }).click();
  const count = await page.evaluate(
    () => new Promise((done) => {
      let [seen, begin] = [0, performance.now()];
      const next = (now) => (now - begin > 3000 ? done(seen / 3) : ((seen += 1), requestAnimationFrame(next)));
      requestAnimationFrame(next);
    }),
  );
  await page.getByRole('button', { name: 'Pause', exact: true }).click();
  await page.setViewportSize(before);
  await rest(300);
  console.log(`  playback: ${count.toFixed(0)} frames a second at ${width.toFixed(0)} x ${height.toFixed(0)}`);
  if (process.env.STUDIO_TIMES) assert.ok(count >= 30);
}
