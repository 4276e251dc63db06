// recovery.js -- what a page does where a picture fails: a sentence, the poster, and the way on.

import { button, make } from "./dom.js";
import { lackOf } from "./lacks.js";
import { estimate, smallerFrame } from "./pace.js";
import { fill } from "./words.js";

/** @typedef {import("./last_good.js").Guard} Guard */

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
    /** @type {import("./last_good.js").Tried | null} */
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
