// keys.js -- what each key does in a page: one table, which the list of keys shows as well.

import { button, isTyping, make } from "./dom.js";

/** @typedef {Object<string, string>} Words */
/** What the keys do.
 *  @typedef {object} Acts
 *  @property {(across: number, down: number) => void} turn  shares of the picture's height
 *  @property {(across: number, down: number) => void} move
 *  @property {(notches: number) => void} zoom
 *  @property {Object<string, () => void>} by                by the names of the table */

const STEP = 1 / 36; // of the picture's height an arrow turns: 5 degrees
/** @type {Object<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] };

/** Key → what it does, and the name of its meaning in the words. @type {[string, string, string][]} */
const KEYS = [
  ["r", "resetView", "keyResetView"],
  [" ", "play", "keyPlay"],
  [",", "back", "keyFrame"],
  [".", "on", "keyFrame"],
  ["0", "start", "keyStart"],
  ["m", "map", "keyMap"],
  ["s", "save", "keySave"],
  ["p", "panel", "keyPanel"],
  ["/", "search", "keySearch"],
  ["f", "full", "keyFull"],
  ["?", "help", "keyHelp"],
];

/** Act on keys, unless they are typed into a field. @param {Document} document @param {Acts} acts
 *  @param {HTMLElement} canvas */
export function followKeys(document, acts, canvas) {
  document.addEventListener("keydown", (event) => {
    const { target, key } = event,
      ctrl = event.ctrlKey || event.metaKey;
    if (event.defaultPrevented || event.altKey || document.querySelector("dialog[open]")) return;
    if (isTyping(target)) {
      if (key === "Escape" && target instanceof HTMLElement) target.blur();
      return;
    }
    const act = () => {
      if (ctrl)
        return { z: event.shiftKey ? acts.by.redo : acts.by.undo, y: acts.by.redo }[key.toLowerCase()];
      const free = target === canvas || target === document.body,
        arrow = ARROWS[key];
      if (arrow)
        return free
          ? () => (event.shiftKey ? acts.move(-arrow[0], -arrow[1]) : acts.turn(...arrow))
          : undefined;
      if (key === "+" || key === "=") return () => acts.zoom(1);
      if (key === "-") return () => acts.zoom(-1);
      if (key === " " && !free) return undefined;
      const found = KEYS.find(([name]) => name === key.toLowerCase());
      return found && acts.by[found[1]];
    };
    const done = act();
    if (!done) return;
    event.preventDefault();
    done();
  });
}

/** Make the list of keys, a dialog. @param {Words} words */
export function keysDialog(words) {
  const line = (/** @type {string} */ keys, /** @type {string} */ meaning) => [
    make("dt", {}, ...keys.split(" | ").map((key) => make("kbd", {}, key))),
    make("dd", {}, meaning),
  ];
  const named = new Map(
    KEYS.map(([, , meaning]) => [
      meaning,
      KEYS.filter((key) => key[2] === meaning)
        .map(([key]) => (key === " " ? words.space : key.toUpperCase()))
        .join(" | "),
    ]),
  );
  const dialog = make("dialog", { className: "keys", "aria-label": words.keys });
  dialog.append(
    make("h2", {}, words.keys),
    make(
      "dl",
      {},
      ...line(words.arrows, words.keyOrbit),
      ...line(words.shiftArrows, words.keyPan),
      ...line("+ | −", words.keyZoom),
      ...[...named].flatMap(([meaning, keys]) => line(keys, words[meaning])),
      ...line("Ctrl+Z | Ctrl+Shift+Z", words.keyUndo),
      ...line("Esc", words.keyClose),
    ),
    make("p", {}, words.mouse),
    make("p", {}, words.touch),
    make("p", {}, words.rows),
    button(words.close, () => dialog.close()),
  );
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
  return dialog;
}
