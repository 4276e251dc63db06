// editor.js -- the texts of a sketch in a page: typed, compiled at once, their errors at their lines.

import { createCodeField } from "./code_field.js";
import { button, copy, make, save } from "./dom.js";
import { fileGroups, notices } from "./sketch_files.js";
import { fill } from "./words.js";

/** @import { Shared, Sketch } from "./schema.js" */

/** @typedef {{file: string, line: number, message: string, kernel: string, column?: number}} Complaint */

/** What the editor asks of a player.
 *  @typedef {object} Editable
 *  @property {Sketch} sketch
 *  @property {Shared} shared
 *  @property {Object<string, string>} texts          edited files that the picture is made of
 *  @property {(file: string, text: string) => Promise<{errors: Complaint[], programs: number}>} edit */

/** @typedef {object} EditorOptions
 *  @property {Object<string, string>} words          of the editor
 *  @property {import("./recovery.js").Guard} [guard] keeps what worked over a reload
 *  @property {() => Promise<void>} [shown]           draws the picture, and waits until it is there */

/** @typedef {ReturnType<typeof createEditor>} Editor */

const PAUSE = 150; // [ms] without a key, then what was typed is compiled

/** Make the editor of a player's texts in a host.
 *  @param {HTMLElement} host @param {Editable} player @param {EditorOptions} options */
