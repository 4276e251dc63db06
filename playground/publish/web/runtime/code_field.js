// code_field.js -- a text field for code: coloured, with numbered lines and marks, as fast with 3,000 lines.
//
// The text is a textarea's, with its letters transparent; beneath it lie the visible lines in colours, and
// no others: what a key costs does not grow with the text but for one comparison of it with itself.

import { make } from "./dom.js";
import { highlightLine } from "./highlight.js";
import { closing, commented, indented, newLine, outdented } from "./typing.js";

/** @typedef {import("./highlight.js").LineState} LineState */
/** Marked lines by their number, from 1: what is said of each.
 *  @typedef {Map<number, string>} Marks */
/** @typedef {ReturnType<typeof createCodeField>} CodeField */

const MORE = 16; // lines drawn above and below the visible ones

/** Make a field in a host.
 *  @param {HTMLElement} host
 *  @param {{label: string, hint: string, onInput: () => void}} options */
export function createCodeField(host, { label, hint, onInput }) {
  const area = make("textarea", {
    className: "code-text", spellcheck: false, autocapitalize: "off", autocomplete: "off", wrap: "off",
    "aria-label": label, rows: 8, "data-gramm": "false",
  });
  const told = make("p", { className: "unseen", id: `code-hint-${++fields}` }, hint);
  area.setAttribute("aria-describedby", told.id);
  area.setAttribute("autocorrect", "off");
  const layer = make("div", { className: "code-layer", "aria-hidden": "true" });
  const gutter = make("div", { className: "code-gutter", "aria-hidden": "true" });
  const pane = make("div", { className: "code-pane" }, layer, area);
  const box = make("div", { className: "code-field" }, gutter, pane, told);
  host.append(box);

  let lines = [""], escaped = false, height = 20, asked = 0, digits = 0;
  /** What is drawn: from which line on, and what each of its lines was drawn of.
   *  @type {string[]} */
  let drawn = [];
  let from = 0;
  /** What each line begins in; one more than there are lines.
   *  @type {LineState[]} */
  let states = ["", ""];
  /** @type {Marks} */
  let marks = new Map();
  /** @type {Set<string>} lines of the text that it is compared with */
  let original = new Set();

  /** Take up the text: states are found anew from the first line that differs. */
  function read() {
    const now = area.value.split("\n");
    let first = 0, same = 0;
    const most = Math.min(now.length, lines.length);
    while (first < most && now[first] === lines[first]) first++;
    while (same < most - first && now[now.length - 1 - same] === lines[lines.length - 1 - same]) same++;
    const behind = states.slice(lines.length - same);
    lines = now;
    states.length = first + 1;
    for (let at = first; at < lines.length; at++) {
      const known = at >= lines.length - same ? behind[at - (lines.length - same)] : undefined;
      if (known === states[at]) {
        states.push(...behind.slice(at - (lines.length - same) + 1));
        break;
      }
      states.push(highlightLine(lines[at], states[at]).next);
    }
  }

  /** Draw the visible lines: those that are drawn and have not changed stay as they are. */
  function draw() {
    asked = 0;
    const { scrollTop, scrollLeft, clientHeight } = area; // read before anything is written
    const first = Math.floor(scrollTop / height), last = Math.ceil((scrollTop + clientHeight) / height);
    if (first < from || Math.min(last, lines.length) > from + drawn.length) {
      from = Math.max(first - MORE, 0);
      drawn = [];
    }
    const to = Math.min(Math.max(last + MORE, from + drawn.length), lines.length);
    for (let at = from; at < to; at++) {
      const mark = marks.get(at + 1), edited = !original.has(lines[at]);
      const key = `${states[at]} ${edited} ${mark ?? ""} ${at} ${lines[at]}`;
      if (drawn[at - from] !== key) put(at - from, row(at), number(at, mark, edited));
      drawn[at - from] = key;
    }
    drawn.length = Math.max(to - from, 0);
    for (const side of [layer, gutter]) while (side.children.length > drawn.length) side.lastChild?.remove();
    const down = from * height - scrollTop;
    layer.style.transform = `translate(${-scrollLeft}px, ${down}px)`;
    gutter.style.transform = `translateY(${down}px)`;
    const wide = String(Math.max(lines.length, 99)).length;
    if (digits !== wide) box.style.setProperty("--digits", String((digits = wide)));
  }

  /** @param {number} at @param {HTMLElement} line @param {HTMLElement} number */
  function put(at, line, number) {
    /** @type {[HTMLElement, HTMLElement][]} */
    const pairs = [[layer, line], [gutter, number]];
    for (const [side, made] of pairs) {
      const before = side.children[at];
      if (before) before.replaceWith(made);
      else side.append(made);
    }
  }

  /** @param {number} at @returns {HTMLElement} a line in colours */
  function row(at) {
    const parts = highlightLine(lines[at], states[at]).parts;
    return make("div", { className: marks.has(at + 1) ? "line wrong" : "line" },
      ...parts.map(([kind, text]) => (kind ? make("span", { className: kind }, text) : text)));
  }

  /** @param {number} at @param {string | undefined} mark @param {boolean} edited @returns {HTMLElement} */
  function number(at, mark, edited) {
    const className = `line${mark === undefined ? "" : " wrong"}${edited ? " edited" : ""}`;
    return make("div", { className, title: mark ?? "" }, String(at + 1));
  }

  const show = () => { asked ||= requestAnimationFrame(draw); };

  function measure() {
    height = parseFloat(getComputedStyle(area).lineHeight) || 20;
    show();
  }

  /** Make a change that the browser can undo. @param {import("./typing.js").Change | null} change */
  function apply(change) {
    if (!change) return false;
    area.setSelectionRange(change.from, change.to);
    const done = change.insert
      ? document.execCommand("insertText", false, change.insert)
      : change.from === change.to || document.execCommand("delete");
    if (!done) {
      area.setRangeText(change.insert, change.from, change.to);
      changed();
    }
    area.setSelectionRange(change.start, change.end);
    return true;
  }

  function changed() {
    read();
    draw();
    onInput();
  }

  /** @param {KeyboardEvent} event */
  function press(event) {
    const { key, ctrlKey, metaKey, altKey, shiftKey } = event, command = ctrlKey || metaKey;
    const now = { text: area.value, start: area.selectionStart, end: area.selectionEnd };
    let done = false;
    const tab = key === "Tab" && !escaped && !command && !altKey;
    if (tab) done = apply(shiftKey ? outdented(now) : indented(now));
    else if (key === "Enter" && !command && !altKey) done = apply(newLine(now));
    else if (key === "/" && command) done = apply(commented(now));
    else if (key.length === 1 && "})]".includes(key) && !command) done = apply(closing(now, key));
    if (key !== "Shift") escaped = key === "Escape";
    if (done) event.preventDefault();
    event.stopPropagation(); // keys of the picture are letters here
  }

  area.addEventListener("input", changed);
  area.addEventListener("keydown", press);
  area.addEventListener("blur", () => { escaped = false; });
  area.addEventListener("scroll", draw, { passive: true });
  const watch = new ResizeObserver(measure);
  watch.observe(area);

  return {
    area,
    get text() { return area.value; },
    /** Show another text, as if it had just been opened.
     *  @param {string} text @param {string} name @param {string} before  lines that it has not are marked */
    open(text, name, before) {
      area.value = text;
      original = new Set(before.split("\n"));
      area.setAttribute("aria-label", name);
      area.setSelectionRange(0, 0);
      [area.scrollTop, area.scrollLeft] = [0, 0];
      marks = new Map();
      read();
      draw();
    },
    /** Replace the whole text as an edit that can be undone. @param {string} text */
    replace(text) {
      const start = Math.min(area.selectionStart, text.length);
      area.focus();
      apply({ from: 0, to: area.value.length, insert: text, start, end: start });
    },
    /** @param {Marks} wanted */
    mark(wanted) {
      marks = wanted;
      draw();
    },
    /** Go to a line, from 1, and a column, from 1, or 0 for its beginning.
     *  @param {number} line @param {number} column */
    go(line, column) {
      const before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
      const at = before + Math.max(column - 1, 0);
      area.focus();
      area.setSelectionRange(at, at);
      area.scrollTop = Math.max((line - 1) * height - area.clientHeight / 3, 0);
      draw();
    },
    close() {
      watch.disconnect();
      cancelAnimationFrame(asked);
      box.remove();
    },
  };
}

let fields = 0;
