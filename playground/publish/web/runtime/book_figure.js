// book_figure.js -- a live picture in the text of a book, what can be dragged of it, its time.

import { bookWords } from "./book_words.js";
import { makeRow, whyLocked } from "./controls.js";
import { button, make } from "./dom.js";
import { createFigure } from "./figure.js";
import { labelOf } from "./labels.js";
import { createRecovery } from "./recovery.js";
import { createSession } from "./session.js";
import { createTimeline, hasTime } from "./timeline.js";

/** @import { LiveBlock } from "./book_data.js"
 *  @import { Figure } from "./figure.js"
 *  @import { Guard } from "./recovery.js"
 *  @import { Sketch } from "./schema.js"
 *  @import { Session } from "./session.js" */

// ── When the one context of many figures is lost: each stands still, says why, and goes on.

/** @typedef {ReturnType<typeof createBookRecovery>} BookRecovery */

/** What keeps the texts of an editor, and what puts one back into it.
 *  @typedef {{guard?: Guard, reopen?: (text: string, file: string) => void}} Edits */

/** What a live block has of it.
 *  @typedef {object} Watched
 *  @property {import("./recovery.js").Recovery} recovery
 *  @property {(figure: Figure) => void} add   a figure whose picture is to come back
 *  @property {(edits: Edits) => void} edit    the block has an editor
 *  @property {() => void} end */

/** Watch an engine whose figures are in several places of a page.
 *  @param {import("./engine.js").Engine} engine @param {string} language */
export function createBookRecovery(engine, language) {
  /** @type {Promise<void> | null} all wait for the same */
  let restoring = null;
  const restore = () => {
    restoring ??= engine.restore().finally(() => { restoring = null; });
    return restoring;
  };

  return {
    /** Watch for a block; sentences appear in its element.
     *  @param {HTMLElement} host @returns {Watched} */
    watch(host) {
      /** @type {Edits} */
      let edits = {};
      /** @type {Figure[]} */
      const figures = [];
      const poster = (/** @type {boolean} */ still) => {
        for (const figure of figures) {
          figure.showPoster(still);
          if (!still) figure.ask();
        }
      };
      const recovery = createRecovery(host, {
        words: bookWords(language), poster, guard: () => edits.guard,
        reopen: (text, file) => edits.reopen?.(text, file),
      });
      const player = () => /** @type {any} */ (figures[0]?.player ?? null);
      const end = recovery.watch(engine.canvas, { restore, player });
      return {
        recovery, end,
        add: (figure) => { figures.push(figure); },
        edit: (made) => { edits = made; },
      };
    },
  };
}

// ── A live picture in the text of a book, what can be dragged of it, its time

/** What a live block is made with.
 *  @typedef {object} Room
 *  @property {HTMLElement} host                 empty, in the place of the still pictures
 *  @property {HTMLElement} still                the pictures of the page that it replaces
 *  @property {LiveBlock} block
 *  @property {Sketch[]} sketches                of its scenes
 *  @property {Sketch | null} begin              of an exercise
 *  @property {import("./engine.js").Engine} engine
 *  @property {Watched} watched   speaks for its figures when the context is lost
 *  @property {Object<string, string>} words
 *  @property {Object<string, string>} [say]         of works that are checked: [tasks] of course/labels
 *  @property {boolean} comma                    whether numbers have one */

const STEP = 1 / 36; // of the picture's height that an arrow turns: 5 degrees
/** @type {Object<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] };

/** Make a live picture in an element; the still picture stands there until it is drawn.
 *  @param {Room} room @param {HTMLElement} host @param {Session} session
 *  @param {{poster?: HTMLImageElement | null, opened?: (player: any) => void,
 *           prepare?: (player: any) => unknown, drawn?: () => void}} [options] */
export function makePicture(room, host, session, options = {}) {
  const { engine, words, watched } = room, { poster = null, opened, prepare, drawn } = options;
  const box = make("div", { className: "picture" }), [width, height] = session.sketch.frame;
  box.style.aspectRatio = `${width} / ${height}`;
  host.append(box);
  const still = poster && /** @type {HTMLImageElement} */ (poster.cloneNode());
  still?.removeAttribute("loading");
  const how = { session, words, poster: still, inText: true, opened, prepare, drawn };
  const figure = createFigure(box, engine, { sketches: session.sketches }, how);
  watched.add(figure);
  figure.canvas.addEventListener("keydown", (event) => {
    const arrow = ARROWS[event.key], zoom = { "+": 1, "=": 1, "-": -1 }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey || !(arrow || zoom || event.key === "r")) return;
    event.preventDefault();
    if (zoom) figure.zoom(zoom);
    else if (!arrow) figure.resetView();
    else if (event.shiftKey) figure.move(-arrow[0], -arrow[1]);
    else figure.turn(...arrow);
  });
  return figure;
}

