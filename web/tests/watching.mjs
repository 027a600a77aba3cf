// Drives what one does with a result: hands on the paper, the map, the viewport, the time, taking it home.
//
//   node watching.mjs CHROMIUM PROGRAM PICTURES

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { dropFiles, finished, openPage, penStroke, picture, rest, saved, spiral, startBrowser, startStudio, stepper, until, violations } from './driver.mjs';

const [chromium, program, pictures] = process.argv.slice(2);
if (!pictures) {
  console.error('usage: node watching.mjs CHROMIUM PROGRAM PICTURES');
  process.exit(2);
}
const only = new RegExp(process.env.STUDIO_ONLY ?? '');
const folder = mkdtempSync(join(tmpdir(), 'inkrig-watching-'));
const project = join(folder, 'project');
const browser = await startBrowser(chromium);
const studio = await startStudio(program, project);
/** Words in the console of the page that is open. */
let problems = [];
const step = stepper(browser, pictures, (name) => only.test(name), async () => [problems]);

const api = async (path) => (await fetch(new URL(`api/${path}`, studio.address))).json();
const doc = async () => (await api('project')).document;
const strokes = async () => (await doc()).control.strokes;

try {
  await on({ hasTouch: true }, async (page) => {
    const session = await page.context().newCDPSession(page);
    const box = await page.locator('#pen').boundingBox();
    const touch = (type, ...places) => session.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x: box.x + x * box.width, y: box.y + y * box.height, id, radiusX: 12, radiusY: 12 })) });
    const finger = async (places) => {
      await touch('touchStart', places[0]);
      for (const place of places.slice(1)) {
        await touch('touchMove', place);
        // A stroke of less than a second is too short to be followed.
        await rest(40);
      }
      await touch('touchEnd');
    };
    /** Two fingers, from and to. */
    const pinch = async ([a, b], [c, d]) => {
      await touch('touchStart', a);
      await touch('touchStart', a, b);
      for (let i = 1; i <= 10; i += 1) {
        const on = (from, to) => from.map((value, k) => value + ((to[k] - value) * i) / 10);
        await touch('touchMove', on(a, c), on(b, d));
        await rest(8);
      }
      await touch('touchEnd');
    };
    /** The same stroke of a finger; returns its place and width on the paper. */
    const measured = async () => {
      const before = JSON.stringify((await doc()).control);
      await finger(Array.from({ length: 30 }, (_, i) => [0.35 + (0.3 * i) / 29, 0.5 + 0.1 * Math.sin(i / 4)]));
      await until('a stroke of a finger', async () => JSON.stringify((await doc()).control) !== before);
      return extent((await strokes()).flat());
    };

    await step('a finger draws', async () => {
      const { width } = await measured();
      assert.ok(width > 0.1, `a stroke of width ${width}`);
      assert.equal((await doc()).control.kind, 'curve');
      await finished(page);
    });

    await step('two fingers move and scale the paper', async () => {
      const before = await measured();
      const drawn = JSON.stringify((await doc()).control);
      await pinch([[0.4, 0.4], [0.6, 0.6]], [[0.3, 0.3], [0.7, 0.7]]);
      await rest(500);
      assert.equal(JSON.stringify((await doc()).control), drawn, 'two fingers drew');
      const large = await measured();
      assert.ok(Math.abs(before.width / large.width - 2) < 0.2, `a pinch to twice the size made ${before.width / large.width}`);
      await pinch([[0.4, 0.4], [0.6, 0.4]], [[0.4, 0.6], [0.6, 0.6]]);
      const low = await measured();
      const height = (0.2 * large.width * box.height) / (0.3 * box.width);
      assert.ok(Math.abs(low.width / large.width - 1) < 0.1, 'two fingers side by side changed the size');
      assert.ok(Math.abs(low.y - large.y - height) < 0.2 * height, `the paper moved by ${low.y - large.y} instead of ${height}`);
      await finished(page);
    });

    await step('a palm beside a pen does not draw', async () => {
      const steps = (await api('project')).history.undo.length;
      await touch('touchStart', [0.8, 0.85]);
      await penStroke(page, '#pen', spiral(2, 80), {
        during: async () => {
          await touch('touchEnd');
          await touch('touchStart', [0.8, 0.85], [0.9, 0.8]);
          await touch('touchMove', [0.75, 0.8], [0.95, 0.9]);
          await touch('touchEnd');
        },
      });
      await until('the stroke of the pen', async () => (await api('project')).history.undo.length > steps);
      await rest(500);
      assert.equal((await api('project')).history.undo.length, steps + 1, 'the palm made a step of its own');
      const points = (await strokes()).flat();
      assert.ok(points.length > 60, `${points.length} points of the pen's 80`);
      const pressures = points.map((point) => point[3]);
      assert.ok(Math.max(...pressures) - Math.min(...pressures) > 0.3, 'these are not the points of the pen');
      const { width, x } = extent(points);
      await touch('touchStart', [0.3, 0.3]);
      await touch('touchMove', [0.5, 0.5]);
      await touch('touchEnd');
      await penStroke(page, '#pen', spiral(2, 80));
      await until('the second stroke', async () => (await api('project')).history.undo.length > steps + 1);
      await rest(500);
      assert.equal((await api('project')).history.undo.length, steps + 2, 'a finger drew beside the pen');
      const again = extent((await strokes()).flat());
      assert.ok(Math.abs(again.width / width - 1) < 0.03 && Math.abs(again.x - x) < 0.03 * width, 'the palm moved the paper');
      await finished(page);
    });
  });

  await on({}, async (page) => {
    await step('a mouse has no pressure and draws', async () => {
      const before = (await api('project')).history.undo.length;
      const box = await page.locator('#pen').boundingBox();
      const places = spiral(3, 90);
      const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
      await page.mouse.move(...at(places[0]));
      await page.mouse.down();
      for (const place of places) await page.mouse.move(...at(place));
      await page.mouse.up();
      await until('the stroke', async () => (await api('project')).history.undo.length > before);
      const points = (await strokes()).flat();
      assert.ok(points.length > 40, `${points.length} points`);
      assert.ok(points.every(([, , t, p], i) => p > 0.2 && p < 0.8 && t >= (points[i - 1]?.[2] ?? 0)), 'pressure or time of a mouse');
      await finished(page);
    });

    await step('a line drawn on the map of the clip', async () => {
      await page.getByRole('tab', { name: 'Map' }).click();
      const { map, candidates } = await api('suggestions?count=8');
      await drawn(page);
      await page.getByRole('button', { name: 'Clear the drawing' }).click();
      await until('the clip as it is', async () => (await page.locator('#caption').innerText()) === 'the clip as it is');
      const bare = await part(page, '#board');
      const under = page.getByRole('switch', { name: 'Lay it under the drawing' });
      await under.click();
      await until('the map under the drawing', async () => (await changed(page, bare, await part(page, '#board'))) > 500);
      // Where pixels are on the paper is learnt from a stroke; the next one goes through the poses.
      await penStroke(page, '#pen', spiral(2, 60));
      await until('a drawing', async () => (await doc()).control !== null);
      const there = extent((await strokes()).flat());
      const places = extent(map.frames.map(({ x, y }) => [x, y]));
      assert.ok(there.width > 0.3 * places.width && there.width < 3 * places.width, `a stroke of width ${there.width} on a map of ${places.width}`);
      const spots = extent(spiral(2, 60));
      const scale = [spots.width / there.width, spots.height / there.height];
      const onPaper = ({ x, y }) => [spots.x + (x - there.x) * scale[0], spots.y - (y - there.y) * scale[1]];
      await page.getByRole('button', { name: 'Hold the drawing to it' }).click();
      await until('keys at places of the map', async () => {
        const { keys } = await doc();
        return candidates.every((pose) => keys.some(({ place }) => place?.kind === 'point' && Math.hypot(place.point[0] - pose.x, place.point[1] - pose.y) < 1e-4));
      });
      const way = candidates.map(onPaper).sort(([a], [b]) => a - b);
      // Beside the first: on a key, a pen would move that.
      way.unshift([way[0][0] - 0.07, way[0][1] + 0.07]);
      const line = way.slice(1).flatMap((to, k) => Array.from({ length: 12 }, (_, i) => to.map((value, axis) => way[k][axis] + ((value - way[k][axis]) * i) / 12)));
      const before = JSON.stringify(await strokes());
      await penStroke(page, '#pen', line, { pause: 80 });
      await until('the line over the map', async () => JSON.stringify(await strokes()) !== before);
      await rest(300);
      await finished(page);
      const { result } = await api('project');
      const { keys } = await api(`results/${result}`);
      const good = keys.filter(({ met }) => met === 'good').length;
      console.log(`  ${good} of ${keys.length} poses of the map are met`);
      assert.ok(keys.length >= candidates.length && good >= keys.length / 2, JSON.stringify(keys));
      assert.deepEqual(await violations(page), []);
      await page.screenshot({ path: picture(pictures, 'underlay-dark-1440') });
      const laid = await part(page, '#board');
      await under.click();
      await until('the map is gone', async () => (await changed(page, laid, await part(page, '#board'))) > 500);
    });
  });

  for (const reducedMotion of ['no-preference', 'reduce']) {
    await on({ reducedMotion }, async (page) => {
      const calm = reducedMotion === 'reduce';
      await step(calm ? 'reduced motion: nothing moves by itself' : 'without reduced motion, things move', async () => {
        const moving = () => page.evaluate(() => {
          const seconds = (text) => Math.max(...text.split(',').map(Number.parseFloat));
          const styles = [...document.querySelectorAll('*')].flatMap((element) => ['', '::before', '::after'].map((part) => [element, getComputedStyle(element, part || undefined)]));
          const found = styles.filter(([, style]) => seconds(style.transitionDuration) > 0 || style.animationName !== 'none' || style.scrollBehavior === 'smooth');
          return found.map(([element]) => `${element.tagName} ${element.className}`).concat(document.getAnimations().map(String));
        });
        const seen = new Set();
        for (const tab of ['Poses', 'Map', 'Adjust', 'Report', 'Files']) {
          await page.getByRole('tab', { name: tab }).click();
          for (const what of await moving()) seen.add(what);
        }
        await page.getByRole('button', { name: 'Guided tour' }).click();
        for (const what of await moving()) seen.add(what);
        await page.getByRole('button', { name: 'Leave' }).click();
        await page.keyboard.press('Control+e');
        for (const what of await moving()) seen.add(what);
        await page.keyboard.press('Escape');
        assert.equal(seen.size === 0, calm, [...seen].join('; '));
        await penStroke(page, '#pen', spiral(2, 60));
        // Between the last preview and the result the status says neither for a moment.
        await rest(500);
        await until('the result', () => page.evaluate(() => !/Preview|Solving/.test(document.querySelector('#status').textContent)));
        const begin = await time(page);
        await rest(600);
        assert.equal((await time(page)) === begin, calm, calm ? 'it plays by itself' : 'nothing plays after a stroke');
        await page.getByRole('button', { name: calm ? 'Play' : 'Pause', exact: true }).click();
        await rest(400);
        assert.equal(await page.getByRole('button', { name: 'Pause', exact: true }).isVisible(), calm, 'playing is for who asks for it');
        await finished(page);
      });
    });
  }

  await on({}, async (page) => {
    await drawn(page);
    await step('each switch of the view changes the picture', async () => {
      await seek(page, 2);
      await page.keyboard.press('Shift+F');
      for (const [name, key] of [['Ghosts before and after', 'o'], ['Trails of hands and feet', 't'], ['The clip beside it', 'b'], ['Ground', 'g']]) {
        const button = page.getByRole('button', { name, exact: true });
        const [was, before] = [await button.getAttribute('aria-pressed'), await still(page)];
        await button.click();
        assert.notEqual(await button.getAttribute('aria-pressed'), was, name);
        const after = await still(page);
        const apart = await changed(page, before, after);
        assert.ok(apart > 100, `${name}: ${apart} pixels are others`);
        if (was === 'false') await page.screenshot({ path: picture(pictures, `view-${key}-dark-1440`) });
        await page.keyboard.press(key);
        assert.equal(await button.getAttribute('aria-pressed'), was, `${name} by its key`);
        assert.ok((await changed(page, before, await still(page))) < 50, `${name}: not as it was`);
      }
    });

    await step('the camera follows', async () => {
      const button = page.getByRole('button', { name: 'Camera follows', exact: true });
      const moments = [0.2, 0.4, 0.6, 0.8].map((share) => share * 10);
      const pictureAt = async (seconds) => {
        await seek(page, seconds);
        return still(page);
      };
      await seek(page, 0);
      const followed = [];
      for (const moment of moments) followed.push(await pictureAt(moment));
      await seek(page, 0);
      await button.click();
      assert.equal(await button.getAttribute('aria-pressed'), 'false');
      const apart = [];
      for (const [i, moment] of moments.entries()) apart.push(await changed(page, followed[i], await pictureAt(moment)));
      assert.ok(Math.max(...apart) > 1000, `the camera follows still: ${apart} pixels`);
      await page.keyboard.press('c');
      assert.equal(await button.getAttribute('aria-pressed'), 'true');
      assert.ok((await changed(page, followed.at(-1), await still(page))) < 50, 'the camera did not come back');
    });

    await step('looking around by mouse, wheel and keys', async () => {
      const box = await page.locator('#stage').boundingBox();
      const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
      await page.keyboard.press('Shift+F');
      const front = await still(page);
      const drag = async (dx, dy) => {
        await page.mouse.move(x, y);
        await page.mouse.down();
        await page.mouse.move(x + dx, y + dy, { steps: 5 });
        await page.mouse.up();
      };
      const ways = {
        'a drag': () => drag(120, 30),
        'the wheel': async () => {
          await page.mouse.move(x, y);
          await page.mouse.wheel(0, -300);
        },
        'a drag with shift': async () => {
          await page.keyboard.down('Shift');
          await drag(100, 0);
          await page.keyboard.up('Shift');
        },
      };
      for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-']) {
        ways[key] = async () => {
          await page.locator('#stage').focus();
          await page.keyboard.press(key);
        };
      }
      const begin = await time(page);
      for (const [name, go] of Object.entries(ways)) {
        const before = await still(page);
        await go();
        assert.ok((await changed(page, before, await still(page))) > 500, `${name}: the same picture`);
        assert.equal(await time(page), begin, `${name} moved the time`);
      }
      await page.getByRole('button', { name: 'Put the camera back' }).click();
      assert.ok((await changed(page, front, await still(page))) < 50, 'the camera is not back');
    });

    await step('a pose that is pointed at, and an exact key, are red', async () => {
      await page.getByRole('tab', { name: 'Poses' }).click();
      await page.mouse.move(5, 5);
      const without = await reds(page, await still(page));
      await page.locator('.pose').nth(1).hover();
      const pointed = await reds(page, await still(page));
      assert.ok(pointed > without + 1500, `${without} red pixels before, ${pointed} while pointing`);
      await page.screenshot({ path: picture(pictures, 'pointed-dark-1440') });
      await page.mouse.move(5, 5);
      assert.ok((await reds(page, await still(page))) < without + 200, 'the red pose stays');
      await page.locator('#side input[value="hard"]').first().check({ force: true });
      await seek(page, 1.5);
      const { keys } = await doc();
      await page.keyboard.press('k');
      await until('the key', async () => (await doc()).keys.length === keys.length + 1);
      await finished(page);
      const made = (await doc()).keys.at(-1).place.seconds;
      await seek(page, made);
      const there = await reds(page, await still(page));
      await seek(page, made + 0.5);
      const later = await reds(page, await still(page));
      assert.ok(there > later + 1500, `${there} red pixels at the key, ${later} half a second later`);
    });

    await step('play, speed, loop, steps and scrubbing', async () => {
      const [play, loop] = [page.getByRole('button', { name: 'Play', exact: true }), page.getByRole('button', { name: 'Loop', exact: true })];
      const pause = page.getByRole('button', { name: 'Pause', exact: true });
      for (const [text, speed] of [['¼', 0.25], ['½', 0.5], ['2×', 2], ['1×', 1]]) {
        await page.getByRole('radio', { name: text }).check({ force: true });
        // Other load on the machine makes a page leave out time: the best of three counts.
        let pace = 0;
        for (let i = 0; i < 3 && Math.abs(pace / speed - 1) > 0.1; i += 1) {
          await page.keyboard.press('Home');
          await play.click();
          pace = await page.evaluate(async () => {
            const now = () => [Number(document.querySelector('.scrubber').value), performance.now() / 1000];
            const [s, t] = now();
            await new Promise((done) => setTimeout(done, 1000));
            const [s1, t1] = now();
            return (s1 - s) / (t1 - t);
          });
          await pause.click();
        }
        assert.ok(Math.abs(pace / speed - 1) < 0.15, `at ${text} time goes ${pace} times as fast`);
      }
      const { seconds, frameRate } = await api(`results/${(await api('project')).result}`);
      const end = Number(await page.locator('.scrubber').getAttribute('max'));
      assert.ok(Math.abs(end - seconds) < 0.1, `${end} and ${seconds} seconds`);
      assert.equal(await loop.getAttribute('aria-pressed'), 'true');
      await seek(page, end - 0.3);
      await play.click();
      await until('a second round', async () => (await time(page)) < end - 0.5);
      await pause.click();
      await page.keyboard.press('l');
      assert.equal(await loop.getAttribute('aria-pressed'), 'false');
      await seek(page, end - 0.3);
      await play.click();
      await play.waitFor();
      assert.ok(Math.abs((await time(page)) - end) < 1e-6, 'without the loop it does not stop at the end');
      await rest(400);
      assert.ok(Math.abs((await time(page)) - end) < 1e-6, 'it went on');
      await play.click();
      await until('from the start again', async () => (await time(page)) < 1 && (await time(page)) > 0);
      await pause.click();
      await loop.click();
      await seek(page, 1);
      const begin = Math.round((await time(page)) * frameRate);
      for (const [act, frames] of [[() => page.getByRole('button', { name: 'One frame on' }).click(), 1], [() => page.keyboard.press('.'), 2], [() => page.getByRole('button', { name: 'One frame back' }).click(), 1], [() => page.keyboard.press(','), 0]]) {
        await act();
        assert.ok(Math.abs((await time(page)) * frameRate - (begin + frames)) < 1e-3, `at frame ${(await time(page)) * frameRate}, not ${begin + frames}`);
        assert.match(await page.locator('#transport').innerText(), new RegExp(`frame ${begin + frames}\\b`));
      }
      await play.click();
      const head = await page.locator('#head').boundingBox();
      const inner = [head.x + 76, head.width - 90];
      await page.mouse.move(inner[0] + 0.25 * inner[1], head.y + 10);
      await page.mouse.down();
      await play.waitFor();
      for (const share of [0.25, 0.5, 0.8]) {
        await page.mouse.move(inner[0] + share * inner[1], head.y + 10);
        await until(`the time at ${share}`, async () => Math.abs((await time(page)) / end - share) < 0.01, 5000);
      }
      await page.mouse.up();
      const slider = page.getByRole('slider', { name: 'Time' });
      await slider.focus();
      const before = await time(page);
      await page.keyboard.press('ArrowRight');
      assert.ok((await time(page)) > before, 'the slider of the keyboard does not move');
    });

    await step('every format is saved', async () => {
      await page.keyboard.press('Control+e');
      await page.locator('dialog[open]').waitFor();
      const formats = await page.getByLabel('Format').locator('option').evaluateAll((options) => options.map(({ value }) => value));
      const magic = { bvh: 'HIERARCHY', glb: 'glTF', fbx: 'Kaydara FBX Binary', usda: '#usda 1.0' };
      // The others need a character that came as a file of their kind.
      assert.deepEqual(formats, ['bvh', 'glb', 'fbx', 'usda']);
      const { formats: all } = await api('info');
      for (const format of formats) {
        await page.getByLabel('Format').selectOption(format);
        const path = join(folder, `all.${format}`);
        await saved(page, path, () => page.getByRole('button', { name: 'Save file' }).click());
        assert.ok(statSync(path).size > 1000, `${format}: ${statSync(path).size} bytes`);
        assert.equal(readFileSync(path).subarray(0, magic[format].length).toString('latin1'), magic[format]);
        if (!all.find(({ extension }) => extension === format).read) continue;
        const said = execFileSync(program, ['inspect', path], { encoding: 'utf8' });
        assert.match(said, /frames/i, format);
      }
      console.log(`  ${formats.join(', ')}`);
      assert.deepEqual(await violations(page), []);
      await page.keyboard.press('Escape');
    });

    await step('the command line that is shown makes the same motion', async () => {
      await page.keyboard.press('Control+e');
      await page.locator('dialog[open] code').waitFor();
      const text = await page.locator('dialog[open] code').innerText();
      const place = join(folder, 'shell');
      mkdirSync(place);
      for (const button of await page.getByRole('button', { name: /^Save .*\.csv$/ }).all()) {
        await saved(page, join(place, (await button.innerText()).replace('Save ', '')), () => button.click());
      }
      await page.getByLabel('Format').selectOption('bvh');
      const own = join(folder, 'shown.bvh');
      await saved(page, own, () => page.getByRole('button', { name: 'Save file' }).click());
      await page.screenshot({ path: picture(pictures, 'command-dark-1440') });
      await page.keyboard.press('Escape');
      // It names the clips of the project's folder.
      mkdirSync(join(place, 'clips'));
      for (const { file } of (await doc()).clips) writeFileSync(join(place, 'clips', file), readFileSync(join(project, 'clips', file)));
      assert.match(text, /^inkrig align clips\//);
      execFileSync('sh', ['-c', text.replace(/^inkrig/, '"$0"'), program], { cwd: place, encoding: 'utf8', stdio: 'pipe' });
      const numbers = (file) => readFileSync(file, 'utf8').split('Frame Time')[1].split('\n').slice(1).join(' ').trim().split(/\s+/).map(Number);
      const [a, b] = [numbers(own), numbers(join(place, 'new.bvh'))];
      assert.equal(a.length, b.length, 'another number of frames');
      const apart = Math.max(...a.map((value, i) => Math.abs(value - b[i])));
      console.log(`  largest difference of the two files: ${apart} units or degrees`);
      assert.ok(apart < 0.01, `the shell's motion is ${apart} off`);
    });

    await step('a label is renamed and coloured', async () => {
      await page.getByRole('radio', { name: 'Labels' }).check({ force: true });
      await until('the labels', async () => (await doc()).control?.kind === 'labels');
      const name = page.getByLabel('Name of segment 2');
      await name.fill('turn');
      await name.press('Enter');
      await until('the name', async () => (await doc()).control.segments[1].name === 'turn');
      await until('the name on the strip', async () => (await page.locator('.block b').nth(1).innerText()) === 'turn');
      const first = (await doc()).control.segments[0].name;
      await page.getByLabel(`Colour of ${first}`).first().fill('#3366cc');
      await until('the colour', async () => {
        const { segments } = (await doc()).control;
        return segments.filter((segment) => segment.name === first).every(({ colour }) => colour === '#3366cc') && segments[1].colour === null;
      });
      const shown = await page.locator('.block').evaluateAll((blocks) => blocks.map((block) => getComputedStyle(block).backgroundColor));
      assert.deepEqual([shown[0], shown[2]], ['rgb(51, 102, 204)', 'rgb(51, 102, 204)']);
      await finished(page);
      assert.deepEqual(await violations(page), []);
      await page.getByRole('radio', { name: 'Draw' }).check({ force: true });
      await until('the drawing again', async () => (await doc()).control?.kind === 'curve');
      await finished(page);
    });

    await step('a dropped motion beside the result', async () => {
      const { source, clips } = await doc();
      const clip = readFileSync(join(project, 'clips', clips[0].file));
      await page.getByRole('tab', { name: 'Files' }).click();
      const before = await still(page);
      await dropFiles(page, [{ name: 'reference.bvh', bytes: clip }]);
      const beside = page.getByRole('button', { name: 'Show reference beside the result' });
      await beside.waitFor();
      await until('it is arranged', async () => JSON.stringify((await doc()).source) !== JSON.stringify(source));
      await rest(500);
      await page.keyboard.press('Control+z');
      await until('the first clip is arranged again', async () => JSON.stringify((await doc()).source) === JSON.stringify(source));
      await finished(page);
      await beside.click();
      assert.equal(await beside.getAttribute('aria-pressed'), 'true');
      await seek(page, 1);
      const two = await still(page);
      assert.ok((await changed(page, before, two)) > 1000, 'nothing stands beside the result');
      await page.screenshot({ path: picture(pictures, 'beside-dark-1440') });
      assert.deepEqual(await violations(page), []);
      await beside.click();
      assert.ok((await changed(page, two, await still(page))) > 300, 'it is the clip of the result that stands beside it');
      await page.keyboard.press('b');
    });
  });
} catch (error) {
  console.error(error);
  process.exitCode = 1;
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}

