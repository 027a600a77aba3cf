// Opens preview pages and fails on anything a reader of the console would see, on a blank canvas, on a canvas that
// stands still when played or scrubbed, on a drawing that does not say what it uses, on poses that cannot be picked, and
// on any request that leaves a page's own file.
//
//   node preview.mjs MODULES CHROMIUM SCREENSHOTS PAGE...
//
// MODULES is the folder that holds node_modules/playwright-core; SCREENSHOTS an existing folder.

import { createRequire } from 'node:module';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, chromium, screenshots, ...pages] = process.argv.slice(2);
if (pages.length === 0) {
  console.error('usage: node preview.mjs MODULES CHROMIUM SCREENSHOTS PAGE...');
  process.exit(2);
}
if (Number(process.versions.node.split('.')[0]) < 20) {
  console.error(`this check needs Node 20 or later; the package nodejs here is ${process.versions.node}`);
  process.exit(1);
}
const { chromium: driver } = createRequire(join(resolve(modules), 'package.json'))('playwright-core');

const SIZE = { width: 1440, height: 900 };
// Long enough for some frames at 20 a second on a busy machine without a graphics card.
const MOMENT = 600;
const PATIENCE = 15_000;
// The driver's own notes on reading pixels back: caused by our screenshots, and never seen by a user.
const NOT_THE_PAGE = /GL Driver Message/;

const browser = await driver.launch({
  executablePath: chromium,
  headless: true,
  args: [
    '--no-sandbox',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    // Build servers have no graphics card; said outright, Chromium does not warn of it in the console.
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
  ],
});

const problems = [];
try {
  for (const page of pages) {
    for (const scheme of ['light', 'dark']) {
      const name = `${basename(page, '.html')}-${scheme}`;
      const found = await check(pathToFileURL(resolve(page)).href, scheme, join(screenshots, `${name}.png`));
      console.log(`${name}: ${found.length === 0 ? 'ok' : `problems found: ${found.length}`}`);
      problems.push(...found.map((problem) => `${name}: ${problem}`));
    }
  }
} finally {
  await browser.close();
}
for (const problem of problems) console.error(problem);
process.exitCode = problems.length === 0 ? 0 : 1;

async function check(address, scheme, picture) {
  const found = [];
  const context = await browser.newContext({ viewport: SIZE, colorScheme: scheme });
  context.setDefaultTimeout(PATIENCE);
  const tab = await context.newPage();
  listen(tab, address, found);
  try {
    await tab.goto(address, { waitUntil: 'load' });
    const canvas = await largestCanvas(tab);
    if (!canvas) {
      found.push('the page has no visible canvas');
    } else {
      await drive(tab, canvas, found);
    }
    const wide = await tab.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    if (wide > 0) found.push(`the page is ${wide} px wider than the window`);
  } catch (error) {
    found.push(`the check could not go on: ${error.message.split('\n')[0]}`);
  }
  await tab.screenshot({ path: picture });
  await context.close();
  return found;
}

function listen(tab, address, found) {
  tab.on('console', (message) => {
    const loud = message.type() === 'error' || message.type() === 'warning';
    if (loud && !NOT_THE_PAGE.test(message.text())) found.push(`console ${message.type()}: ${message.text()}`);
  });
  tab.on('pageerror', (error) => found.push(`page error: ${error.message}`));
  tab.on('crash', () => found.push('the page crashed'));
  tab.on('request', (request) => {
    const own = request.url().split('#')[0] === address || /^(data|blob):/.test(request.url());
    if (!own) found.push(`request to ${request.url()}: a preview is one file`);
  });
}

// Plays, pauses and scrubs, and looks at the canvas after each.
async function drive(tab, canvas, found) {
  if (!(await within(async () => !(await isBlank(tab, await canvas.screenshot()))))) found.push('the canvas is blank');

  const play = tab.getByRole('button', { name: /play|pause/i }).first();
  const hasPlay = (await play.count()) > 0;
  if (!hasPlay) found.push('no button is named play or pause');

  const startsPlaying = await moves(tab, canvas);
  if (!startsPlaying && hasPlay) {
    await play.click();
    if (!(await within(() => moves(tab, canvas)))) found.push('the canvas stands still after play was pressed');
  }
  if (hasPlay) {
    await play.click();
    if (!(await within(async () => !(await moves(tab, canvas))))) found.push('the canvas still moves after pause');
  }
  await scrub(tab, canvas, found);
  if ((await tab.locator('#curve-heading').textContent()) === 'Storyboard') {
    await board(tab, found);
  } else {
    await point(tab, found);
    await pick(tab, found);
  }
}

