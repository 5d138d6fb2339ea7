// Films a mission of the playground: it takes one picture for each part of a step, for an animated
// image in a document.
//
//   cargo xtask web
//   node web/film.mjs target/web/index.html MISSION FOLDER [PARTS]
//   img2webp -loop 0 -lossy -q 70 -d 120 FOLDER/*.png -o film.webp

import { mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from '../tests/browser/devtools.mjs';

const [page, mission, folder, parts = '3'] = process.argv.slice(2);
if (!folder) {
  console.error("usage: node web/film.mjs PAGE MISSION FOLDER [PARTS-OF-A-STEP]");
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const browser = await openBrowser();
try {
  const address = pathToFileURL(resolve(page)).href;
  const view = await browser.openPage(`${address}#m=${encodeURIComponent(mission)}&t=0`);
  await view.evaluate(`new Promise((done) => {
    const isShown = () => document.querySelector('#hash').textContent;
    const look = () => (isShown() ? done() : setTimeout(look, 50));
    look();
  })`);
  const card = await view.evaluate(`(() => {
    const { x, y, width, height } = document.querySelector('.stage-card').getBoundingClientRect();
    return { x: x + scrollX, y: y + scrollY, width, height };
  })()`);
  const last = await view.evaluate(`Number(document.querySelector('#scrub').max)`);
  const frames = last * Number(parts);
  for (let frame = 0; frame <= frames; frame += 1) {
    await view.evaluate(`(() => {
      const input = document.querySelector('#scrub');
      input.step = 'any';
      input.value = ${frame / Number(parts)};
      input.dispatchEvent(new Event('input'));
    })()`);
    const shot = await view.call('Page.captureScreenshot', {
      format: 'png',
      captureBeyondViewport: true,
      clip: { ...card, scale: 0.75 },
    });
    const name = `${String(frame).padStart(4, '0')}.png`;
    writeFileSync(join(folder, name), Buffer.from(shot.data, 'base64'));
  }
  console.log(`${frames + 1} pictures in ${folder}`);
} finally {
  await browser.close();
}
