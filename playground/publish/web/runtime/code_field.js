// code_field.js -- a text field for GLSL: CodeMirror, with marks at lines that are wrong or edited.

import { defaultKeymap, history, historyKeymap, indentLess, indentMore } from "@codemirror/commands";
import { bracketMatching, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { search, searchKeymap } from "@codemirror/search";
import { EditorState, RangeSetBuilder } from "@codemirror/state";
import { EditorView, gutterLineClass, GutterMarker, keymap, lineNumbers } from "@codemirror/view";
import { make } from "./dom.js";
import { SEARCH_PHRASES } from "./editor_words.js";
import { glsl } from "./glsl_language.js";
import { wordsOf } from "./words.js";

/** Marked lines by their number, from 1: what is said of each.
 *  @typedef {Map<number, string>} Marks */
/** @typedef {ReturnType<typeof createCodeField>} CodeField */

const INDENT = "    ";
const EDITED = new (class extends GutterMarker { elementClass = "edited"; })();

/** The document without its head: CodeMirror then adopts style sheets, which a page's policy allows, and adds
 *  no style element, which it forbids. */
const rootOf = (/** @type {Document} */ page) => new Proxy(page, {
  get(target, key) {
    const found = key === "head" ? null : Reflect.get(target, key);
    return typeof found === "function" ? found.bind(target) : found;
  },
  set: (target, key, value) => Reflect.set(target, key, value),
});

/** Make a field in a host.
 *  @param {HTMLElement} host
 *  @param {{hint: string, onInput: () => void}} options */
export function createCodeField(host, { hint, onInput }) {
  const told = make("p", { className: "unseen", id: `code-hint-${++fields}` }, hint);
  const box = make("div", { className: "code-field" }, told);
  host.append(box);
  const view = new EditorView({ parent: box, root: rootOf(document) });
  box.addEventListener("keydown", (event) => event.stopPropagation()); // keys of the picture are letters here

  const always = [
    lineNumbers(), lintGutter(), history(), bracketMatching(), indentOnInput(), search({ top: true }), glsl,
    indentUnit.of(INDENT), EditorState.phrases.of(wordsOf(document.documentElement.lang, SEARCH_PHRASES)),
    keymap.of([
      { key: "Tab", run: indent, shift: indentLess },
      ...searchKeymap, ...historyKeymap, ...lintKeymap, ...defaultKeymap,
    ]),
    EditorView.updateListener.of((update) => {
      if (update.docChanged) onInput();
    }),
  ];

  return {
    get text() { return view.state.doc.toString(); },
    /** Show another text, as if it had just been opened.
     *  @param {string} text @param {string} label @param {string} before  lines that it has not are marked */
    open(text, label, before) {
      const name = EditorView.contentAttributes.of({ "aria-label": label, "aria-describedby": told.id });
      view.setState(EditorState.create({ doc: text, extensions: [always, name, editedLines(before)] }));
      view.scrollDOM.scrollTo(0, 0);
    },
    /** Replace the whole text as an edit that can be undone. @param {string} text */
    replace(text) {
      const { doc, selection } = view.state;
      const anchor = Math.min(selection.main.from, text.length);
      view.focus();
      view.dispatch({ changes: { from: 0, to: doc.length, insert: text }, selection: { anchor } });
    },
    /** @param {Marks} marks */
    mark(marks) {
      const { doc } = view.state;
      const found = [...marks].filter(([number]) => number <= doc.lines).map(([number, message]) => {
        const { from, to, text } = doc.line(number);
        return { from: from + text.search(/\S|$/), to, message, severity: /** @type {const} */ ("error") };
      });
      view.dispatch(setDiagnostics(view.state, found));
    },
    /** Go to a line, from 1, and a column, from 1, or 0 for its beginning.
     *  @param {number} line @param {number} column */
    go(line, column) {
      const { from, to } = view.state.doc.line(Math.min(line, view.state.doc.lines));
      const anchor = Math.min(from + Math.max(column - 1, 0), to);
      view.focus();
      view.dispatch({ selection: { anchor }, effects: EditorView.scrollIntoView(anchor, { y: "center" }) });
    },
    close() {
      view.destroy();
      box.remove();
    },
  };
}

/** Indent the lines that are selected, or write spaces to the next stop.
 *  @param {EditorView} view */
function indent(view) {
  const { state } = view, { main } = state.selection;
  if (!main.empty) return indentMore(view);
  const column = main.head - state.doc.lineAt(main.head).from;
  view.dispatch(state.replaceSelection(INDENT.slice(column % INDENT.length)));
  return true;
}

/** Marks in the gutter at lines that another text has not. @param {string} before */
function editedLines(before) {
  const original = new Set(before.split("\n"));
  return gutterLineClass.compute(["doc"], ({ doc }) => {
    /** @type {RangeSetBuilder<GutterMarker>} */
    const found = new RangeSetBuilder();
    for (let number = 1; number <= doc.lines; number++) {
      const { from, text } = doc.line(number);
      if (!original.has(text)) found.add(from, from, EDITED);
    }
    return found.finish();
  });
}

let fields = 0;
