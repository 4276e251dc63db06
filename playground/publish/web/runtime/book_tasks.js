// book_tasks.js -- a bug in a shader that a reader of a book finds and fixes: its lines, and what says it is.

import { makePicture, makeReset } from "./book_figure.js";
import { createText } from "./book_text.js";
import { createCheck } from "./picture_check.js";
import { button, make } from "./dom.js";
import { createSession } from "./session.js";

/** @typedef {import("./book_figure.js").Room} Room */
/** @typedef {import("./book_data.js").LiveBlock} LiveBlock */

/** A file with other lines in place of those that are shown. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block @param {string} shown */
export function withLines(text, { first = 0, rest = 0, indent = 0 }, shown) {
  const lines = text.split("\n"), blanks = " ".repeat(indent);
  const news = shown.replace(/^\n+|\n+$/g, "").split("\n").map((line) => (line.trim() ? blanks + line : ""));
  return [...lines.slice(0, first), ...news, ...lines.slice(lines.length - rest)].join("\n");
}

/** The lines that are shown of a file. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block */
export function linesIn(text, { first = 0, rest = 0, indent = 0 }) {
  const lines = text.split("\n"), blanks = " ".repeat(indent);
  return lines.slice(first, lines.length - rest)
    .map((line) => (line.startsWith(blanks) ? line.slice(indent) : line)).join("\n");
}

/** What says how it stands: a sentence that is good news, bad news, or none.
 *  @param {HTMLElement} host */
export function makeVerdict(host) {
  const verdict = make("p", { className: "verdict", role: "status" });
  host.append(verdict);
  return (/** @type {string} */ text, /** @type {"right" | "wrong" | ""} */ kind = "") => {
    if (verdict.textContent !== text) verdict.textContent = text;
    verdict.className = `verdict ${kind}`.trim();
  };
}

/** A bug, with its lines in an editor. @param {Room} room */
export async function liveBreak(room) {
  const { host, still, block, sketches, engine, watched, words } = room, session = createSession(sketches);
  const file = block.file ?? "", correct = engine.shared.files[file], broken = block.broken ?? "";
  const figure = makePicture(room, host, session, {
    poster: still.querySelector("img"),
    opened: (/** @type {any} */ made) => text.opened(made),
    prepare: (/** @type {any} */ made) => watched.recovery.resume(made),
  });
  const text = createText(room, {
    file, first: broken, label: words.lines, key: `${file} ${block.first}`, above: block.first,
    whole: (shown) => withLines(correct, block, shown),
    part: (all) => linesIn(all, block),
    failed: () => verdict(""),
    async made(all, shown) {
      const mine = text.number;
      figure.ask();
      const good = await check.holdsWith(file, all);
      if (mine !== text.number) return;
      if (good) verdict(words.fixed, "right");
      else verdict(shown === broken ? "" : words.notYet, "wrong");
    },
  });
  const verdict = makeVerdict(host);
  const restore = button(words.restore, () => text.put(broken));
  host.append(make("div", { className: "buttons" }, restore, makeReset(session, words)));
  const check = await createCheck(engine, sketches[0], session.state());
  await figure.start();
  await text.begin();
}
