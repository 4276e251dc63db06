// trace.js -- the entry of what pages with traced texts have besides: a tab with the values of one texel.
//
// It stands before page.js in such a page, which calls what it leaves here.

import { traced } from "./trace_run.js";
import { createTraceView } from "./trace_view.js";
import { TRACE_WORDS } from "./trace_words.js";
import { fill, wordsOf } from "./words.js";

/** @import { Engine } from "./engine.js"
 *  @import { Figure } from "./figure.js"
 *  @import { Player } from "./player.js" */

const STILL = 4; // [CSS pixels] that a click may move

/** What a page has of it: a tab, a tool, what a key does. `open` shows the tab.
 *  @param {Engine} engine @param {Figure} figure @param {() => void} open */
export function createTrace(engine, figure, open) {
  const words = wordsOf(document.documentElement.lang, TRACE_WORDS);
  /** @type {{path: string, texel: [number, number]} | null} */
  let place = null;
  const textOfFile = (/** @type {string} */ file) => engine.shared.files[file] ?? "";
  const view = createTraceView({ words, chosen: show, textOfFile });
  view.say(words.tracePoint);

  /** Trace the place of now. @param {number | null} iteration null: the last */
  function show(iteration) {
    const player = /** @type {Player | null} */ (/** @type {unknown} */ (figure.player));
    if (!player || !place) return;
    try {
      view.show(traced(engine, player, place.path, place.texel, iteration));
    } catch (error) {
      const { code = "", message = String(error) } = /** @type {import("./context.js").Failure} */ (error);
      const text = { edited: words.traceEdited, lost: words.traceLost }[code] ?? words.traceNone;
      view.say(fill(text, { file: message.replace(/^\.\//, ""), reason: message }));
    }
  }

  /** @type {[number, number] | null} where the pointer was pressed */
  let pressed = null;
  let isOn = false;
  figure.canvas.addEventListener("pointerdown", (event) => {
    pressed = isOn && event.button === 0 ? [event.clientX, event.clientY] : null;
  });
  figure.canvas.addEventListener("pointerup", (event) => {
    const from = pressed;
    pressed = null;
    if (!from || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > STILL) return;
    const box = figure.canvas.getBoundingClientRect();
    const found = figure.pick([event.clientX - box.left, event.clientY - box.top]);
    if (!found) return;
    place = found;
    open();
    show(null);
  });

  return {
    label: words.trace,
    tool: words.traceTool,
    keyTrace: words.keyTrace,
    element: view.element,
    /** Clicks on the picture trace, or no longer; returns which. */
    toggle() {
      isOn = !isOn;
      figure.canvas.style.cursor = isOn ? "crosshair" : "";
      if (isOn) open();
      return isOn;
    },
  };
}

/** @type {any} */ (globalThis).playgroundTrace = createTrace;
