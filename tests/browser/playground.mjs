// Drives the playground in headless Chromium: once with the kernel inside the page, once with `jcas
// play` behind it. It catches a mission whose bits differ between the two, and a control that does
// nothing. It also catches a page that logs an error or does not fit a phone.
//
//   node tests/browser/playground.mjs PAGE JCAS [FOLDER-FOR-SCREENSHOTS]

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './devtools.mjs';
import { isReadable } from './readable.mjs';

const [pagePath, command, pictures] = process.argv.slice(2);
if (!pagePath || !command) {
  console.error('usage: node tests/browser/playground.mjs PAGE JCAS [FOLDER-FOR-SCREENSHOTS]');
  process.exit(2);
}
const file = pathToFileURL(resolve(pagePath)).href;

const MISSIONS = [
  {},
  { set: { uav_count: 15, hotspot_count: 7 }, seed: 4 },
  { preset: 'paper', policy: 'random', pilot: 'mid', set: { uav_count: 100, hotspot_count: 11 } },
  {
    policy: 'greedy',
    pilot: '0.15',
    set: { sensing_range_m: 150, quorum: 2 },
    moved: [[0, [0, 0]]],
  },
  {
    policy: 'line',
    set: { target_visibility: 'hidden', uav_count: 5 },
    interventions: [
      { do: 'steer', t: 2, uav: 1, motion: 0 },
      { do: 'ground', t: 5, uav: 3 },
    ],
  },
];

/** Starts `jcas play` and waits for the address that it prints. */
function serve() {
  const child = spawn(command, ['play', '--no-open'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const address = new Promise((done, fail) => {
    child.stdout.setEncoding('utf8').once('data', (text) => done(text.trim()));
    child.once('exit', (code) => fail(new Error(`${command} play ended with ${code}`)));
  });
  return { child, address };
}

const addressOf = (base, mission, t = 0) =>
  `${base}#m=${encodeURIComponent(JSON.stringify(mission))}&t=${t}`;
const READY = 'document.querySelector("#hash")?.textContent.startsWith("0x")';
const text = (page, selector) =>
  page.evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);
const click = (page, selector) =>
  page.evaluate(
    `document.querySelector(${JSON.stringify(selector)})
      .dispatchEvent(new MouseEvent('click', { bubbles: true }))`,
  );

async function open(browser, address) {
  const page = await browser.openPage(address);
  await page.until(READY);
  return page;
}

/** The hash of the last state, as the page shows it at the end of the mission. */
async function lastHash(page) {
  await page.press('End');
  return text(page, '#hash');
}

/** The program's answer to the same request that the page sends. */
async function nativeHash(
  base,
  {
    preset = 'mission',
    set = {},
    policy = 'teams',
    pilot = 'adaptive',
    seed = 1,
    moved = [],
    interventions = [],
  },
) {
  const config = { preset, ...set };
  const question = { ask: 'fly', config, policy, pilot, seed, moved, interventions };
  const reply = await fetch(`${base}answer`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify(question),
  });
  const answer = await reply.json();
  assert.equal(answer.error, undefined);
  return answer.state_hash;
}

async function sameBits(browser, served) {
  for (const mission of MISSIONS) {
    const native = await nativeHash(served, mission);
    for (const base of [file, served]) {
      const page = await open(browser, addressOf(base, mission));
      assert.equal(await lastHash(page), native, `${JSON.stringify(mission)} at ${base}`);
      assert.deepEqual(page.complaints, []);
      await page.close();
    }
  }
}

