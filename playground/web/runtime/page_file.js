// page_file.js -- reads what an HTML file holds of a page: JSON, and its bytes beside.

/** @typedef {import("./schema.js").Page} Page */

/** Return a page.
 *  @param {string} text  JSON of it without `shared.blobs` @param {string} blobs  JSON of those
 *  @returns {Page} */
export function readPage(text, blobs) {
  const page = JSON.parse(text);
  page.shared.blobs = JSON.parse(blobs);
  return page;
}
