// page_file.js -- reads what an HTML file holds of a page: JSON, all but its bytes packed.

/** @typedef {import("./schema.js").Page} Page */
/** @typedef {import("./schema.js").PageFile} PageFile */

/** Return the page that a text of JSON holds. @param {string} text @returns {Promise<Page>} */
export async function readPage(text) {
  /** @type {Page | PageFile} */
  const file = JSON.parse(text);
  if (!("packed" in file)) return file;
  const bytes = Uint8Array.from(atob(file.packed), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  /** @type {Page} */
  const page = JSON.parse(await new Response(stream).text());
  page.shared.blobs = file.blobs;
  return page;
}
