// notebook_live.js -- a live figure of a notebook, bound to the values of a model.
//
// Traits: `page` holds all that the figure needs (gzip in base64), `values` what its controls have, by
// key, both ways.

import { settled } from "./book_data.js";
import { createBookRecovery, liveFigure } from "./book_figure.js";
import { liveCompare, liveSlider, liveSteps } from "./book_series.js";
import { bookWords } from "./book_words.js";
import { make } from "./dom.js";
import { createEngine } from "./engine.js";
import { followTheme, keepKeys } from "./notebook_sketch.js";
import { unpackedJson } from "./packed.js";

/** @import { Session } from "./session.js" */

/** @typedef {{get: (name: string) => any, set: (name: string, value: any) => void, save_changes: () => void,
 *             on: (name: string, act: () => void) => void,
 *             off: (name: string, act: () => void) => void}} Model */

const BYTES = 192 * 2 ** 20; // of textures of one figure

/** @type {Object<string, (room: import("./book_figure.js").Room) => Promise<any>>} */
const KINDS = { figure: liveFigure, steps: liveSteps, slider: liveSlider, compare: liveCompare };

/** The still pictures as a page of the book has them: one for each label.
 *  @param {Model} model @param {string} url */
function stillOf(model, url) {
  const labels = model.get("labels"), now = model.get("values").frame ?? 0;
  const image = () => make("img", { src: url, alt: model.get("alt") });
  if (!labels.length) return make("div", {}, image());
  const frames = labels.map((/** @type {string} */ label, /** @type {number} */ at) =>
    make("li", { className: at === now ? "now" : "" }, image(), make("p", {}, make("b", {}, label))));
  const list = make("ol", {}, ...frames);
  list.dataset.name = model.get("controls")[0]?.label ?? "";
  return make("div", {}, list);
}

/** The values of a session by the keys of the controls. @param {Session} session @param {Model} model */
function valuesOf(session, model) {
  return Object.fromEntries(model.get("controls").map((/** @type {{key: string}} */ { key }) => {
    const [path, part] = key.split(":"), value = session.value(path);
    return [key, Number(part === undefined ? value : /** @type {number[]} */ (value)[+part])];
  }));
}

/** Take values by key into a session. @param {Session} session @param {Object<string, number>} values */
function take(session, values) {
  /** @type {Map<string, any>} */
  const found = new Map();
  for (const [key, value] of Object.entries(values)) {
    const [path, part] = key.split(":"), row = session.row(path);
    if (!row) continue;
    if (part === undefined) found.set(path, row.type === "bool" ? Boolean(value) : value);
    else found.set(path, Object.assign([...(found.get(path) ?? session.value(path))], { [+part]: value }));
  }
  session.setAll(found, "kernel");
}

/** @param {Object<string, number>} one @param {Object<string, number>} other */
const same = (one, other) => Object.keys(one).every((key) => one[key] === other[key]);

/** Keep the values of the controls and those of the model alike.
 *  @param {Model} model @param {HTMLElement} host
 *  @param {any} figure  of a figure with sliders @param {number[]} stops  of the controls of a series */
function bind(model, host, figure, stops) {
  const send = (/** @type {Object<string, number>} */ values) => {
    if (same(values, model.get("values"))) return;
    model.set("values", values);
    model.save_changes();
  };
  /** @type {HTMLInputElement | null} */
  const range = host.querySelector(".controls input[type=range]");
  let receive = () => {};
  if (figure) {
    figure.session.follow((/** @type {string} */ news) => {
      if (news === "values") send(valuesOf(figure.session, model));
    });
    receive = () => {
      const wanted = model.get("values");
      if (!same(valuesOf(figure.session, model), wanted)) take(figure.session, wanted);
    };
  } else if (range && stops.length) {
    const frame = () => Math.max(stops.filter((stop) => stop <= +range.value).length - 1, 0);
    range.addEventListener("input", () => send({ frame: frame() }));
    receive = () => {
      if (model.get("values").frame === frame()) return;
      range.value = String(stops[model.get("values").frame]);
      range.dispatchEvent(new Event("input"));
    };
  }
  model.on("change:values", receive);
  receive();
  return () => model.off("change:values", receive);
}

/** Show a live figure in place of what is in an element; give what ends it.
 *  @param {{model: Model, el: HTMLElement}} cell @param {string} url of the picture */
export async function renderLive({ model, el }, url) {
  const language = model.get("language"), words = bookWords(language);
  const { block, sketches: bases, library } = await unpackedJson(model.get("page"));
  /** @param {import("./book_data.js").Setting} setting */
  const sketch = (setting) => settled(bases[setting.sketch], setting, library.kernels);
  const sketches = block.scenes.map(sketch);
  const engine = createEngine(document.createElement("canvas"), library, { bytes: BYTES });
  const host = make("div", { className: "live terrain-figure" }), still = stillOf(model, url);
  el.replaceChildren(host);
  const unfollow = followTheme(host);
  keepKeys(host);
  const comma = /^fr/.test(language), watched = createBookRecovery(engine, language).watch(host);
  const room = { host, still, block, sketches, begin: null, engine, watched, words, comma };
  const close = () => {
    unfollow();
    watched.end();
    engine.close();
  };
  try {
    const made = await KINDS[block.kind](room);
    const stops = block.kind === "steps" ? block.iterations
      : block.kind === "slider" ? [...sketches.keys()] : [];
    const unbind = bind(model, host, block.kind === "figure" ? made : null, stops);
    return () => {
      unbind();
      close();
    };
  } catch (error) {
    close();
    throw error;
  }
}