async function controlsWork(page) {
  const change = (id, value) =>
    page.evaluate(
      `(() => {
        const input = document.querySelector('#${id}');
        input.value = ${JSON.stringify(value)};
        input.dispatchEvent(new Event('change'));
      })()`,
    );
  const before = await lastHash(page);
  await change('uavs', '12');
  await page.until('document.querySelectorAll(".uav").length === 12');
  await change('seed', '9');
  await page.until('location.hash.includes("seed")');
  assert.notEqual(await lastHash(page), before);

  // A value that the kernel refuses is named, and the mission stays on the screen.
  await change('pilot', '7');
  await page.until('!document.querySelector("#problem").hidden');
  assert.match(await text(page, '#problem'), /7/);
  await change('pilot', 'max');
  await page.until('document.querySelector("#problem").hidden');

  // The controls of UAV 0: it flies where the arrow keys send it.
  await page.press('Home');
  await page.press('u', 'u');
  await click(page, '#steer');
  const place = () =>
    page.evaluate(
      `document.querySelector('.uav[data-uav="0"]').getAttribute('transform')
        .match(/translate\\(([-\\d.]+) ([-\\d.]+)/).slice(1).map(Number)`,
    );
  for (const [t, key] of ['ArrowLeft', 'ArrowLeft', 'ArrowUp'].entries()) {
    await page.press(key);
    await page.until(
      `document.querySelector('#step-label').textContent.startsWith('Step ${t + 1} ')`,
    );
  }
  const [x, y] = await place();
  assert.deepEqual(
    [Math.floor(x / 40), 11 - Math.floor(y / 40)],
    [4, 7],
    'two cells left of the depot at (6, 6), one up',
  );
  await click(page, '#steer');

  // The UAV is grounded from the next step on.
  await click(page, '#ground');
  await page.until('location.hash.includes("ground")');
  await page.press('ArrowRight');
  assert.equal(
    await page.evaluate(
      'document.querySelector(".uav[data-uav=\\"0\\"]").classList.contains("grounded")',
    ),
    true,
  );
  await click(page, '#undo');
  await page.until('!location.hash.includes("ground")');
}

async function hotspotsCanBeDragged(page) {
  // At the start no UAV stands over a hotspot.
  await page.press('Home');
  await page.evaluate('document.querySelector("#stage").scrollIntoView({ block: "center" })');
  const box = await page.evaluate(
    `(() => {
      const { x, y, width, height } = document.querySelector('.field').getBoundingClientRect();
      return { x, y, width, height };
    })()`,
  );
  const centre = await page.evaluate(
    `(() => {
      const box = document.querySelector('.hotspot .box').getBoundingClientRect();
      return [box.x + box.width / 2, box.y + box.height / 2];
    })()`,
  );
  const corner = [box.x + box.width / 24, box.y + box.height * 23 / 24];
  const mouse = (type, [x, y]) =>
    page.call('Input.dispatchMouseEvent', {
      type,
      x,
      y,
      button: 'left',
      buttons: 1,
      clickCount: 1,
    });
  await mouse('mousePressed', centre);
  await mouse('mouseMoved', corner);
  await mouse('mouseReleased', corner);
  await page.until('decodeURIComponent(location.hash).includes(\'"moved":[[0,[0,0]]]\')');
}

/** A policy that plans shows the plans of all UAVs or of the selected one. A script has none. */
async function plansAreDrawn(browser, base) {
  const drawn = 'document.querySelector(".planned").getAttribute("d") ?? ""';
  const lines = async (page) => (await page.evaluate(drawn)).split('M').length - 1;
  const set = { uav_count: 6, hotspot_count: 2 };
  const mission = { preset: 'search', policy: 'plan', set };
  const planned = await open(browser, addressOf(base, mission, 1));
  assert.equal(await lines(planned), 6);
  await click(planned, '.uav[data-uav="2"]');
  await planned.until(`(${drawn}).split('M').length === 2`);
  assert.equal(await lines(await open(browser, addressOf(base, {}, 1))), 0);
  assert.deepEqual(planned.complaints, [], 'console errors');
}

async function fitsAPhone(page) {
  await page.call('Emulation.setDeviceMetricsOverride', {
    width: 360,
    height: 740,
    deviceScaleFactor: 1,
    mobile: true,
  });
  const overflow = await page.evaluate(
    'document.documentElement.scrollWidth - document.documentElement.clientWidth',
  );
  const nameless = await page.evaluate(
    `[...document.querySelectorAll('#controls input, #controls select')]
      .filter((node) => !node.labels.length)
      .map((node) => node.id)`,
  );
  await page.call('Emulation.clearDeviceMetricsOverride');
  assert.ok(overflow <= 0, `the page is ${overflow} px wider than a phone`);
  assert.deepEqual(nameless, [], 'inputs without a label');
}

/** The map, its transport and the scenes share a laptop's screen; map and transport a phone's. */
async function fitsOneScreen(page) {
  const screens = [
    [1280, 800, ['.field', '#play', '#scrub', '#scenes', '#steer']],
    [390, 844, ['.field', '#play', '#scrub']],
  ];
  for (const [width, height, shown] of screens) {
    await page.call('Emulation.setDeviceMetricsOverride', {
      width,
      height,
      deviceScaleFactor: 1,
      mobile: width < 600,
    });
    await page.evaluate('scrollTo(0, 0)');
    for (const selector of shown) {
      const { top, bottom } = await page.evaluate(
        `document.querySelector('${selector}').getBoundingClientRect().toJSON()`,
      );
      assert.ok(top >= 0 && bottom <= height, `${selector}: ${top} to ${bottom} of ${height} px`);
    }
  }
  await page.call('Emulation.clearDeviceMetricsOverride');
}

