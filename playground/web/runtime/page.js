// page.js -- the entry of a page about one sketch: reads its data, and brings engine and interface together.

import { make } from "./dom.js";
import { createEngine } from "./engine.js";
import { readPage } from "./page_file.js";
import { repeatsOf } from "./planner.js";
import { createPage } from "./sketch_page.js";
import { fill, wordsOf } from "./words.js";

async function start() {
  const main = /** @type {HTMLElement} */ (document.getElementById("playground"));
  const poster = /** @type {HTMLImageElement | null} */ (document.getElementById("playground-poster"));
  const words = wordsOf(document.documentElement.lang);
  const page = await readPage(document.getElementById("playground-page")?.textContent ?? "");
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
