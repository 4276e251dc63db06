// recovery.js -- what a page does where a picture fails: a sentence, the poster, and the way on.

import { button, make } from "./dom.js";
import { fill } from "./words.js";

// ── Why a picture stands still, as a sentence.

/** What an error means to who looks at a picture.
 *  @param {unknown} error  one of the engine's, with its code, or any other
 *  @param {Object<string, string>} words  of the editor
 *  @param {string} [otherwise]  with a place for the reason, where the code has no words of its own */
export function lackOf(error, words, otherwise = words.lacks) {
  const { code = "", sentence = "", message = "" } = /** @type {Object<string, string>} */ (error ?? {});
  if (code === "no-webgl2") return words.noWebGL;
  if (code === "no-float-targets") return words.noFloat;
  return fill(otherwise, { reason: sentence || message || String(error) });
}

// ── Which edited texts worked, and which is being tried: kept over a reload of the tab.
//
// A loop without end may take the tab with it. So what is tried is written down before it is compiled, and
// once its picture is there it counts as good: what is found as tried after a reload did not get that far.

/** @typedef {Object<string, string>} Texts */
/** @typedef {{file: string, text: string}} Tried */
/** @typedef {ReturnType<typeof createGuard>} Guard */

/** Where texts are kept: in the tab's storage, in its name where that is refused, or nowhere.
 *  @typedef {"storage" | "name" | ""} Place */

const MAX_LETTERS = 2_000_000; // characters

/** Make what keeps the texts of a page.
 *  @param {string} key                          of the sketch: see keyOf
 *  @param {{storage?: Storage | null, tab?: {name: string} | null}} [places]  other than the tab's own */
export function createGuard(key, places = {}) {
  const storage = places.storage === undefined ? ownStorage() : places.storage;
  const tab = places.tab === undefined ? globalThis.window ?? null : places.tab;
  const name = `playground ${key}`;
  let place = /** @type {Place} */ (storage ? "storage" : tab ? "name" : "");
  /** @type {Tried | null} */
  let left = null;
  /** @type {Texts} */
  let good = {};

  /** @param {unknown} value */
  function write(value) {
    const text = value ? JSON.stringify(value) : "";
    if (text.length > MAX_LETTERS) return;
    if (place === "storage" && storage) {
      try {
        if (text) storage.setItem(name, text);
        else storage.removeItem(name);
        return;
      } catch {
        place = tab ? "name" : "";
      }
    }
    if (place === "name" && tab && (text || tab.name.startsWith(name))) tab.name = text && `${name} ${text}`;
  }

  function read() {
    try {
      const text = place === "storage" ? storage?.getItem(name)
        : tab?.name.startsWith(`${name} `) ? tab.name.slice(name.length + 1) : "";
      const found = JSON.parse(text || "{}");
      good = plainTexts(found.good);
      const { file, text: tried } = found.tried ?? {};
      if (typeof file === "string" && typeof tried === "string") left = { file, text: tried };
    } catch {
      good = {}; // what is there is not ours
    }
  }

  read();
  return {
    /** Where texts are kept. */
    get place() { return place; },
    /** The texts that worked before this page was loaded; those of files that it edits. */
    get good() { return good; },
    /** The text that was being tried when the page was closed; null: none. */
    get left() { return left; },
    /** A text is about to be compiled and drawn.
     *  @param {string} file @param {string} text @param {Texts} texts  that work so far */
    trying(file, text, texts) {
      good = { ...texts };
      left = { file, text };
      write({ good, tried: left });
    },
    /** The picture of these texts is there. @param {Texts} texts */
    worked(texts) {
      good = { ...texts };
      left = null;
      write(Object.keys(good).length ? { good } : null);
    },
    /** What was tried is given up; what worked stays. */
    forget() {
      left = null;
      write(Object.keys(good).length ? { good } : null);
    },
  };
}

/** A key for a sketch's texts: those of another version of the page are not taken for this one's.
 *  @param {string} name of the sketch @param {Texts} files
 *  @returns {string} */
export function keyOf(name, files) {
  let hash = 0x811c9dc5; // FNV-1a, 32 bits
  for (const file of Object.keys(files).sort()) {
    for (const character of `${file}\0${files[file]}\0`) {
      hash = Math.imul(hash ^ /** @type {number} */ (character.codePointAt(0)), 0x01000193);
    }
  }
  return `${name} ${(hash >>> 0).toString(16).padStart(8, "0")}`;
}

