// packed.js -- unpacks what a page holds as text: gzip in base64.

// ── Reads what an HTML file holds of a page: JSON, and its bytes beside.

/** Return the page whose JSON, but for `shared.blobs`, is the text of the element #playground-page, and
 *  whose bytes are those of elements with `data-blob`, their keys.
 *  @param {Document} document @returns {import("./schema.js").Page} */
export function readPage(document) {
  const page = JSON.parse(document.getElementById("playground-page")?.textContent ?? "");
  const elements = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[data-blob]")]);
  const blobs = elements.map(({ dataset, textContent }) => [dataset.blob, textContent]);
  page.shared.blobs = Object.fromEntries(blobs);
  return page;
}

// ── Unpacks what a page holds as text

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
