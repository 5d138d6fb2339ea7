// Opens the documentation site from its folder in headless Chromium. It catches a page that loads
// anything from outside, logs an error, lacks a picture or is wider than a phone. It also catches a
// search that finds nothing.
//
//   node tests/browser/site.mjs FOLDER [FOLDER-FOR-SCREENSHOTS]

import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './devtools.mjs';

const [folder, pictures] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node tests/browser/site.mjs FOLDER [FOLDER-FOR-SCREENSHOTS]');
  process.exit(2);
}
const PAGES = [
  'index', 'docs/c', 'python/index', 'docs/campaigns', 'docs/cookbook', 'docs/model', 'docs/trust',
  'lab/results', 'reference/python', 'reference/c', 'reference/c/group__model',
  'reference/c/structjcas__config', 'reference/fields', 'reference/commands',
  'reference/policies', 'reference/rust', 'reference/rust/jcas_core/index',
];
/** The width of a common phone, in CSS pixels. */
const PHONE = { width: 390, height: 844, deviceScaleFactor: 2, mobile: true };
const urlOf = (page) => pathToFileURL(resolve(folder, `${page}.html`)).href;

async function look(browser, name) {
  const page = await browser.openPage(urlOf(name));
  // Scripts add pictures after the page has loaded.
  await page
    .until('[...document.images].every((image) => image.complete && image.naturalWidth)')
    .catch(() => assert.fail(`${name}: a picture is missing`));
  await page.call('Emulation.setDeviceMetricsOverride', PHONE);
  const width = await page.evaluate('document.documentElement.scrollWidth');
  assert.ok(width <= PHONE.width, `${name}: ${width} pixels wide on a phone of ${PHONE.width}`);
  if (pictures) {
    mkdirSync(pictures, { recursive: true });
    writeFileSync(join(pictures, `${name.replaceAll('/', '-')}.png`), await page.screenshot());
  }
  return page;
}

async function search(page, words) {
  await page.evaluate(`(() => {
    document.querySelector('#__search').click();
    const field = document.querySelector('.md-search__input');
    field.focus();
    field.value = ${JSON.stringify(words)};
    field.dispatchEvent(new KeyboardEvent('keyup', { bubbles: true }));
    field.dispatchEvent(new InputEvent('input', { bubbles: true }));
  })()`);
  await page.until("document.querySelectorAll('.md-search-result__item').length > 0");
}

/** The titles that the search finds, the best first. */
const found = (page) =>
  page.evaluate(`[...document.querySelectorAll('.md-search-result__item h1')]
    .map((node) => node.textContent)`);

/** The copy button of a console block gives the commands without prompts. */
async function copiesCommands(page) {
  await page.evaluate(`navigator.clipboard.writeText = (text) => { window.copied = text; };
    document.querySelector('.highlight button').click()`);
  const copied = await page.evaluate('window.copied');
  assert.match(copied, /^cargo run .*\npip install .\/python$/);
}

const browser = await openBrowser();
try {
  for (const name of PAGES) {
    const page = await look(browser, name);
    if (name === 'index') {
      await copiesCommands(page);
      for (const [words, title] of [['Swerling', 'The model'], ['jcas_batch_step', 'jcas_batch']]) {
        await search(page, words);
        const titles = await found(page);
        assert.ok(titles[0].startsWith(title), `${words}: ${titles.slice(0, 3)}`);
      }
    }
    const outside = page.requests.filter((url) => !/^(file|data|about|blob):/.test(url));
    assert.deepEqual(outside, [], `${name} loads from outside`);
    assert.deepEqual(page.complaints, [], `${name} logs an error`);
    await page.close();
  }
} finally {
  await browser.close();
}
console.log(`${PAGES.length} pages of ${folder}: nothing from outside, nothing missing`);
