// notebook.js -- the entry of a notebook's widgets: live figures, or pictures that the kernel draws.
//
// A widget is of a block of a lesson or of sketches, as `kind` says; traits: those of notebook_live.js or
// notebook_sketch.js. `drawn_by` says who draws. Without widgets, as in HTML that was made of a notebook,
// `revive` makes a saved figure live.

import { bookWords } from "./book_words.js";
import { make } from "./dom.js";
import { renderLive } from "./notebook_live.js";
import { renderPicture } from "./notebook_picture.js";
import { notebookWords, renderSketch } from "./notebook_sketch.js";
import { lackOf } from "./recovery.js";

// ── A figure of a notebook that was saved: live with the values it had then, no kernel.

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

// ── The entry of a notebook's widgets

/** @typedef {{model: import("./notebook_live.js").Model, el: HTMLElement}} Cell */

/** The picture of a model, as an address. @param {Cell} cell */
const urlOf = ({ model }) =>
  URL.createObjectURL(new Blob([model.get("picture")], { type: "image/png" }));

/** A block of a lesson. @param {Cell} cell */
async function renderBlock(cell) {
  const { model, el } = cell;
  let by = "kernel", close = () => {};
  if (model.get("page")) {
    const url = urlOf(cell);
    try {
      const end = await renderLive(cell, url);
      by = "browser";
      close = () => {
        end();
        URL.revokeObjectURL(url);
      };
    } catch {
      el.replaceChildren(); // no WebGL2, or too little of it: the kernel draws
      URL.revokeObjectURL(url);
    }
  }
  if (by === "kernel") close = renderPicture(cell);
  model.set("drawn_by", by);
  model.save_changes();
  return close;
}

/** Sketches; shown anew where Python shows others. @param {Cell} cell */
async function renderSketches(cell) {
  const { model, el } = cell;
  let close = () => {}, number = 0;
  async function show() {
    const own = ++number, url = urlOf(cell);
    close();
    close = () => URL.revokeObjectURL(url);
    try {
      const end = await renderSketch(cell, url, true);
      if (own === number) close = end;
      else end();
      URL.revokeObjectURL(url);
    } catch (error) {
      const sentence = lackOf(error, notebookWords(model.get("language")));
      el.replaceChildren(make("img", { src: url, alt: model.get("alt") }),
        make("p", { className: "mistake", role: "status" }, sentence));
    }
  }
  const again = () => void show();
  const events = ["change:page", "change:outline"];
  for (const event of events) model.on(event, again);
  await show();
  return () => {
    number++;
    for (const event of events) model.off(event, again);
    close();
  };
}

/** @param {Cell} cell */
const render = (cell) => (cell.model.get("kind") === "sketch" ? renderSketches(cell) : renderBlock(cell));

export default { render };
