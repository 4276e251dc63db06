// book_tasks.js -- what a reader does in a book, checked: repairs a broken shader, solves an exercise.

import { makePicture, makeReset, makeRows } from "./book_figure.js";
import { createCheck } from "./picture_check.js";
import { createCodeField } from "./code_field.js";
import { button, make } from "./dom.js";
import { createSession } from "./session.js";
import { fill } from "./words.js";

/** @typedef {import("./book_figure.js").Room} Room */
/** @typedef {import("./book_data.js").LiveBlock} LiveBlock */

const PAUSE = 200; // [ms] without a key, then what was typed is compiled
const SETTLED = 350; // [ms] without a change, then what was set is compared

/** A file with other lines in place of those that are shown. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block @param {string} shown */
export function withLines(text, { first = 0, rest = 0, indent = 0 }, shown) {
  const lines = text.split("\n"), blanks = " ".repeat(indent);
  const news = shown.replace(/^\n+|\n+$/g, "").split("\n").map((line) => (line.trim() ? blanks + line : ""));
  return [...lines.slice(0, first), ...news, ...lines.slice(lines.length - rest)].join("\n");
}

/** What says how it stands: a sentence that is good news, bad news, or none.
 *  @param {HTMLElement} host */
function makeVerdict(host) {
  const verdict = make("p", { className: "verdict", role: "status" });
  host.append(verdict);
  return (/** @type {string} */ text, /** @type {"right" | "wrong" | ""} */ kind = "") => {
    if (verdict.textContent !== text) verdict.textContent = text;
    verdict.className = `verdict ${kind}`.trim();
  };
}

/** A bug, with its lines in an editor. @param {Room} room */
export async function liveBreak(room) {
  const { host, still, block, sketches, engine, words } = room, session = createSession(sketches);
  const file = block.file ?? "", correct = engine.shared.files[file], broken = block.broken ?? "";
  /** @type {any} */
  let player = null;
  let timer = 0, number = 0;
  /** @type {Promise<unknown>} */
  let work = Promise.resolve();
  const opened = (/** @type {any} */ made) => { player = made; };
  const figure = makePicture(room, host, session, { poster: still.querySelector("img"), opened });
  const editor = make("div", { className: "editor" });
  host.append(editor);
  const field = createCodeField(editor, { label: words.lines, hint: words.keys, onInput: typed });
  const status = make("p", { className: "editor-status", role: "status" });
  const problems = make("ol", { className: "editor-problems" });
  const verdict = makeVerdict(host);
  editor.append(status, problems);
  const restore = button(words.restore, () => field.replace(broken));
  host.append(make("div", { className: "buttons" }, restore, makeReset(session, words)));
  field.open(broken, words.lines, broken);
  editor.style.setProperty("--lines", String(broken.split("\n").length));
  const check = await createCheck(engine, sketches[0], session.state());
  await figure.start();
  await tried();

  function typed() {
    clearTimeout(timer);
    timer = window.setTimeout(() => { work = work.then(tried); }, PAUSE);
  }

  async function tried() {
    const mine = ++number, shown = field.text, text = withLines(correct, block, shown);
    status.textContent = words.compiling;
    let errors;
    try {
      ({ errors } = await player.edit(file, text));
    } catch (error) {
      errors = [{ file, line: 0, message: error instanceof Error ? error.message : String(error) }];
    }
    if (mine !== number || field.text !== shown) return; // typed over meanwhile: that is tried instead
    tell(errors);
    if (errors.length) return;
    figure.ask();
    const good = await check.holdsWith(file, text);
    if (mine !== number) return;
    if (good) verdict(words.fixed, "right");
    else verdict(shown === broken ? "" : words.notYet, "wrong");
  }

  /** @param {{file: string, line: number, message: string}[]} errors */
  function tell(errors) {
    const above = block.first ?? 0;
    const known = [...new Map(errors.map((one) => [`${one.line} ${one.message}`, one])).values()];
    const here = known.filter((one) => one.file === file && one.line > above);
    status.textContent = known.length ? words.wrong : "";
    status.classList.toggle("wrong", known.length > 0);
    field.mark(new Map(here.map((one) => [one.line - above, one.message])));
    problems.replaceChildren(...known.map((one) => {
      const line = one.line - above, inside = here.includes(one);
      const text = inside ? fill(words.place, { line, message: one.message }) : one.message;
      return make("li", {}, button(text, () => inside && field.go(line, 0)));
    }));
    if (known.length) verdict("");
  }
}

/** An exercise: from its beginning to the solution's picture; without a beginning, that picture.
 *  @param {Room} room */
export async function liveExercise(room) {
  const { host, still, block, sketches, begin, engine, words } = room;
  const session = createSession([begin ?? sketches[0]]);
  const figure = makePicture(room, host, session, { poster: still.querySelector("img") });
  host.append(makeRows(session, block.rows ?? [], words));
  if (begin) {
    const verdict = makeVerdict(host);
    const check = await createCheck(engine, sketches[0], createSession(sketches).state());
    let timer = 0;
    session.follow((news) => {
      if (news !== "values") return;
      clearTimeout(timer);
      timer = window.setTimeout(async () => {
        const good = await check.holds(session.state());
        if (good) verdict(words.reached, "right");
        else verdict(session.anyChanged() ? words.notReached : "", "wrong");
      }, SETTLED);
    });
  }
  host.append(makeReset(session, words));
  return figure.start();
}
