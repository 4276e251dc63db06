// page.js -- the entry of a page about one sketch: reads its data, and brings engine and interface together.

import { make } from "./dom.js";
import { createEngine } from "./engine.js";
import { unpacked } from "./images.js";
import { repeatsOf } from "./planner.js";
import { createPage } from "./sketch_page.js";
import { fill, wordsOf } from "./words.js";

/** @typedef {import("./schema.js").Page} Page */

/** What the page's file holds: its data as they are, or packed but for the bytes.
 *  @returns {Promise<Page>} */
async function readPage() {
  const data = JSON.parse(document.getElementById("playground-page")?.textContent ?? "");
  if (!data.packed) return data;
  const page = JSON.parse(new TextDecoder().decode(await unpacked(data.packed)));
  page.shared.blobs = data.blobs;
  return page;
}

async function start() {
  const main = /** @type {HTMLElement} */ (document.getElementById("playground"));
  const poster = /** @type {HTMLImageElement | null} */ (document.getElementById("playground-poster"));
  const words = wordsOf(document.documentElement.lang), page = await readPage();
  const canvas = document.createElement("canvas");
  let engine;
  try {
    engine = createEngine(canvas, page.shared);
  } catch (error) {
    main.classList.add("still");
    const reason = error instanceof Error ? error.message : String(error);
    return main.append(make("p", { role: "alert" }, fill(words.still, { reason })));
  }
  const repeats = (/** @type {any} */ player) => (player.plan ? repeatsOf(player.plan) : new Map());
  const { figure } = createPage(main, page, engine, { words, poster, repeats });
  canvas.addEventListener("webglcontextlost", () => figure.showPoster(true));
  canvas.addEventListener("webglcontextrestored", async () => {
    await engine.restore();
    await figure.redraw();
  });
  return undefined;
}

start();
