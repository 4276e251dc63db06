// page_file.js -- reads what an HTML file holds of a page: JSON, all but its bytes packed.

import { unpackedJson } from "./packed.js";

/** @typedef {import("./schema.js").Page} Page */
/** @typedef {import("./schema.js").PageFile} PageFile */

/** Return the page that a text of JSON holds. @param {string} text @returns {Promise<Page>} */
export async function readPage(text) {
  /** @type {Page | PageFile} */
  const file = JSON.parse(text);
  if (!("packed" in file)) return file;
  /** @type {Page} */
  const page = await unpackedJson(file.packed);
  page.shared.blobs = file.blobs;
  return page;
}
