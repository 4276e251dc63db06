// page.js -- the entry of a page about one sketch: reads its data, and brings engine and interface together.

import { make } from "./dom.js";
import { EDITOR_WORDS } from "./editor_words.js";
import { createEngine } from "./engine.js";
import { readPage } from "./packed.js";
import { createCode } from "./page_code.js";
import { PAGE_WORDS } from "./page_words.js";
import { repeatsOf } from "./plan.js";
import { createRecovery } from "./recovery.js";
import { createPage } from "./sketch_page.js";
import { wordsOf } from "./words.js";

function start() {
  const main = /** @type {HTMLElement} */ (document.getElementById("playground"));
  const poster = /** @type {HTMLImageElement | null} */ (document.getElementById("playground-poster"));
  const words = wordsOf(document.documentElement.lang, PAGE_WORDS, EDITOR_WORDS);
  const page = readPage(document);
  const canvas = document.createElement("canvas");
  let engine;
  try {
    engine = createEngine(canvas, page.shared);
  } catch (error) {
    main.classList.add("still");
    const above = make("div", { className: "recoveries" }); // a picture may be taller than the window
    main.prepend(above);
    return createRecovery(above, { words, poster: () => {} }).lacks(error);
  }
  const repeats = (/** @type {any} */ player) => (player.plan ? repeatsOf(player.plan) : new Map());
  const notices = make("div", { className: "recoveries" });
  /** @type {() => import("./page_code.js").CodeFigure} */
  const shown = () => made.figure;
  const code = createCode(engine, notices, { words, figure: shown });
  const made = createPage(main, page, engine, {
    words, poster, repeats, prepare: (player) => code.prepare(/** @type {any} */ (player)),
    openCode: (tab, player) => void code.open(tab, /** @type {any} */ (player)),
    trace: /** @type {any} */ (globalThis).playgroundTrace,
  });
  made.figure.stage.append(notices);
  code.watch();
  return undefined;
}

start();