/** A link that cannot be flown says why, and the first scene flies. */
async function brokenLinks(browser, base) {
  for (const [mission, reason] of [
    ['{"policy":"nobody"}', 'policy = nobody'],
    ['{"set":null}', 'set must be an object'],
    ['{"preset":"moon"}', 'moon'],
    ['{', 'JSON'],
  ]) {
    const page = await open(browser, `${base}#m=${encodeURIComponent(mission)}`);
    const said = await text(page, '#problem');
    assert.ok(said.includes(reason), `${mission}: ${said}`);
    assert.ok(said.includes('the first scene instead'), said);
    await page.close();
  }
}

/** A tap beside a steered UAV sends it there. */
async function tapsSteer(page) {
  await page.press('Home');
  await page.press('u', 'u');
  await click(page, '#steer');
  const from = await page.evaluate(
    `(() => {
      const box = document.querySelector('.uav.selected').getBoundingClientRect();
      return [box.x + box.width / 2, box.y + box.height / 2];
    })()`,
  );
  await page.evaluate(
    `document.elementFromPoint(${from[0] - 90}, ${from[1]}).dispatchEvent(new MouseEvent('click', {
      bubbles: true, clientX: ${from[0] - 90}, clientY: ${from[1]},
    }))`,
  );
  await page.until('decodeURIComponent(location.hash).includes(\'"motion":2\')');
  await click(page, '#steer');
  await click(page, '#undo');
}

/** A mission of a hundred UAVs that lasts until the horizon. */
const LARGE = { policy: 'random', set: { uav_count: 100, hotspot_count: 11, quorum: 100 } };
const FRAMES = 130;

/** The cost of a frame while a large mission plays, in ms of the page's own thread. It covers
 * script, style, layout and painting, without waiting for a processor. Time is counted in frames,
 * so that a busy machine draws the same frames. The figures are informative and have no limit. */
async function frameWork(browser) {
  const page = await open(browser, addressOf(file, LARGE, 10));
  await page.countTimeInFrames();
  const events = await browser.trace(page, async () => {
    await page.press(' ', ' ');
    await page.until(`window.framesDrawn >= ${FRAMES}`);
  });
  const begins = events.filter(({ name }) => name === 'FireAnimationFrame').map(({ ts }) => ts);
  // The first frames belong to a page whose layout is not finished.
  const work = begins.slice(5, -1).map((from, k) => {
    const within = ({ name, ts, dur }) =>
      name === 'RunTask' && ts + dur > from && ts + dur <= begins[k + 6];
    return events.filter(within).reduce((sum, { tdur }) => sum + tdur / 1000, 0);
  }).sort((a, b) => a - b);
  return { median: work[work.length >> 1], most: work[Math.floor(work.length * 0.99)] };
}

const server = serve();
const browser = await openBrowser();
try {
  const served = await server.address;
  await sameBits(browser, served);
  for (const base of [file, served]) {
    const page = await open(browser, base);
    await page.until('document.querySelector("#play").classList.contains("playing")');
    await controlsWork(page);
    await hotspotsCanBeDragged(page);
    await fitsAPhone(page);
    await tapsSteer(page);
    await fitsOneScreen(page);
    await isReadable(page);
    await brokenLinks(browser, base);
    assert.deepEqual(page.complaints, [], 'console errors');
    assert.deepEqual(
      page.requests.filter(
        (address) => ![base, 'data:', 'blob:'].some((own) => address.startsWith(own)),
      ),
      [],
      'the page loads something',
    );
  }
  await plansAreDrawn(browser, served);
  if (pictures) {
    mkdirSync(pictures, { recursive: true });
    const page = await open(
      browser,
      addressOf(file, { preset: 'paper', set: { uav_count: 15, hotspot_count: 7 } }, 8),
    );
    writeFileSync(join(pictures, 'playground.png'), await page.screenshot());
  }
  const { median, most } = await frameWork(browser);
  console.log(
    `playground: ${MISSIONS.length} missions are the same bits in WebAssembly and natively; ` +
      `a frame at N = 100 takes ${median.toFixed(1)} ms of its thread, median, ` +
      `and ${most.toFixed(1)} ms, 99th percentile`,
  );
} finally {
  await browser.close();
  server.child.kill();
}