/** Opens a page, does the work, and wants its console silent. */
async function on(device, work) {
  const opened = await openPage(browser, studio.address, { device });
  problems = opened.problems;
  await work(opened.page);
  assert.deepEqual(problems, [], 'the console is not silent');
  await opened.context.close();
}

/** A project with a drawing of some seconds and its result. */
async function drawn(page) {
  const { undo } = (await api('project')).history;
  await penStroke(page, '#pen', spiral(), { pause: 20 });
  await until('a drawing', async () => (await api('project')).history.undo.length > undo.length);
  await rest(300);
  await finished(page);
}

/** Middle, width and height of points. */
function extent(points) {
  const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((axis) => pick(...points.map((point) => point[axis]))));
  return { x: (low[0] + high[0]) / 2, y: (low[1] + high[1]) / 2, width: high[0] - low[0], height: high[1] - low[1] };
}

/** The picture of a part of the page, without what stands at its edges over it. */
async function part(page, selector) {
  const box = await page.locator(selector).boundingBox();
  return page.screenshot({ clip: { x: box.x + 60, y: box.y + 60, width: box.width - 120, height: box.height - 110 } });
}

/** The character once it rests: pictures become finer a moment after the last change. */
async function still(page) {
  let before = await part(page, '#stage');
  return until('a picture at rest', async () => {
    await rest(600);
    const now = await part(page, '#stage');
    const same = now.equals(before);
    before = now;
    return same ? now : null;
  });
}

