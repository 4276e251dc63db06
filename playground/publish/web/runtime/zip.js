// zip.js -- a zip of some files: the same files give the same bytes.
//
// PKWARE's APPNOTE 6.3.10: local headers with the files, the central directory, its end. Dates are the
// first that a zip can say; names are UTF-8 and sorted. Files are deflated where the browser can.

/** A file: as it is stored, bytes that it has, its checksum, where its header is.
 *  @typedef {{name: Uint8Array, data: Uint8Array, size: number, crc: number, method: 0 | 8,
 *             at: number}} Entry */

const STORED = 0, DEFLATED = 8;
const VERSION = 20, UTF8 = 0x800, MADE_BY_UNIX = 3 << 8, PLAIN_FILE = 0o100644 * 0x10000;
const DATE = (1 << 5) | 1; // 1 January 1980, midnight

const TABLE = new Uint32Array(256).map((_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit++) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value;
});

/** CRC-32 of some bytes (ISO 3309), as zips have it.
 *  @param {Uint8Array} bytes @returns {number} */
export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

/** Make a zip.
 *  @param {Map<string, string | Uint8Array>} files   by name, folders with "/"
 *  @param {{store?: boolean}} [options]   store: nothing is deflated
 *  @returns {Promise<Uint8Array<ArrayBuffer>>} */
export async function zip(files, { store = false } = {}) {
  const encoder = new TextEncoder();
  /** @type {Entry[]} */
  const entries = [];
  /** @type {Uint8Array[]} */
  const parts = [];
  let at = 0;
  const add = (/** @type {Uint8Array} */ part) => { parts.push(part); at += part.length; };
  for (const name of [...files.keys()].sort(byCodePoint)) {
    const given = /** @type {string | Uint8Array} */ (files.get(name));
    const bytes = typeof given === "string" ? encoder.encode(given) : given;
    const packed = store ? null : await deflated(bytes), small = packed && packed.length < bytes.length;
    /** @type {Entry} */
    const entry = {
      name: encoder.encode(name), data: small ? packed : bytes, size: bytes.length, crc: crc32(bytes),
      method: small ? DEFLATED : STORED, at,
    };
    entries.push(entry);
    add(header(0x04034b50, [[2, VERSION], ...common(entry), [2, 0]]));
    add(entry.name);
    add(entry.data);
  }
  const start = at;
  for (const entry of entries) {
    const more = [[2, 0], [2, 0], [2, 0], [2, 0], [4, PLAIN_FILE], [4, entry.at]];
    add(header(0x02014b50, [[2, VERSION | MADE_BY_UNIX], [2, VERSION], ...common(entry), ...more]));
    add(entry.name);
  }
  const count = entries.length;
  add(header(0x06054b50, [[2, 0], [2, 0], [2, count], [2, count], [4, at - start], [4, start], [2, 0]]));
  return joined(parts, at);
}

/** What a file's local header and its row in the directory have alike.
 *  @param {Entry} entry @returns {number[][]} */
function common({ method, crc, data, size, name }) {
  return [[2, UTF8], [2, method], [2, 0], [2, DATE], [4, crc], [4, data.length], [4, size], [2, name.length]];
}

/** @param {number} signature @param {number[][]} fields  bytes and value of each, little-endian
 *  @returns {Uint8Array} */
function header(signature, fields) {
  const all = [[4, signature], ...fields], bytes = new Uint8Array(all.reduce((sum, [size]) => sum + size, 0));
  const view = new DataView(bytes.buffer);
  let at = 0;
  for (const [size, value] of all) {
    if (size === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += size;
  }
  return bytes;
}

/** @param {Uint8Array[]} parts @param {number} size @returns {Uint8Array<ArrayBuffer>} */
function joined(parts, size) {
  const found = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    found.set(part, at);
    at += part.length;
  }
  return found;
}

/** @param {Uint8Array} bytes @returns {Promise<Uint8Array | null>} null: this browser cannot */
async function deflated(bytes) {
  try {
    const given = new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)]).stream();
    const made = new Response(given.pipeThrough(new CompressionStream("deflate-raw")));
    return new Uint8Array(await made.arrayBuffer());
  } catch {
    return null;
  }
}

/** In the order of code points, as Python sorts names.
 *  @param {string} a @param {string} b */
function byCodePoint(a, b) {
  const [x, y] = [a, b].map((text) => [...text].map((one) => /** @type {number} */ (one.codePointAt(0))));
  const at = x.findIndex((code, place) => code !== y[place]);
  return at < 0 ? x.length - y.length : x[at] - (y[at] ?? -1);
}
