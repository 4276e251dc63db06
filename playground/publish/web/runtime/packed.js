// packed.js -- unpacks what a page holds as text: gzip in base64, or after a "~" seven bits a letter.

import { undense } from "./dense.js";

/** Return the bytes of such a text. @param {string} text @returns {Promise<ArrayBuffer>} */
export const unpacked = async (text) => {
  const bytes = text[0] === "~" ? undense(text.slice(1))
    : Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

/** Return what such a text holds as JSON. @param {string} text @returns {Promise<any>} */
export const unpackedJson = async (text) => JSON.parse(new TextDecoder().decode(await unpacked(text)));
