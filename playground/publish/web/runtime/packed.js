// packed.js -- unpacks what a page holds as text: gzip in base64.

/** Return the bytes of such a text. @param {string} text @returns {Promise<ArrayBuffer>} */
export const unpacked = async (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

/** Return what such a text holds as text. @param {string} text @returns {Promise<string>} */
export const unpackedText = async (text) =>
  new TextDecoder("utf-8", { ignoreBOM: true }).decode(await unpacked(text));

/** Return what such a text holds as JSON. @param {string} text @returns {Promise<any>} */
export const unpackedJson = async (text) => JSON.parse(await unpackedText(text));
