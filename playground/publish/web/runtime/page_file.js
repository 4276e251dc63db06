// page_file.js -- reads what an HTML file holds of a page: JSON, and its bytes beside.

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
