// packed.js -- unpacks what a page holds as text: gzip in base64.

/** Return the bytes of such a text. @param {string} text @returns {Promise<ArrayBuffer>} */
export const unpacked = async (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

/** Return what such a text holds as JSON. @param {string} text @returns {Promise<any>} */
export const unpackedJson = async (text) => JSON.parse(new TextDecoder().decode(await unpacked(text)));
