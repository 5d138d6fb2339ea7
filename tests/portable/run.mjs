// Usage: node run.mjs jcas_portable.wasm
// Instantiates the module, which imports nothing, and prints its report. The exit status is 1 if a
// trace differs.
import { readFileSync } from "node:fs";

const bytes = readFileSync(process.argv[2]);
const { instance } = await WebAssembly.instantiate(bytes, {});
const { failures, report, report_len, memory } = instance.exports;

const failed = failures();
const text = new Uint8Array(memory.buffer, report(), report_len());
process.stdout.write(new TextDecoder().decode(text));
console.log(`wasm32: ${failed} of the traces differ`);
process.exitCode = failed === 0 ? 0 : 1;
