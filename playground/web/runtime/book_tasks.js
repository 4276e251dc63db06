// book_tasks.js -- what a reader does in a book, checked: repairs a broken shader, solves an exercise.

import { makePicture, makeReset, makeRows } from "./book_figure.js";
import { createCheck } from "./picture_check.js";
import { createCodeField } from "./code_field.js";
import { button, make } from "./dom.js";
import { createGuard, keyOf } from "./last_good.js";
import { createSession } from "./session.js";
import { finished } from "./waiting.js";
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

/** The lines that are shown of a file. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block */
export function linesIn(text, { first = 0, rest = 0, indent = 0 }) {
  const lines = text.split("\n"), blanks = " ".repeat(indent);
  return lines.slice(first, lines.length - rest)
    .map((line) => (line.startsWith(blanks) ? line.slice(indent) : line)).join("\n");
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
  const { host, still, block, sketches, engine, watched, words } = room, session = createSession(sketches);
  const file = block.file ?? "", correct = engine.shared.files[file], broken = block.broken ?? "";
  /** @type {any} */
  let player = null;
  let timer = 0, number = 0;
  /** @type {Promise<unknown>} */
  let work = Promise.resolve();
  const guard = createGuard(keyOf(`${sketches[0].name} ${file} ${block.first}`, { [file]: correct, broken }));
  const reopen = (/** @type {string} */ text) => field.replace(linesIn(text, block));
  watched.edit({ guard, reopen });
  const figure = makePicture(room, host, session, {
    poster: still.querySelector("img"),
    opened: (/** @type {any} */ made) => { player = made; },
    prepare: (/** @type {any} */ made) => watched.recovery.resume(made),
  });
  const editor = make("div", { className: "editor" });
  host.append(editor);
  const field = createCodeField(editor, { label: words.lines, hint: words.lineKeys, onInput: typed });
  const status = make("p", { className: "editor-status", role: "status" });
  const problems = make("ol", { className: "editor-problems" });
  const verdict = makeVerdict(host);
  editor.append(status, problems);
  const restore = button(words.restore, () => field.replace(broken));
  host.append(make("div", { className: "buttons" }, restore, makeReset(session, words)));
  const kept = guard.good[file];
  field.open(kept === undefined ? broken : linesIn(kept, block), words.lines, broken);
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
    status.textContent = words.compilingText;
    let errors;
    guard.trying(file, text, player.texts);
    const listening = new AbortController();
    try {
      errors = await Promise.race([drawn(text), lost(listening.signal)]);
      if (!engine.isLost()) guard.worked(player.texts);
    } catch (error) {
      errors = [{ file, line: 0, message: error instanceof Error ? error.message : String(error) }];
      if (!engine.isLost()) guard.forget();
    } finally {
      listening.abort();
    }
    if (engine.isLost()) { // by this text, maybe: it is told when the context is back
      status.textContent = "";
      return;
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

  /** Compile a text and make its whole picture, wherever the page is scrolled; return what is wrong with it.
   *  @param {string} text @returns {Promise<{file: string, line: number, message: string}[]>} */
  async function drawn(text) {
    const { errors } = await player.edit(file, text);
    if (errors.length) return errors;
    await player.renderSoon();
    await finished(engine.parts.context.gl);
    return [];
  }

  /** After the context is lost: what was being compiled or drawn then never ends.
   *  @param {AbortSignal} signal @returns {Promise<never[]>} */
  function lost(signal) {
    return new Promise((resolve) => {
      engine.canvas.addEventListener("webglcontextlost", () => resolve([]), { once: true, signal });
    });
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
      const text = inside ? fill(words.linePlace, { line, message: one.message }) : one.message;
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
