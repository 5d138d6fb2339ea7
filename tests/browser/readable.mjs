// What a person needs in order to read a page: letters of 11 px and a contrast of 4.5 : 1.

import assert from 'node:assert/strict';

/** Descriptions of the texts that are too small or too pale. Texts on the map have outlines. */
const UNREADABLE = `(() => {
  const luminance = (colour) => {
    const [r, g, b] = colour.map((part) => {
      const share = part / 255;
      return share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const parts = (text) => {
    const [r, g, b, alpha = 1] = text.match(/[\\d.]+/g).map(Number);
    return { colour: [r, g, b], alpha };
  };
  const isShown = (node) => node.getClientRects().length
    && getComputedStyle(node).visibility !== 'hidden'
    && !node.closest('script, style, noscript, option')
    && [...node.childNodes].some(({ nodeType, data }) => nodeType === 3 && data.trim());
  const behind = (node) => {
    for (let one = node; one; one = one.parentElement) {
      const { colour, alpha } = parts(getComputedStyle(one).backgroundColor);
      if (alpha > 0.5) return colour;
    }
    return [255, 255, 255];
  };
  const found = [...document.querySelectorAll('body *')].filter(isShown).flatMap((node) => {
    const style = getComputedStyle(node);
    const onMap = node.namespaceURI.endsWith('svg');
    const { a, b } = onMap ? node.getScreenCTM() : { a: 1, b: 0 };
    const px = parseFloat(style.fontSize) * Math.hypot(a, b);
    const [light, dark] = [parts(style.color).colour, behind(node)].map(luminance)
      .sort((x, y) => y - x);
    const contrast = (light + 0.05) / (dark + 0.05);
    const isReadable = px >= 10.95 && (onMap || contrast >= 4.5);
    const text = node.textContent.trim().slice(0, 30);
    return isReadable ? [] : [\`\${text}: \${px.toFixed(1)} px, \${contrast.toFixed(2)} : 1\`];
  });
  return [...new Set(found)];
})()`;

/** Looks at a page on a laptop and on a phone, in light and in dark. */
export async function isReadable(page) {
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    for (const value of ['light', 'dark']) {
      await page.call('Emulation.setDeviceMetricsOverride', {
        width,
        height,
        deviceScaleFactor: 1,
        mobile: width < 600,
      });
      const features = [{ name: 'prefers-color-scheme', value }];
      await page.call('Emulation.setEmulatedMedia', { features });
      // The map fits its letters after the layout.
      await page.evaluate('new Promise((done) => setTimeout(done, 100))');
      assert.deepEqual(await page.evaluate(UNREADABLE), [], `${width} x ${height}, ${value}`);
    }
  }
  await page.call('Emulation.setEmulatedMedia', { features: [] });
  await page.call('Emulation.clearDeviceMetricsOverride');
}
