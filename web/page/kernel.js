// The kernel behind the page: WebAssembly in a worker of the page, or the program that serves it.

/** The time after which an answer is given up, as `jcas play` does by default. */
const LIMIT_S = 20;

function openKernel() {
  const code = $('kernel')?.textContent.trim();
  return code ? inside(code) : behind();
}

/** The worker's own code. It answers one question at a time. */
function work() {
  let exports;
  onmessage = async ({ data: { bytes, question } }) => {
    exports ??= (await WebAssembly.instantiate(bytes, {})).instance.exports;
    const text = new TextEncoder().encode(question);
    const start = exports.question(text.length);
    new Uint8Array(exports.memory.buffer, start, text.length).set(text);
    const answer = exports.answer();
    const reply = new Uint8Array(exports.memory.buffer, answer, exports.answer_length());
    postMessage(new TextDecoder().decode(reply));
  };
}

/** A worker keeps the page alive while it computes, and can be ended at any moment. */
function inside(code) {
  const bytes = Uint8Array.from(atob(code), (letter) => letter.charCodeAt(0));
  const source = URL.createObjectURL(new Blob([`(${work})()`], { type: 'text/javascript' }));
  let worker = null;
  return (question) => new Promise((done, fail) => {
    worker ??= new Worker(source);
    const giveUp = (reason) => {
      worker.terminate();
      worker = null;
      fail(new Error(reason));
    };
    const limit = setTimeout(() => giveUp(
      `this mission takes more than ${LIMIT_S} s to compute: choose a smaller fleet, grid or ` +
        'horizon, or another policy',
    ), 1000 * LIMIT_S);
    worker.onmessage = ({ data }) => { clearTimeout(limit); done(JSON.parse(data)); };
    worker.onerror = ({ message }) => {
      clearTimeout(limit);
      giveUp(`the kernel failed: ${message}`);
    };
    worker.postMessage({ bytes, question: JSON.stringify(question) });
  });
}

function behind() {
  return async (question) => {
    const reply = await fetch('answer', {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify(question),
    });
    if (!reply.ok) throw new Error(`the program answers ${reply.status}: ${await reply.text()}`);
    return reply.json();
  };
}
