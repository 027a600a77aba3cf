// A tablet on the local network: the page under a name of another machine is no secure context, so the browser gives it no
// coalesced events, no clipboard and no AudioWorklet. Everything has to work without.
//
//   node lan.mjs CHROMIUM PICTURES ADDRESS PROGRAM...
//
// Runs where the tablet is; PROGRAM... starts inkrig where ADDRESS is. `cargo xtask lan-test` makes both places.

import assert from 'node:assert/strict';
import { request } from 'node:http';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { beat, dropFiles, finished, openPage, penStroke, picture, rest, spiral, startBrowser, startStudio, until } from './driver.mjs';

const NAME = 'studio.test';
const [chromium, pictures, machine, ...program] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'inkrig-lan-'));
const browser = await startBrowser(chromium, [`--host-resolver-rules=MAP ${NAME} ${machine}`]);
const studio = await startStudio(program, join(folder, 'project'), [], ['--lan', '--name', NAME]);
try {
  const invitation = () => studio.said().match(/http:\/\/\S+token=\w+/g) ?? [];
  const [address] = await until('an invitation', () => (invitation().length > 0 ? invitation() : null));
  const { hostname, port } = new URL(address);
  assert.equal(hostname, NAME);

  // Whoever has no token gets nothing, by whatever name.
  for (const host of [NAME, machine, 'evil.example']) {
    for (const path of ['/', '/api/project', '/api/events', '/assets/a.js', '/api/live']) {
      const status = await ask(`${host}:${port}`, path);
      assert.ok(status === 401 || status === 403, `${host}${path} gave ${status}`);
    }
  }
  console.log('ok    nothing without a token');

  const { page, problems, context } = await openPage(browser, address, { size: { width: 1024, height: 768 } });
  const lacks = await page.evaluate(() => ({
    address: location.href,
    secure: isSecureContext,
    coalesced: 'getCoalescedEvents' in PointerEvent.prototype,
    clipboard: 'clipboard' in navigator,
    worklet: 'audioWorklet' in BaseAudioContext.prototype,
    cookie: document.cookie,
  }));
  assert.equal(lacks.address, `http://${NAME}:${port}/`, 'the token leaves the address bar');
  assert.equal(lacks.cookie, '', 'the cookie is not for scripts');
  assert.deepEqual([lacks.secure, lacks.coalesced, lacks.clipboard, lacks.worklet], [false, false, false, false]);
  console.log('ok    the token became a cookie; no secure context, no coalesced events, no clipboard, no AudioWorklet');

  const doc = () => page.evaluate(async () => (await (await fetch('api/project')).json()).document);
  await penStroke(page, '#pen', spiral(), {
    during: () => until('poses while the pen is down', () => page.evaluate(() => performance.getEntriesByName('pen to pose').length > 0)),
  });
  const control = await until('the drawing', async () => (await doc()).control);
  const points = control.strokes.flat();
  const pressures = points.map((point) => point[3]);
  // One sample a picture is what a browser gives here; a busy machine has few pictures.
  assert.ok(points.length > 60, `only ${points.length} points came`);
  assert.ok(Math.max(...pressures) - Math.min(...pressures) > 0.3, 'pressure was lost');
  await finished(page);
  await page.screenshot({ path: picture(pictures, 'lan-drawn') });
  console.log(`ok    a stroke of ${points.length} points with pressure`);

  await page.keyboard.press('Control+e');
  await page.locator('dialog[open] .command code').waitFor();
  await page.getByRole('button', { name: 'Copy' }).click();
  await page.getByRole('button', { name: 'Marked' }).waitFor();
  assert.match(await page.evaluate(() => String(getSelection())), /^inkrig align/);
  const [got] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save file' }).click()]);
  assert.match(got.suggestedFilename(), /\.bvh$/);
  await page.keyboard.press('Escape');
  console.log('ok    the command is marked to be copied by hand; a file is saved');

  await dropFiles(page, [{ name: 'beat.wav', bytes: beat() }]);
  await until('the sound', async () => (await doc()).control?.kind === 'sound');
  await finished(page);
  await page.getByRole('button', { name: 'Play', exact: true }).click();
  const [heard, motion] = await until('the sound beside the motion', async () => {
    await rest(800);
    return page.evaluate(() => {
      const audio = document.querySelector('audio');
      return audio && !audio.paused && audio.currentTime > 0.3 ? [audio.currentTime, audio.duration] : null;
    });
  });
  await page.getByRole('button', { name: 'Pause', exact: true }).click();
  console.log(`ok    a sound is heard (${heard.toFixed(1)} of ${motion.toFixed(1)} s)`);
  assert.deepEqual(problems, [], 'the console is not silent');
  await context.close();

  // The token is spent: another device needs its own.
  const stranger = await (await browser.newContext()).newPage();
  assert.equal((await stranger.goto(address)).status(), 401);
  const second = await until('a second invitation', () => invitation()[1]);
  assert.notEqual(second, address);
  assert.equal((await stranger.goto(second)).status(), 200);
  console.log('ok    a token is good once, and the next device gets its own');
} catch (error) {
  console.error(error);
  console.error(studio.said().replaceAll(/.*[█▀▄].*\n/g, ''));
  process.exitCode = 1;
} finally {
  await browser.close();
  await studio.kill();
  rmSync(folder, { recursive: true, force: true });
}

/** The status that a request for a host gets. */
function ask(host, path) {
  const { port } = new URL(`http://${host}`);
  return new Promise((done, fail) => {
    request({ host: machine, port, path, headers: { Host: host } }, (answer) => (answer.resume(), done(answer.statusCode))).on('error', fail).end();
  });
}
