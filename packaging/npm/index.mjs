// The kernel as WebAssembly, which imports nothing, behind two functions.

import { readFileSync } from 'node:fs';

const code = readFileSync(new URL('jcas.wasm', import.meta.url));
const kernel = new WebAssembly.Instance(new WebAssembly.Module(code)).exports;

export const about = () => ask({ ask: 'about' });

export const fly = (mission) => ask({ pilot: 'adaptive', ...mission, ask: 'fly' });

function ask(question) {
  const text = new TextEncoder().encode(JSON.stringify(question));
  const start = kernel.question(text.length);
  // A call may enlarge the memory, which replaces the buffer.
  new Uint8Array(kernel.memory.buffer, start, text.length).set(text);
  const address = kernel.answer();
  const bytes = new Uint8Array(kernel.memory.buffer, address, kernel.answer_length());
  const answer = JSON.parse(new TextDecoder().decode(bytes));
  if (answer.error !== undefined) throw new RangeError(answer.error);
  return answer;
}
