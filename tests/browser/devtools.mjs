// A headless Chromium over the DevTools protocol on a pair of pipes: no port, no package.

import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync } from 'node:fs';
import { rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

const CHROMIUM = process.env.CHROMIUM ?? 'chromium';
const FLAGS = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--window-size=1440,1100',
  '--remote-debugging-pipe',
  // Pages behind the last one are looked at as well, and a container's /dev/shm may be small.
  '--disable-renderer-backgrounding',
  '--disable-background-timer-throttling',
  '--disable-backgrounding-occluded-windows',
  '--disable-dev-shm-usage',
];
/** Time limit for a missing event. It is no bound on speed, and far above the time on a busy
 * machine. */
const PATIENCE_MS = 300_000;
/** Time limit for the browser to end by itself. */
const GOODBYE_MS = 30_000;

export async function openBrowser() {
  const profile = mkdtempSync(join(tmpdir(), 'jcas-browser-'));
  const child = spawn(CHROMIUM, [...FLAGS, `--user-data-dir=${profile}`], {
    stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'],
  });
  const [requests, replies] = [child.stdio[3], child.stdio[4]];
  const waiting = new Map();
  const listeners = [];
  let nextId = 1;
  let unread = '';
  let lastWords = '';

  const failAll = (error) => { for (const { reject } of waiting.values()) reject(error); };
  child.on('error', (error) => failAll(new Error(`${CHROMIUM} does not start: ${error.message}`)));
  child.on('exit', (code, signal) =>
    failAll(new Error(`${CHROMIUM} ended with ${code ?? signal}; its last words: ${lastWords}`)),
  );
  child.stderr.setEncoding('utf8').on('data', (text) => {
    lastWords = (lastWords + text).slice(-2000);
  });
  // A pipe breaks when the browser ends, whose exit gives a better message.
  for (const pipe of [requests, replies]) pipe.on('error', () => {});
  replies.setEncoding('utf8');
  replies.on('data', (chunk) => {
    const messages = (unread + chunk).split('\0');
    unread = messages.pop();
    for (const message of messages) receive(JSON.parse(message));
  });

  function receive(message) {
    if (message.method === 'Inspector.targetCrashed') failAll(new Error('the page crashed'));
    if (message.id === undefined) return listeners.forEach((listener) => listener(message));
    const { resolve, reject } = waiting.get(message.id);
    waiting.delete(message.id);
    if (message.error) reject(new Error(message.error.message));
    else resolve(message.result);
  }

  function send(method, params = {}, sessionId = undefined) {
    const id = nextId++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(
        () => reject(new Error(`${method}: no answer in ${PATIENCE_MS} ms`)),
        PATIENCE_MS,
      );
      const settle = (finish) => (value) => { clearTimeout(timer); finish(value); };
      waiting.set(id, { resolve: settle(resolve), reject: settle(reject) });
      requests.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
  }

  async function openPage(url, dark = false) {
    const { targetId } = await send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await send('Target.attachToTarget', { targetId, flatten: true });
    const call = (method, params) => send(method, params, sessionId);
    const page = { complaints: [], requests: [], call };
    listeners.push(({ method, params, sessionId: from }) => {
      if (from !== sessionId) return;
      if (method === 'Runtime.exceptionThrown')
        page.complaints.push(
          params.exceptionDetails.exception?.description ?? params.exceptionDetails.text,
        );
      if (
        method === 'Runtime.consoleAPICalled' &&
        ['error', 'warning', 'assert'].includes(params.type)
      )
        page.complaints.push(params.args.map((arg) => arg.value).join(' '));
      if (method === 'Log.entryAdded' && ['error', 'warning'].includes(params.entry.level))
        page.complaints.push(params.entry.text);
      if (method === 'Network.requestWillBeSent') page.requests.push(params.request.url);
    });

    page.evaluate = async (expression) => {
      const { result, exceptionDetails } = await call('Runtime.evaluate', {
        expression,
        returnByValue: true,
        awaitPromise: true,
      });
      if (exceptionDetails)
        throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    };
    page.until = async (condition) => {
      const limit = Date.now() + PATIENCE_MS;
      while (!await page.evaluate(condition)) {
        if (Date.now() > limit) throw new Error(`not within ${PATIENCE_MS} ms: ${condition}`);
        await sleep(20);
      }
    };
    page.press = async (key, text = undefined) => {
      await call('Input.dispatchKeyEvent', { type: 'keyDown', key, text });
      await call('Input.dispatchKeyEvent', { type: 'keyUp', key });
    };
    page.screenshot = async () =>
      Buffer.from((await call('Page.captureScreenshot', { format: 'png' })).data, 'base64');
    page.close = () => send('Target.closeTarget', { targetId });
    /** From now on the page's clock advances by a sixtieth of a second per frame, at any real
     * speed. */
    page.countTimeInFrames = () =>
      page.evaluate(`(() => {
      const request = requestAnimationFrame.bind(window);
      const begin = performance.now();
      window.framesDrawn = 0;
      performance.now = () => begin + (1000 * window.framesDrawn) / 60;
      window.requestAnimationFrame = (draw) => request(() => {
        window.framesDrawn += 1;
        draw(performance.now());
      });
    })()`);

    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
    await call('Emulation.setEmulatedMedia', {
      features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }],
    });
    await call('Page.navigate', { url });
    await page.until('location.protocol !== "about:" && document.readyState === "complete"');
    return page;
  }

  /** The activity of the thread that draws `page` during `action`: the timeline's events, in order.
   * */
  async function trace(page, action) {
    const events = [];
    const complete = new Promise((resolve) => {
      listeners.push(({ method, params }) => {
        if (method === 'Tracing.dataCollected') events.push(...params.value);
        if (method === 'Tracing.tracingComplete') resolve();
      });
    });
    await page.call('Tracing.start', {
      transferMode: 'ReportEvents',
      traceConfig: {
        includedCategories: ['devtools.timeline', 'disabled-by-default-devtools.timeline'],
      },
    });
    await action();
    await page.call('Tracing.end');
    await complete;
    const frame = events.findLast(({ name }) => name === 'FireAnimationFrame');
    return events
      .filter(({ ph, pid, tid }) => ph === 'X' && pid === frame.pid && tid === frame.tid)
      .sort((a, b) => a.ts - b.ts);
  }

  async function close() {
    child.removeAllListeners('exit');
    if (child.pid !== undefined && child.exitCode === null && child.signalCode === null) {
      const ended = once(child, 'exit');
      send('Browser.close').catch(() => {});
      const hung = setTimeout(() => child.kill('SIGKILL'), GOODBYE_MS);
      await ended;
      clearTimeout(hung);
    }
    failAll(new Error('the browser has ended'));
    // Its helpers may still write there for a moment. Remaining files are no fault of the page.
    await rm(profile, { recursive: true, force: true, maxRetries: 20 }).catch((error) =>
      console.error(`${profile} stays: ${error.message}`),
    );
  }

  return { openPage, trace, close };
}
