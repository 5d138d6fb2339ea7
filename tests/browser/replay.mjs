// Drives a replay page by keys in headless Chromium and compares its display with the trace. It
// catches a page that shows another step, place or state than the trace, logs an error, or loads
// anything.
//
//   node tests/browser/replay.mjs TRACE PAGE [FOLDER-FOR-SCREENSHOTS]

import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './devtools.mjs';
import { isReadable } from './readable.mjs';

const [tracePath, pagePath, pictures] = process.argv.slice(2);
if (!tracePath || !pagePath) {
  console.error('usage: node tests/browser/replay.mjs TRACE PAGE [FOLDER-FOR-SCREENSHOTS]');
  process.exit(2);
}
const [header, ...rest] = readFileSync(tracePath, 'utf8')
  .trimEnd()
  .split('\n')
  .map((line) => JSON.parse(line));
const steps = [header, ...rest.slice(0, -1)];
const last = steps.length - 1;
const url = pathToFileURL(resolve(pagePath)).href;

/** The displayed state, read from the document alone. */
const SHOWN = `(() => {
  const text = (selector) => document.querySelector(selector).textContent.trim();
  const all = (selector) => [...document.querySelectorAll(selector)];
  const ids = (selector, name) =>
    all(selector).map((node) => Number(node.dataset[name])).sort((a, b) => a - b);
  const place = (node) => {
    const transform = node.getAttribute('transform');
    return transform.match(/translate\\(([-\\d.]+) ([-\\d.]+)\\)/).slice(1).map(Number);
  };
  const known = (row) =>
    [...row.querySelectorAll('.knows')].flatMap((node, id) =>
      node.classList.contains('yes') ? [id] : []);
  return {
    step: Number(text('#step-label').match(/Step (\\d+)/)[1]),
    slider: Number(document.querySelector('#scrub').value),
    confirmedCount: parseInt(text('#confirmed-count')),
    informedCount: parseInt(text('#informed-count')),
    confirmed: ids('.hotspot.confirmed', 'hotspot'),
    informed: ids('.hotspot.informed', 'hotspot'),
    grounded: ids('.uav.grounded', 'uav'),
    places: Object.fromEntries(all('.uav').map((node) => [node.dataset.uav, place(node)])),
    knowledge: all('#fleet tbody tr').map(known),
    links: (document.querySelector('.links').getAttribute('d').match(/M/g) ?? []).length,
    playing: document.querySelector('#play').classList.contains('playing'),
    speed: document.querySelector('#speed').value,
    helpOpen: document.querySelector('#help').open,
    hash: location.hash,
    title: document.title,
    footer: text('#footer'),
    selected: all('.uav.selected').map((node) => Number(node.dataset.uav)),
  };
})()`;

/** Map units of one cell in the page's drawing. */
const CELL = 40;
/** The UAVs of one cell are spread at most this many cells from its centre, more on large grids. */
const FAN_OUT =
  0.7 * Math.max(1, Math.max(header.config.grid_width, header.config.grid_height) / 26);

function assertShows(shown, t) {
  const step = steps[t];
  assert.equal(shown.step, t, 'step label');
  assert.equal(shown.slider, t, 'slider');
  assert.deepEqual(shown.confirmed, step.confirmed ?? [], `confirmed hotspots at step ${t}`);
  assert.deepEqual(shown.informed, step.informed ?? [], `informed hotspots at step ${t}`);
  assert.equal(shown.confirmedCount, shown.confirmed.length);
  assert.equal(shown.informedCount, shown.informed.length);
  assert.deepEqual(shown.grounded, step.grounded ?? [], `grounded UAVs at step ${t}`);
  assert.equal(shown.links, step.links?.length ?? 0, `links at step ${t}`);
  if (header.hotspots.length <= 24)
    assert.deepEqual(
      shown.knowledge,
      step.knowledge ?? header.initial.positions.map(() => []),
      `knowledge at step ${t}`,
    );
  const positions = step.positions ?? header.initial.positions;
  assert.equal(Object.keys(shown.places).length, positions.length);
  positions.forEach(([x, y], id) => {
    const [shownX, shownY] = shown.places[id];
    const [dx, dy] = [
      shownX / CELL - (x + 0.5),
      header.config.grid_height - shownY / CELL - (y + 0.5),
    ];
    assert.ok(
      Math.hypot(dx, dy) < FAN_OUT,
      `UAV ${id} at step ${t}: drawn ${dx}, ${dy} cells from (${x}, ${y})`,
    );
    const alone = positions.filter(([ox, oy]) => ox === x && oy === y).length === 1;
    if (alone)
      assert.ok(
        Math.hypot(dx, dy) < 0.01,
        `UAV ${id} is alone in its cell at step ${t}, but not drawn at its centre`,
      );
  });
}

