// book_text.js -- a text in a live block that a reader writes: compiled at once, its errors at its lines.

import { makePicture, makeReset } from "./book_figure.js";
import { createCodeField } from "./code_field.js";
import { finished } from "./context.js";
import { button, make } from "./dom.js";
import { createGuard, keyOf } from "./recovery.js";
import { createSession } from "./session.js";
import { fill } from "./words.js";
import { createCheck } from "./work_check.js";

/** @import { LiveBlock } from "./book_data.js"
 *  @import { Room } from "./book_figure.js" */

/** @typedef {{file: string, line: number, message: string}} Mistake */

const PAUSE = 200; // [ms] without a key, then what was typed is compiled

/** What is written.
 *  @typedef {object} Written
 *  @property {string} file                         that the whole text stands for
 *  @property {string} first                        what the field holds at first
 *  @property {string} label                        of the field
 *  @property {string} key                          of what is kept over a reload
 *  @property {(shown: string) => string} whole     the file with what is shown
 *  @property {(text: string) => string} part       what is shown of the file
 *  @property {number} [above]                      lines of the file before those that are shown
 *  @property {(text: string, shown: string) => Promise<unknown> | unknown} made  its picture is there
 *  @property {() => void} failed                   it does not compile
 *  @property {(text: string) => any} [read]        what else is read of it; throws where that cannot be
 *  @property {(read: any) => void} [works]         it compiles, and this was read of it */

/** Make the field in a block; its player is opened by `opened`, its first text tried by `begin`.
 *  @param {Room} room @param {Written} written */
export function createText({ host, sketches, engine, watched, words }, written) {
  const { file, first, whole, part, above = 0 } = written;
  /** @type {any} */
  let player = null;
  let timer = 0, number = 0, wrong = false;
  /** @type {Promise<unknown>} */
  let work = Promise.resolve();
  const guard = createGuard(keyOf(`${sketches[0].name} ${written.key}`, { [file]: whole(first) }));
  watched.edit({ guard, reopen: (text) => field.replace(part(text)) });
  const editor = make("div", { className: "editor" });
  host.append(editor);
  const field = createCodeField(editor, { hint: words.lineKeys, onInput: typed });
  const status = make("p", { className: "editor-status", role: "status" });
  const problems = make("ol", { className: "editor-problems" });
  editor.append(status, problems);
  editor.style.setProperty("--lines", String(Math.min(first.split("\n").length, 30)));
  const kept = guard.good[file];
  field.open(kept === undefined ? first : part(kept), written.label, first);

  function typed() {
    clearTimeout(timer);
    timer = window.setTimeout(() => { work = work.then(tried); }, PAUSE);
    editor.setAttribute("aria-busy", "true");
  }

  /** Try what is written, and say when nothing of it is left to be tried. */
  async function tried() {
    const begun = timer;
    await tryNow();
    if (begun === timer) editor.setAttribute("aria-busy", "false");
  }

  async function tryNow() {
    const mine = ++number, shown = field.text, text = whole(shown);
    status.textContent = words.compilingText;
    let errors;
    guard.trying(file, text, player.texts);
    const listening = new AbortController();
    try {
      errors = await Promise.race([drawn(text), lost(listening.signal)]);
      if (!engine.isLost()) guard.worked(player.texts);
    } catch (error) {
      const { file: where = file, line = 0 } = /** @type {any} */ (error);
      errors = [{ file: where, line, message: error instanceof Error ? error.message : String(error) }];
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
    if (!errors.length) await written.made(text, shown);
  }

  /** Compile a text and make its whole picture, wherever the page is scrolled; return what is wrong with it.
   *  @param {string} text @returns {Promise<Mistake[]>} */
  async function drawn(text) {
    const read = written.read?.(text), { errors } = await player.edit(file, text);
    if (errors.length) return errors;
    written.works?.(read);
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

  /** @param {Mistake[]} errors */
  function tell(errors) {
    const known = [...new Map(errors.map((one) => [`${one.line} ${one.message}`, one])).values()];
    const here = known.filter((one) => one.file === file && one.line > above);
    wrong = known.length > 0;
    status.textContent = wrong ? words.wrong : "";
    status.classList.toggle("wrong", wrong);
    field.mark(new Map(here.map((one) => [one.line - above, one.message])));
    problems.replaceChildren(...known.map((one) => {
      const line = one.line - above, inside = here.includes(one);
      const text = inside ? fill(words.linePlace, { line, message: one.message }) : one.message;
      return make("li", {}, button(text, () => inside && field.go(line, 0)));
    }));
    if (wrong) written.failed();
  }

  return {
    /** The whole file as it is written now. */
    get text() { return whole(field.text); },
    /** Whether what was tried last does not compile. */
    get isWrong() { return wrong; },
    /** Take the player of the block's picture, which begins with the text. @param {any} made */
    opened(made) {
      player = made;
      player.texts = { ...player.texts, [file]: whole(first) };
    },
    begin: () => tried(),
    /** After all that was typed so far is tried. */
    async done() {
      clearTimeout(timer);
      work = work.then(tried);
      await work;
    },
    /** Put another text into the field. @param {string} shown */
    put: (shown) => field.replace(shown),
    /** Whether the number of the last try is still this one: for what takes time. */
    get number() { return number; },
  };
}

// ── A bug in a shader that a reader of a book finds and fixes: its lines, and what says it is.

/** A file with other lines in place of those that are shown. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block @param {string} shown */
export function withLines(text, { first = 0, rest = 0, indent = 0 }, shown) {
  const lines = text.split("\n"), blanks = " ".repeat(indent);
  const news = shown.replace(/^\n+|\n+$/g, "").split("\n").map((line) => (line.trim() ? blanks + line : ""));
  return [...lines.slice(0, first), ...news, ...lines.slice(lines.length - rest)].join("\n");
}

/** The lines that are shown of a file. @param {string} text of the file
 *  @param {Pick<LiveBlock, "first" | "rest" | "indent">} block */
function linesIn(text, { first = 0, rest = 0, indent = 0 }) {
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
