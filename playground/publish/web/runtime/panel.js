// panel.js -- what can be changed of a sketch: main parameters, passes, terrain, iterations; search, copies.

import { asToml, asWords } from "./address.js";
import { button, make } from "./dom.js";
import { iterationRows } from "./iterations.js";
import { grouped, isLike, labelOf, mainLabels, mainRows } from "./labels.js";
import { createRows, fold } from "./panel_rows.js";
import { fill } from "./words.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Choice} Choice */
/** @typedef {import("./session.js").Session} Session */

/** @typedef {object} PanelOptions
 *  @property {Object<string, string>} words
 *  @property {() => string} link                     the page's address with the values
 *  @property {(text: string) => void} copied         puts a text on the clipboard
 *  @property {(text: string) => void} say
 *  @property {() => void} fitMap
 *  @property {() => Map<string, number>} repeats     iterations in all, by path */

const FOUND = 150; // rows that a search shows
const MAX_ROWS_OPEN = 12; // inner rows that are all shown at once

/** Make the panel of a session. @param {Session} session @param {PanelOptions} options */
export function createPanel(session, { words, link, copied, say, fitMap, repeats }) {
  const rows = createRows(session, words);

  // ── the head ───────────────────────────────────────────────────────────────

  const undo = button("↶", () => session.undo() && say(words.undone), { "aria-label": words.undo });
  const redo = button("↷", () => session.redo() && say(words.redone), { "aria-label": words.redo });
  undo.title = `${words.undo} (Ctrl+Z)`;
  redo.title = `${words.redo} (Ctrl+Shift+Z)`;
  const all = button(words.resetAll, () => session.resetAll());
  const preset = make("select", { "aria-label": words.preset });
  const search = make("input", { type: "search", placeholder: words.search, autocomplete: "off" });
  search.setAttribute("aria-label", words.keySearch);
  const summary = make("summary", {}, words.copyAs), choices = make("div");
  const copies = make("details", { className: "menu" }, summary, choices);
  /** @type {[string, () => string][]} */
  const texts = [
    [words.copyLink, link],
    [words.copyToml, () => (session.edits.size ? asToml(session, session.sketch.name) : "")],
    [words.copySet, () => asWords(session)],
  ];
  for (const [label, text] of texts) choices.append(button(label, () => take(text())));

  function take(/** @type {string} */ text) {
    copies.open = false;
    summary.focus();
    if (text) copied(text);
    else say(words.nothingDiffers);
  }
  copies.addEventListener("focusout", (event) => {
    const to = /** @type {Node | null} */ (event.relatedTarget);
    if (to && !copies.contains(to)) copies.open = false;
  });
  copies.addEventListener("keydown", (event) => {
    if (event.key === "Escape") take("");
  });

  preset.onchange = () => {
    const chosen = session.sketch.presets.find(({ name }) => name === preset.value);
    preset.value = "";
    if (!chosen) return;
    session.setAll(Object.entries(chosen.values));
    say(fill(words.presetChosen, { name: chosen.name }));
  };

  const list = make("div", { className: "list" }), found = make("div", { className: "list" });
  const head = make("div", { className: "panel-head" },
    make("div", { className: "head-line" }, undo, redo, all, copies),
    make("div", { className: "head-line" }, preset, search));
  const element = make("div", { className: "panel" }, head, list, found);

  // ── the passes ─────────────────────────────────────────────────────────────

  function section(/** @type {string} */ pass, /** @type {Shown[]} */ items, /** @type {boolean} */ open) {
    const outer = items.filter((row) => row.exported), inner = items.filter((row) => !row.exported);
    const choice = session.sketch.choices.find((one) => one.pass === pass);
    const few = inner.length < MAX_ROWS_OPEN;
    const inside = () =>
      [...grouped(inner, ({ path }) => path.slice(0, path.lastIndexOf(".")))].map(([path, some]) =>
        fold(path.slice(path.indexOf(".") + 1), few, () => rows.groups(some), "inner"));
    return fold(labelOf(pass), open, () => [
      choice ? technique(choice) : null,
      ...rows.groups(outer),
      inner.length ? fold(fill(words.inside, { count: inner.length }), false, inside, "inner") : null,
    ]);
  }

  function technique(/** @type {Choice} */ choice) {
    const others = choice.others.map(({ sketch, title, use }) =>
      make("option", { value: String(sketch) }, title || use));
    const menu = make("select", {}, make("option", { value: "" }, choice.now), ...others);
    menu.setAttribute("aria-label", `${words.technique}: ${choice.label}`);
    menu.onchange = () => { if (menu.value) session.choose(+menu.value); };
    return make("div", { className: "row" }, make("span", { className: "name" }, words.technique), menu);
  }

  /** What is shown of a map, while there is one. */
  function mapSection() {
    const made = make("div");
    return rows.keep(made, () => {
      made.hidden = !session.map;
      if (!session.map || made.firstChild) return;
      made.append(fold(words.mapShown, true, () => rows.mapRows(fitMap)));
    });
  }

  function rebuild() {
    const { sketch } = session, main = mainRows(sketch.shown), titles = mainLabels(main);
    rows.forget();
    preset.hidden = !sketch.presets.length;
    const offered = sketch.presets.map(({ name }) => make("option", { value: name }, name));
    preset.replaceChildren(make("option", { value: "" }, words.preset), ...offered);
    const passes = grouped(sketch.shown, (row) => row.pass);
    for (const { pass } of sketch.choices) if (!passes.has(pass)) passes.set(pass, []);
    const mine = () => rows.rowsOf(main, { titles });
    const stopped = Object.keys(sketch.steps).length > 0;
    const isLoop = (/** @type {object} */ node) => "loop" in node;
    const repeated = sketch.kernels.some(({ repeat }) => repeat !== 1) || sketch.nodes.some(isLoop);
    const notes = sketch.notes.map((note) => make("p", {}, note));
    const terrain = session.rows().filter((row) => !row.targets.length);
    const sections = [
      mapSection(),
      main.length ? fold(words.main, true, mine) : null,
      ...[...passes].map(([pass, items]) => section(pass, items, !main.length)),
      fold(words.terrain, false, () => rows.rowsOf(terrain)),
      repeated ? fold(words.iterations, stopped, () => iterationRows(session, words, rows, repeats)) : null,
      notes.length ? fold(words.notes, false, () => notes) : null,
    ];
    list.replaceChildren(...sections.filter((one) => one !== null));
    filter();
    refresh();
  }

  function filter() {
    const wanted = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    list.hidden = wanted.length > 0;
    rows.forget(found);
    const label = (/** @type {Shown} */ row) => (row.pass ? row.label : words[row.label]);
    const hits = session.rows().filter((row) => isLike(row, label(row), wanted));
    const passes = wanted.length ? [...grouped(hits.slice(0, FOUND), (row) => row.pass)] : [];
    found.replaceChildren(...passes.flatMap(([pass, items]) => [
      make("h2", {}, pass ? labelOf(pass) : words.terrain), ...rows.rowsOf(items),
    ]));
    if (wanted.length && !hits.length) found.append(make("p", { className: "none" }, words.noneFound));
  }

  function refresh() {
    rows.refresh();
    undo.disabled = !session.canUndo;
    redo.disabled = !session.canRedo;
    all.disabled = !session.anyChanged();
  }

  search.oninput = filter;
  session.follow((news) => {
    if (news === "sketch") rebuild();
    else if (news === "values" || news === "map") refresh();
  });
  rebuild();
  return { element, search, refresh };
}