/** @param {unknown} value @returns {Texts} */
function plainTexts(value) {
  const pairs = value && typeof value === "object" ? Object.entries(value) : [];
  return Object.fromEntries(pairs.filter(([, text]) => typeof text === "string"));
}

/** The tab's storage; null where the browser refuses it, as it may for a file.
 *  @returns {Storage | null} */
function ownStorage() {
  try {
    const { sessionStorage } = globalThis;
    sessionStorage.setItem("playground", "");
    sessionStorage.removeItem("playground");
    return sessionStorage;
  } catch {
    return null;
  }
}

// ── How long a picture will take, told by smaller ones, before a browser stops it.

/** @typedef {{size: [number, number]}} Sized */
/** What is asked of a player: its state, over what its sketch says, and its pictures, made in pieces that
 *  no browser stops.
 *  @typedef {{state: {frame?: [number, number]}, renderSoon: () => Promise<unknown>,
 *             sketch: {frame: [number, number]}}} Paced */

// Of a side. The first does what is done once: the terrain, and what the driver puts off compiling.
const SHARES = [1 / 16, 1 / 8, 1 / 4];
const LIMIT = 4; // [s] a picture; drivers of Windows end a draw after 2, browsers a frame after 10

/** Estimate the time of a picture from three that are smaller; the state is as before then. What a picture
 *  needs whatever its size is kept from the first of them, and no part of the time.
 *
 *  What does not grow with the picture is found from the other two: t(share) = a + b share².
 *  @param {Paced} player
 *  @param {() => Promise<void>} done   waits for what was drawn
 *  @param {{limit?: number, now?: () => number}} [options]   limit in seconds: no larger one is drawn then
 *  @returns {Promise<number>} seconds */
export async function estimate(player, done, { limit = LIMIT, now = () => performance.now() } = {}) {
  const { state, sketch } = player, { frame } = state, whole = frame ?? sketch.frame;
  /** @type {number[]} */
  const took = [];
  try {
    for (const share of SHARES) {
      const start = now();
      state.frame = scaled(whole, share);
      await player.renderSoon();
      await done();
      took.push((now() - start) / 1000);
      if (share !== SHARES[0] && took[took.length - 1] > limit) return took[took.length - 1] / share ** 2;
    }
  } finally {
    Object.assign(state, { frame });
  }
  const [, less, more] = took, [, a, b] = SHARES;
  const slope = Math.max((more - less) / (b ** 2 - a ** 2), 0);
  return Math.max(more + slope * (1 - b ** 2), 0);
}

/** A frame that will take half of the limit; null where the whole one is quick enough.
 *  @param {number} seconds  of the frame @param {[number, number]} frame @param {number} [limit]
 *  @returns {[number, number] | null} */
export function smallerFrame(seconds, frame, limit = LIMIT) {
  if (seconds <= limit) return null;
  const share = Math.sqrt(limit / 2 / seconds);
  return scaled(frame, share);
}

/** @param {[number, number]} frame @param {number} share @returns {[number, number]} */
const scaled = ([width, height], share) =>
  [Math.max(Math.round(width * share), 1), Math.max(Math.round(height * share), 1)];

// ── What a page does where a picture fails

/** What is asked of a player.
 *  @typedef {object} Recoverable
 *  @property {{frame?: [number, number], terrain?: any}} state
 *  @property {{frame: [number, number], terrain: any}} sketch
 *  @property {() => unknown} render
 *  @property {() => Promise<unknown>} renderSoon
 *  @property {Object<string, string>} texts
 *  @property {(file: string, text: string) => Promise<{errors: unknown[], programs: number}>} edit */

/** @typedef {object} RecoveryOptions
 *  @property {Object<string, string>} words       of the editor
 *  @property {(still: boolean) => void} poster    shows the poster in place of the picture, or no more
 *  @property {() => Guard | undefined} [guard]    of the player that is shown
 *  @property {(text: string, file: string) => void} [reopen]  puts a text into the editor
 *  @property {number} [limit]                     [s] what a picture may take without a question */

/** @typedef {ReturnType<typeof createRecovery>} Recovery */

const MAX_LOSSES = 3;
const PATIENCE = 6_000; // [ms] a browser that blocks a page after a crash never gives its context back
const SOON = 60_000; // [ms] losses that follow so closely are counted together

/** Make what speaks for a picture that fails; sentences appear in the host.
 *  @param {HTMLElement} host @param {RecoveryOptions} options */
