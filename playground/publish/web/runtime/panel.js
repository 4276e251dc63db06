// panel.js -- what can be changed of a sketch: main parameters, passes, terrain, iterations; search, copies.

import { asToml, asWords } from "./address.js";
import { makeRow, whyLocked } from "./controls.js";
import { button, make } from "./dom.js";
import { grouped, isLike, labelOf, mainLabels, mainRows } from "./labels.js";
import { fill } from "./words.js";

/** @import { Choice, Shown, Value } from "./schema.js"
 *  @import { Session } from "./session.js" */

// ── Repeats that may be stopped early, a slider each; of one that may not, why.

/** Make the sliders. `repeats` gives the iterations in all of each repeat, by path; none before a plan.
 *  @param {Session} session @param {Object<string, string>} words @param {Rows} rows
 *  @param {() => Map<string, number>} repeats */
function iterationRows(session, words, rows, repeats) {
  const body = make("div", {});
  let known = "";

  const lockedOf = (/** @type {string} */ path) => session.sketch.passes[path]?.locked ?? "";

  function slider(/** @type {string} */ path, /** @type {number} */ count) {
    const label = path.split(".").map(labelOf).join(", "), own = session.sketch.steps[path];
    const called = fill(words.iterationsOf, { name: label });
    const range = make("input", { type: "range", min: 0, max: count, step: 1, "aria-label": called });
    const text = make("output"), name = make("span", { className: "name", title: path }, label);
    const row = make("div", { className: "row is-steps" }, name, range, text);
    row.dataset.path = path;
    const locked = lockedOf(path);
    if (locked) range.setAttribute("aria-description", locked);
    range.disabled = Boolean(locked);
    row.classList.toggle("locked", range.disabled);
    range.oninput = () => session.stop(path, +range.value === (own ?? count) ? null : +range.value);
    row.ondblclick = () => session.stop(path, null);
    return rows.keep(row, () => {
      const at = Math.min(session.steps.get(path) ?? own ?? count, count);
      range.value = String(at);
      range.style.setProperty("--share", String(at / count));
      text.textContent = at === count ? fill(words.allOf, { count }) : String(at);
      range.setAttribute("aria-valuetext", text.textContent);
      row.classList.toggle("changed", session.steps.has(path));
    });
  }

  rows.keep(body, () => {
    const found = [...repeats()].filter(([, count]) => count > 1), now = JSON.stringify(found);
    if (now === known) return;
    known = now;
    rows.forget(body);
    const said = new Set([""]); // why repeats are locked: once, before the first of those
    body.replaceChildren(...found.flatMap(([path, count]) => {
      const locked = lockedOf(path), why = said.has(locked) ? [] : [whyLocked(locked)];
      said.add(locked);
      return [...why, slider(path, count)];
    }));
  });
  if (!session.sketch.kernels.some((kernel) => kernel.between)) return [body];
  const box = make("input", { type: "checkbox", checked: session.interpolated });
  box.onchange = () => { session.interpolated = box.checked; };
  const name = make("span", { className: "name" }, words.interpolated);
  return [body, make("label", { className: "row" }, name, box)];
}

// ── The rows of a panel: made when they are first looked at, kept as the session is.

/** @typedef {ReturnType<typeof createRows>} Rows */

/** Make the rows of a session. @param {Session} session @param {Object<string, string>} words */
function createRows(session, words) {
  /** @type {[Element, () => void][]} what is shown, and what makes it as the session is */
  let shown = [];

  function keep(/** @type {Element} */ element, /** @type {() => void} */ show) {
    shown.push([element, show]);
    show();
    return element;
  }

  /** A parameter, or what the terrain has.
   *  @param {Shown} one @param {boolean} [said] @param {string} [title] */
  function rowOf(one, said = false, title = "") {
    const label = title || (one.pass ? one.label : words[one.label]);
    const row = makeRow({ ...one, label }, label, {
      words,
      changed: (value) => session.set(one.path, value),
      reset: () => session.reset(one.path),
      press: (down) => session.press(one.path, down),
    }, said);
    return keep(row.element, () => row.show(session.value(one.path), session.changed(one.path)));
  }

  /** What a map is shown with. */
  function mapRow(/** @type {Shown} */ one) {
    const set = (/** @type {Value} */ value) => {
      const { map } = session;
      if (map) session.setMap({ ...map, values: { ...map.values, [one.targets[0]]: value } });
    };
    const row = makeRow(one, one.label, {
      words, changed: set, reset: () => set(one.value), press: () => {},
    });
    return keep(row.element, () => row.show(session.map?.values[one.targets[0]] ?? one.value));
  }

  /** Rows one after another; why several of them are locked stands once, before the first of these.
   *  @param {Shown[]} items @param {{said?: string, titles?: Map<string, string>}} [how]  `said`: what was
   *  said of all before; `titles`: other labels, by path */
  function rowsOf(items, { said = "", titles } = {}) {
    const known = new Set([said]);
    return items.flatMap((one) => {
      const { locked } = one, title = titles?.get(one.path);
      const several = items.some((other) => other !== one && other.locked === locked);
      if (!locked || !(several || locked === said)) return [rowOf(one, false, title)];
      const row = rowOf(one, true, title);
      if (known.has(locked)) return [row];
      known.add(locked);
      return [whyLocked(locked), row];
    });
  }

  /** Rows by their groups, those without one first. @param {Shown[]} items */
  function groups(items) {
    const sorted = grouped(items, (row) => row.group), first = sorted.get("") ?? [];
    sorted.delete("");
    const locked = items.length > 1 ? items[0].locked : "";
    const said = items.every((one) => one.locked === locked) ? locked : ""; // of the whole section
    const headed = [...sorted].flatMap(([group, inside]) => [
      make("h3", {}, group), ...rowsOf(inside, { said }),
    ]);
    return [...(said ? [whyLocked(said)] : []), ...rowsOf(first, { said }), ...headed];
  }

  return {
    keep, rowsOf, groups,
    /** @param {() => void} fit */
    mapRows: (fit) => [...session.sketch.map.shown.map(mapRow), button(words.fitValues, fit)],
    refresh: () => shown.forEach(([, show]) => show()),
    /** Forget the rows of an element, or all. @param {Element} [within] */
    forget(within) { shown = within ? shown.filter(([element]) => !within.contains(element)) : []; },
  };
}

/** A fold whose inside is made when it is first opened.
 *  @param {string} title @param {boolean} open @param {() => (Node | null)[]} inside
 *  @param {string} [name] */
export function fold(title, open, inside, name = "section") {
  const body = make("div", { className: "fold" });
  const made = make("details", { className: name, open }, make("summary", {}, title), body);
  const fillIn = () => {
    if (made.open && !body.childNodes.length) body.append(...inside().filter((node) => node !== null));
  };
  made.addEventListener("toggle", fillIn);
  fillIn();
  return made;
}

// ── What can be changed of a sketch

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