export function createEditor(host, player, options) {
  const { words } = options;
  /** What was typed and differs from the sketch's text, working or not.
   *  @type {Map<string, string>} */
  const drafts = new Map(Object.entries(player.texts));
  /** @type {Map<string, Complaint[]>} by the file that was edited */
  const problems = new Map();
  let file = "", timer = 0, closed = false;
  /** @type {Promise<void>} */
  let work = Promise.resolve();

  const select = make("select", { onchange: () => open(select.value) });
  const status = make("p", { className: "editor-status", role: "status" });
  const list = make("ol", { className: "editor-problems" });
  const said = make("ul", { className: "editor-notices" });
  const bar = make("div", { className: "editor-bar" }, make("label", {}, words.file, " ", select));
  const resetOne = button(words.resetFile, () => put(original(file)), { className: "editor-reset" });
  bar.append(resetOne, button(words.copyFile, copyFile, { className: "editor-copy" }),
    button(words.saveFile, saveFile, { className: "editor-save" }));
  const root = make("section", { className: "editor" }, bar);
  host.append(root);
  const field = createCodeField(root, { hint: words.fieldKeys, onInput: typed });
  root.append(status, list, said, make("p", { className: "editor-keys" }, words.fieldKeys));

  const original = (/** @type {string} */ name) => player.shared.files[name] ?? "";
  const textOf = (/** @type {string} */ name) => drafts.get(name) ?? original(name);
  const isEdited = (/** @type {string} */ name) => drafts.has(name);

  function listFiles() {
    const groups = fileGroups(player.sketch, player.shared);
    select.replaceChildren(...groups.map(({ key, files }) => make("optgroup", { label: words[key] },
      ...files.map((name) => make("option", { value: name }, shownName(name))))));
    const all = groups.flatMap(({ files }) => files);
    open(all.includes(file) ? file : all[0] ?? "");
  }

  /** @param {string} name */
  function shownName(name) {
    const plain = name.replace(/^\.\//, "");
    const key = problems.get(name)?.length ? "broken" : isEdited(name) ? "edited" : "";
    return key ? fill(words[key], { name: plain }) : plain;
  }

  /** Show a file. @param {string} name */
  function open(name) {
    settle();
    file = name;
    select.value = name;
    field.open(textOf(name), fill(words.field, { name: name.replace(/^\.\//, "") }), original(name));
    tell();
  }

  /** Put another text into the field, as if it had been typed. @param {string} text */
  function put(text) {
    field.replace(text);
    settle();
  }

  function typed() {
    if (field.text === original(file)) drafts.delete(file);
    else drafts.set(file, field.text);
    clearTimeout(timer);
    timer = window.setTimeout(settle, PAUSE);
  }

  /** Compile what was typed without waiting longer. */
  function settle() {
    if (!timer) return;
    clearTimeout(timer);
    timer = 0;
    const name = file, text = field.text;
    work = work.then(() => tried(name, text));
  }

  /** @param {string} name @param {string} text */
  async function tried(name, text) {
    if (closed || textOf(name) !== text) return; // typed over meanwhile: that is tried instead
    status.textContent = words.compilingText;
    options.guard?.trying(name, text, player.texts);
    const start = performance.now();
    let programs = 0;
    try {
      const found = await player.edit(name, text);
      problems.set(name, found.errors);
      programs = found.programs;
      if (!found.errors.length) await options.shown?.();
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      problems.set(name, [{ file: name, line: 0, message, kernel: "" }]);
    }
    options.guard?.worked(player.texts);
    if (closed) return;
    tell();
    if (!all().length && isEdited(file)) {
      const time = Math.round(performance.now() - start);
      status.textContent = programs ? fill(words.compiled, { time }) : words.unused;
    }
  }

  const all = () => {
    /** @type {Map<string, Complaint>} the same complaint of several passes is one */
    const found = new Map();
    for (const one of [...problems.values()].flat()) {
      found.set([one.file, one.line, one.message].join("\n"), one);
    }
    return [...found.values()];
  };

  /** Show what is wrong and what to know. */
  function tell() {
    const now = all(), count = now.length;
    for (const option of select.options) {
      const text = shownName(option.value);
      if (option.text !== text) option.text = text;
    }
    const here = now.filter((one) => one.file === file && one.line);
    field.mark(new Map(here.map((one) => [one.line, one.message])));
    list.replaceChildren(...now.map((one) => {
      const plain = one.file.replace(/^\.\//, "");
      const text = fill(one.line ? words.filePlace : words.placeless, { ...one, file: plain });
      return make("li", {}, button(text, () => go(one)));
    }));
    const told = drafts.has(file) ? notices(original(file), textOf(file)) : [];
    said.replaceChildren(...told.map(({ key, names }) =>
      make("li", {}, fill(words[key], { names: names.map((name) => `\u2018${name}\u2019`).join(", ") }))));
    status.textContent = count > 1 ? fill(words.problems, { count }) : count ? words.problem
      : isEdited(file) ? "" : words.unedited;
    status.classList.toggle("wrong", count > 0);
    resetOne.disabled = !isEdited(file);
  }

  /** @param {Complaint} one */
  function go(one) {
    if (one.file !== file && player.shared.files[one.file] !== undefined) open(one.file);
    if (one.file === file && one.line) field.go(one.line, one.column ?? 0);
  }

  const shortName = () => file.split("/").at(-1) ?? file;

  async function copyFile() {
    const text = (await copy(textOf(file))) ? words.fileCopied : words.fileNotCopied;
    status.textContent = fill(text, { name: shortName() });
  }

  function saveFile() {
    save(new Blob([textOf(file)], { type: "text/plain" }), shortName());
    status.textContent = fill(words.fileSaved, { name: shortName() });
  }

  listFiles();
  return {
    root,
    get drafts() { return Object.fromEntries(drafts); },
    get problems() { return all(); },
    /** After all that was typed so far is compiled. */
    done: () => { settle(); return work; },
    open, put,
    /** Say something where the editor says what became of a text. @param {string} text */
    say: (text) => { status.textContent = text; },
    /** The player shows another sketch, or its texts were set back. */
    refresh() {
      drafts.clear();
      problems.clear();
      for (const [name, text] of Object.entries(player.texts)) drafts.set(name, text);
      listFiles();
    },
    close() {
      closed = true;
      clearTimeout(timer);
      field.close();
      root.remove();
    },
  };
}