/** Make rows for some parameters of a session, those there are; why several are locked stands once.
 *  @param {Session} session @param {() => string[]} paths  asked again when the session has other rows
 *  @param {Object<string, string>} words */
export function makeRows(session, paths, words) {
  const box = make("div", { className: "rows" });
  /** @type {[string, ReturnType<typeof makeRow>][]} */
  let rows = [];
  function build() {
    const found = paths().flatMap((path) => session.row(path) ?? []), known = new Set([""]);
    rows = [];
    box.replaceChildren();
    for (const one of found) {
      const { path, locked } = one, several = found.filter((other) => other.locked === locked).length > 1;
      if (several && !known.has(locked)) box.append(whyLocked(locked));
      if (several) known.add(locked);
      const row = makeRow(one, labelOf(one.label), {
        words,
        changed: (value) => session.set(path, value),
        reset: () => session.reset(path),
        press: (down) => session.press(path, down),
      }, several);
      rows.push([path, row]);
      box.append(row.element);
    }
  }
  const show = () => rows.forEach(([path, row]) => row.show(session.value(path), session.changed(path)));
  session.follow((news) => {
    if (news === "rows") build();
    show();
  });
  build();
  show();
  return box;
}

/** A slider with buttons to both sides and what it says; `steps` of the buttons.
 *  @param {{label: string, min: number, max: number, step: number | "any", value: number,
 *           words: Object<string, string>,
 *           said: (value: number) => string, changed: (value: number) => void}} options */
export function makeSlider({ label, min, max, step, value, words, said, changed }) {
  const [least, most, each, first] = [min, max, step, value].map(String);
  const range = make("input",
    { type: "range", min: least, max: most, step: each, value: first, "aria-label": label });
  const output = make("output");
  const show = () => {
    const now = +range.value, text = said(now);
    output.textContent = text;
    range.setAttribute("aria-valuetext", text);
    range.style.setProperty("--share", String((now - min) / (max - min || 1)));
    back.setAttribute("aria-disabled", String(now <= min));
    on.setAttribute("aria-disabled", String(now >= max));
  };
  const go = (/** @type {number} */ to) => {
    range.value = String(Math.min(Math.max(to, min), max));
    show();
    changed(+range.value);
  };
  // Between two listed values, a button goes to the next of them.
  /** @param {string} text @param {string} title @param {() => void} act */
  const arrow = (text, title, act) => button(text, act, { title, "aria-label": title });
  const back = arrow("‹", words.backward, () => go(Math.ceil(+range.value) - 1));
  const on = arrow("›", words.forward, () => go(Math.floor(+range.value) + 1));
  range.oninput = () => { show(); changed(+range.value); };
  show();
  return { element: make("div", { className: "controls" }, back, range, on, output), go };
}

/** Two pictures one over the other, and the line between. @param {HTMLElement} box
 *  @param {Object<string, string>} words */
export function makeSwipe(box, words) {
  const range = make("input",
    { type: "range", min: "0", max: "100", value: "50", "aria-label": words.swipe });
  const show = () => box.style.setProperty("--at", `${range.value}%`);
  range.oninput = show;
  show();
  return make("div", { className: "controls" }, range);
}

/** What sets everything back, the camera too. @param {Session} session @param {Object<string, string>} words
 *  @param {() => void} [more] */
export const makeReset = (session, words, more = () => {}) =>
  button(words.reset, () => {
    session.resetAll();
    session.setCamera(null);
    more();
  }, { className: "reset-all" });

/** A figure with its sliders. @param {Room} room */
export function liveFigure(room) {
  const { host, block, sketches, still, words } = room, session = createSession(sketches);
  const figure = makePicture(room, host, session, { poster: still.querySelector("img") });
  if (hasTime(session.sketch)) host.append(createTimeline(figure, words).element);
  host.append(makeRows(session, () => block.rows ?? [], words), makeReset(session, words));
  return figure.start().then(() => figure);
}