export function createRecovery(host, { words, poster, guard = () => undefined, reopen, limit }) {
  let losses = 0, lastLoss = -Infinity;
  /** @type {HTMLElement | null} */
  let box = null;

  function clear() {
    box?.remove();
    box = null;
  }

  /** @param {string} sentence @param {HTMLButtonElement[]} [choices] */
  function say(sentence, choices = []) {
    clear();
    box = make("div", { className: "recovery", role: "alert" }, make("p", {}, sentence), ...choices);
    host.append(box);
  }

  /** Say why there is no picture, and show the poster.
   *  @param {unknown} error  one of the engine's, with its code, or any other */
  function lacks(error) {
    say(lackOf(error, words));
    poster(true);
  }

  /** Watch a canvas's context: when it is back, the picture is made again from its plan and values.
   *  @param {HTMLCanvasElement | OffscreenCanvas} canvas
   *  @param {{restore: () => Promise<void> | void, player: () => Recoverable | null}} how
   *  @returns {() => void} ends it */
  function watch(canvas, { restore, player }) {
    /** @type {Tried | null} */
    let blamed = null;
    let late = 0;
    const lost = (/** @type {Event} */ event) => {
      const now = performance.now();
      losses = now - lastLoss < SOON ? losses + 1 : 1;
      lastLoss = now;
      blamed = guard()?.left ?? blamed;
      poster(true);
      if (losses > MAX_LOSSES) return say(fill(words.gone, { count: losses }));
      event.preventDefault(); // or it never comes back
      say(words.lost);
      clearTimeout(late);
      late = window.setTimeout(() => say(words.notBack), PATIENCE);
    };
    const restored = async () => {
      clearTimeout(late);
      const now = player();
      try {
        if (blamed && now) takeBack(now, blamed.file, guard()?.good ?? {});
        await restore();
        poster(false);
        if (blamed) say(fill(words.lostByEdit, { name: plain(blamed.file) }));
        else clear();
        blamed = null;
        guard()?.forget();
      } catch (error) {
        lacks(error);
      }
    };
    canvas.addEventListener("webglcontextlost", lost);
    canvas.addEventListener("webglcontextrestored", restored);
    return () => {
      clearTimeout(late);
      canvas.removeEventListener("webglcontextlost", lost);
      canvas.removeEventListener("webglcontextrestored", restored);
    };
  }

  /** Ask, where a picture of this size would take too long, whether a smaller one will do.
   *  @param {Recoverable} player @param {() => Promise<void>} done  waits for what was drawn
   *  @param {() => void} [asking]  is called where it is asked
   *  @returns {Promise<[number, number] | null>} the size to draw at; null: as it is */
  async function pace(player, done, asking = () => {}) {
    const frame = player.state.frame ?? player.sketch.frame;
    const seconds = await estimate(player, done, { limit });
    const smaller = smallerFrame(seconds, frame, limit);
    if (!smaller) return null;
    asking();
    const size = frame.join(" \u00d7 "), time = seconds < 10 ? seconds.toFixed(1) : Math.round(seconds);
    return new Promise((resolve) => {
      const choose = (/** @type {[number, number] | null} */ wanted) => { clear(); resolve(wanted); };
      const less = fill(words.smaller, { size: smaller.join(" \u00d7 ") });
      say(fill(words.slow, { size, time }), [
        button(less, () => choose(smaller)), button(words.anyway, () => choose(null)),
      ]);
    });
  }

  /** Go on with the texts that worked before a reload; of one that was being tried say so.
   *  @param {Recoverable} player before its first picture */
  async function resume(player) {
    const kept = guard(), { left, good } = kept ?? { left: null, good: {} };
    for (const [file, text] of Object.entries(good)) await player.edit(file, text);
    if (!left || !kept) return;
    const { file, text } = left;
    kept.forget();
    say(fill(words.hung, { name: plain(file) }), [
      ...(reopen ? [button(words.tryAgain, () => { clear(); reopen(text, file); })] : []),
      button(words.forget, clear),
    ]);
  }

  return { lacks, watch, pace, resume, say, clear };
}

/** Put the text back that worked, without a context to compile it in.
 *  @param {Recoverable} player @param {string} file @param {Object<string, string>} good */
function takeBack(player, file, good) {
  if (file in good) player.texts[file] = good[file];
  else delete player.texts[file];
}

/** @param {string} file */
const plain = (file) => file.replace(/^\.\//, "");
