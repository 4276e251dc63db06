// node.mjs -- answers, in Node, what tests/publish/web/node.py asks: one line of JSON in, one line out.
//
// JSON has no typed arrays, no maps, no -0, NaN or infinity: {"$": kind, data} stands for each.

import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const load = (path) => import(pathToFileURL(path).href);
const TYPED = { Float32Array, Float64Array, Int8Array, Uint8Array, Int32Array, Uint16Array, Uint32Array };

function encoded(value) {
  if (typeof value === "number" && (!Number.isFinite(value) || Object.is(value, -0))) {
    return { $: "number", data: Object.is(value, -0) ? "-0" : String(value) };
  }
  if (ArrayBuffer.isView(value)) {
    const bytes = Buffer.from(value.buffer, value.byteOffset, value.byteLength);
    return { $: value.constructor.name, data: bytes.toString("base64") };
  }
  if (value instanceof Map) return { $: "Map", data: [...value].map((pair) => pair.map(encoded)) };
  if (value instanceof Set) return { $: "Set", data: [...value].map(encoded) };
  if (Array.isArray(value)) return value.map(encoded);
  if (value === null || typeof value !== "object") return value ?? null;
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, encoded(each)]));
}

function decoded(value) {
  if (Array.isArray(value)) return value.map(decoded);
  if (value === null || typeof value !== "object") return value;
  if (value.$ === "number") return Number(value.data);
  if (value.$ === "Map") return new Map(value.data.map((pair) => pair.map(decoded)));
  if (value.$ === "Set") return new Set(value.data.map(decoded));
  if (value.$ in TYPED) {
    const bytes = Uint8Array.from(Buffer.from(value.data, "base64"));
    return new TYPED[value.$](bytes.buffer);
  }
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, decoded(each)]));
}

/** Calls a module's function, or a script: the text of a function of the data and of what loads modules. */
async function answerTo({ folder, module, name, values, script }) {
  const inFolder = (file) => load(`${folder}/${file}`);
  if (script !== undefined) return await (0, eval)(`(${script})`)(...values, inFolder);
  return await (await inFolder(module))[name](...values);
}

for await (const line of createInterface({ input: process.stdin })) {
  let answer;
  try {
    answer = { value: encoded(await answerTo(decoded(JSON.parse(line)))) };
  } catch (error) {
    answer = { error: String(error.message ?? error), stack: String(error.stack), details: encoded({ ...error }) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