/** How many pixels of two pictures differ visibly. */
async function changed(page, a, b) {
  return look(page, [a, b], 'apart');
}

/** Pixels in the red of keys, lit or in shade. */
async function reds(page, shot) {
  return look(page, [shot], 'red');
}

/** Counts pixels of PNG pictures in the page, which can read them. */
async function look(page, shots, what) {
  return page.evaluate(
    async ([list, wanted]) => {
      const read = async (data) => {
        const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: 'image/png' }));
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d', { willReadFrequently: true });
        context.drawImage(bitmap, 0, 0);
        return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
      };
      const [one, two] = await Promise.all(list.map(read));
      const tests = {
        apart: (i) => Math.abs(one[i] - two[i]) + Math.abs(one[i + 1] - two[i + 1]) + Math.abs(one[i + 2] - two[i + 2]) > 24,
        red: (i) => one[i] > 90 && one[i + 1] < 0.52 * one[i] && one[i + 2] < 0.5 * one[i],
      };
      let count = 0;
      for (let i = 0; i < one.length; i += 4) if (tests[wanted](i)) count += 1;
      return count;
    },
    [shots.map((shot) => shot.toString('base64')), what],
  );
}

async function time(page) {
  return page.evaluate(() => Number(document.querySelector('.scrubber').value));
}

async function seek(page, seconds) {
  await page.locator('.scrubber').evaluate((scrubber, value) => {
    scrubber.value = String(value);
    scrubber.dispatchEvent(new Event('input'));
  }, seconds);
}