async function everyStepAgrees(page) {
  await page.press('Home');
  for (let t = 0; t <= last; t += 1) {
    assertShows(await page.evaluate(SHOWN), t);
    await page.press('ArrowRight');
  }
  assertShows(await page.evaluate(SHOWN), last);
}

async function keysWork(page) {
  const shown = () => page.evaluate(SHOWN);
  await page.press('Home');
  assertShows(await shown(), 0);
  await page.press('End');
  assertShows(await shown(), last);
  await page.press('ArrowLeft');
  assertShows(await shown(), Math.max(0, last - 1));
  await page.press('Home');
  await page.press('u', 'u');
  assert.deepEqual((await shown()).selected, [0]);
  assert.equal((await shown()).hash, '#t=0&uav=0');
  await page.press('Escape');
  assert.deepEqual((await shown()).selected, []);
  await page.press('+', '+');
  assert.equal((await shown()).speed, '2');
  await page.press('-', '-');
  assert.equal((await shown()).speed, '1');
  await page.press('?', '?');
  assert.equal((await shown()).helpOpen, true);
  await page.evaluate(`new Promise((done) => {
    document.querySelector('#help').addEventListener('close', () => done(), { once: true });
    document.querySelector('#help button').click();
  })`);
}

async function playingReachesTheEnd(page) {
  await page.countTimeInFrames();
  await page.press('Home');
  // The slowest speed lets a short mission still play when the test pauses it.
  for (let k = 0; k < 6; k += 1) await page.press('-', '-');
  await page.press(' ', ' ');
  assert.equal((await page.evaluate(SHOWN)).playing, true);
  await page.press(' ', ' ');
  assert.equal((await page.evaluate(SHOWN)).playing, false);
  for (let k = 0; k < 9; k += 1) await page.press('+', '+');
  await page.press(' ', ' ');
  await page.until('!document.querySelector("#play").classList.contains("playing")');
  assertShows(await page.evaluate(SHOWN), last);
}

async function addressOpensItsStep(browser) {
  const t = Math.floor(last / 2);
  const page = await browser.openPage(`${url}#t=${t}&uav=0`);
  const shown = await page.evaluate(SHOWN);
  assertShows(shown, t);
  assert.deepEqual(shown.selected, [0]);
  return page;
}

async function narrowScreenFits(page) {
  await page.call('Emulation.setDeviceMetricsOverride', {
    width: 380,
    height: 800,
    deviceScaleFactor: 1,
    mobile: true,
  });
  const overflow = await page.evaluate(
    'document.documentElement.scrollWidth - document.documentElement.clientWidth',
  );
  await page.call('Emulation.clearDeviceMetricsOverride');
  assert.ok(overflow <= 0, `the page is ${overflow} px wider than a narrow screen`);
}

async function keepPictures(browser) {
  mkdirSync(pictures, { recursive: true });
  for (const [name, dark] of [['light', false], ['dark', true]]) {
    const page = await browser.openPage(`${url}#t=${Math.floor(last * 0.6)}&uav=0`, dark);
    writeFileSync(join(pictures, `replay-${name}.png`), await page.screenshot());
  }
}

const browser = await openBrowser();
try {
  const page = await browser.openPage(url);
  const { title, footer } = await page.evaluate(SHOWN);
  assert.ok(title.includes(header.policy) && title.includes(header.seed), `title ${title}`);
  assert.match(footer, new RegExp(`Preset [a-z]+.* configuration ${header.config_hash}`));
  const opened = await page.evaluate(SHOWN);
  assert.ok(last === 0 || opened.playing || opened.step > 0, 'the page plays by itself');
  await everyStepAgrees(page);
  await keysWork(page);
  await playingReachesTheEnd(page);
  await narrowScreenFits(page);
  await isReadable(page);
  const linked = await addressOpensItsStep(browser);
  if (pictures) await keepPictures(browser);
  for (const { complaints, requests } of [page, linked]) {
    assert.deepEqual(complaints, [], 'console errors');
    assert.deepEqual(
      requests.filter((address) => !address.startsWith(url) && !address.startsWith('data:')),
      [],
      'the page loads something',
    );
  }
  console.log(`replay page agrees with its trace at all ${last + 1} steps`);
} finally {
  await browser.close();
}