// The drawing beside the motion is that of the frame that is played.
async function board(tab, found) {
  const drawing = tab.locator('#curve');
  const shots = [];
  for (const key of ['Home', 'End']) {
    await tab.keyboard.press(key);
    await tab.waitForTimeout(MOMENT / 2);
    shots.push(await drawing.screenshot());
  }
  for (const shot of shots) if (await isBlank(tab, shot)) found.push('a frame of the storyboard is blank');
  if (shots[0].equals(shots[1])) found.push('the first and the last frame of the storyboard are the same');
  if (await tab.locator('.key.way').isHidden()) found.push('no drawn way is named in the legend');
}

// Points at the drawing until it says which part of the clip it uses there.
async function point(tab, found) {
  const box = await tab.locator('#curve').boundingBox();
  for (let y = 60; y < box.height - 40; y += 8) {
    for (let x = 40; x < box.width - 40; x += 8) {
      await tab.mouse.move(box.x + x, box.y + y);
      if (!(await tab.locator('#tip').isVisible())) continue;
      const text = await tab.locator('#tip').textContent();
      if (!/clip .* s, frame \d+.*% sure/.test(text)) found.push(`the drawing says of itself: ${text}`);
      return;
    }
  }
  found.push('no point of the drawing says which part of the clip it uses');
}

// Picks a suggested pose, by the keyboard, and lets it go again.
async function pick(tab, found) {
  const stage = tab.locator('#stage');
  const poses = tab.getByRole('button', { name: /^Pose \d+: clip/ });
  if ((await poses.count()) < 2) return void found.push('there are no poses to pick');
  if (await isBlank(tab, await poses.first().locator('canvas').screenshot())) found.push('a pose is blank');
  if (await isBlank(tab, await tab.locator('#map').screenshot())) found.push('the map is blank');
  const before = await stage.screenshot();
  await poses.nth(1).focus();
  await tab.keyboard.press('Enter');
  await tab.waitForTimeout(MOMENT / 2);
  const text = await tab.locator('#key-text').textContent();
  if (!/^--key [\d.]+s~frame:\d+$/.test(text)) found.push(`a picked pose says: ${text}`);
  if ((await poses.nth(1).getAttribute('aria-pressed')) !== 'true') found.push('a picked pose is not pressed');
  if (before.equals(await stage.screenshot())) found.push('picking a pose changes nothing on the stage');
  await tab.keyboard.press('Escape');
  if ((await poses.nth(1).getAttribute('aria-pressed')) !== 'false') found.push('a pose cannot be let go');
}

async function scrub(tab, canvas, found) {
  const bar = tab.locator('input[type=range]:visible').first();
  if ((await bar.count()) === 0) return void found.push('no time bar (input of type range)');
  const shots = [];
  for (const share of [0.1, 0.35, 0.6]) {
    await bar.evaluate((input, share) => {
      const [low, high] = [Number(input.min || 0), Number(input.max || 100)];
      input.value = String(low + (high - low) * share);
      for (const kind of ['input', 'change']) input.dispatchEvent(new Event(kind, { bubbles: true }));
    }, share);
    await tab.waitForTimeout(MOMENT / 2);
    shots.push(await canvas.screenshot());
  }
  if (shots.every((shot) => shot.equals(shots[0]))) found.push('moving the time bar changes nothing on the canvas');
}

async function largestCanvas(tab) {
  await tab.locator('canvas').first().waitFor({ state: 'visible' }).catch(() => {});
  let best = null;
  let bestArea = 0;
  for (const canvas of await tab.locator('canvas').all()) {
    const box = await canvas.boundingBox();
    const area = box ? box.width * box.height : 0;
    if (area > bestArea) [best, bestArea] = [canvas, area];
  }
  return best;
}

async function moves(tab, canvas) {
  const before = await canvas.screenshot();
  await tab.waitForTimeout(MOMENT);
  return !before.equals(await canvas.screenshot());
}

// A picture is blank if it holds hardly anything but one colour. Decoded by the browser, in a tab of its own: that
// keeps an image library out of the lock file, and our code out of the page under test.
async function isBlank(tab, png) {
  const scratch = await tab.context().newPage();
  const share = await scratch.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const surface = canvas.getContext('2d');
    surface.drawImage(image, 0, 0);
    const pixels = new Uint32Array(surface.getImageData(0, 0, image.width, image.height).data.buffer);
    const counts = new Map();
    for (const pixel of pixels) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
    return Math.max(...counts.values()) / pixels.length;
  }, png.toString('base64'));
  await scratch.close();
  return share > 0.9995;
}

async function within(condition) {
  for (const end = Date.now() + PATIENCE / 3; Date.now() < end; ) {
    if (await condition()) return true;
  }
  return false;
}
