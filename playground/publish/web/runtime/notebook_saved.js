// notebook_saved.js -- a figure of a notebook that was saved: live with the values it had then, no kernel.

import { bookWords } from "./book_words.js";
import { make } from "./dom.js";
import { lackOf } from "./lacks.js";
import { renderLive } from "./notebook_live.js";
import { renderSketch } from "./notebook_sketch.js";

/** What a widget had when its notebook was saved.
 *  @typedef {{kind?: string, page: string, language: string, labels: string[], alt: string,
 *             controls: Object<string, any>[], values: Object<string, number>}} Saved */

/** A model as a widget has it, which nobody else listens to.
 *  @param {Object<string, any>} state @returns {import("./notebook_live.js").Model} */
function modelOf(state) {
  /** @type {Object<string, Set<() => void>>} */
  const heard = {};
  return {
    get: (name) => state[name],
    set(name, value) {
      state[name] = value;
      for (const act of heard[`change:${name}`] ?? []) act();
    },
    save_changes() {},
    on: (name, act) => { (heard[name] ??= new Set()).add(act); },
    off: (name, act) => { heard[name]?.delete(act); },
  };
}

/** Make a saved figure live in the place of its picture, which stays where the browser cannot draw it.
 *  @param {HTMLElement} place  with the picture in it @param {Saved} saved */
export async function revive(place, saved) {
  const image = /** @type {HTMLImageElement} */ (place.querySelector("img"));
  const words = bookWords(saved.language);
  try {
    const cell = { model: modelOf({ ...saved }), el: place };
    if (saved.kind === "sketch") await renderSketch(cell, image.src, false);
    else await renderLive(cell, image.src);
  } catch (error) {
    const sentence = make("p", { className: "mistake", role: "status" }, lackOf(error, words));
    place.replaceChildren(image, sentence);
  }
}
