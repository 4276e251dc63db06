// panel.js -- what can be changed of a sketch: main parameters, passes, terrain, iterations; search, presets, copies.

import { asToml, asWords } from "./address.js";
import { makeRow } from "./controls.js";
import { button, make } from "./dom.js";
import { fill } from "./words.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Choice} Choice */
/** @typedef {import("./figure.js").Figure} Figure */
/** @typedef {ReturnType<typeof makeRow>} Row */

const FOUND = 150; // rows that a search shows

/** A name as a panel writes it: rock_from as "Rock from"; one in mixed case as it is.
 *  @param {string} name */
export const labelOf = (name) => (name === name.toLowerCase() ? name[0].toUpperCase() + name.slice(1).replaceAll("_", " ") : name);

/** @param {string} heading @param {string} title */
const under = (heading, title) => `${heading}: ${title[0].toLowerCase()}${title.slice(1)}`;

/** Labels of main parameters, by path: group or pass named where a label alone would not say what is meant.
 *  @param {Shown[]} rows @returns {Map<string, string>} */
export function mainLabels(rows) {
  const titles = rows.map(({ label, group, path }) => {
    const own = label !== labelOf(path.slice(path.lastIndexOf(".") + 1));
    return own && group && !(group + label).includes(" ") && label !== group ? under(group, label) : label;
  });
  return new Map(rows.map((row, at) => {
    const twice = titles.filter((title) => title === titles[at]).length > 1;
    return [row.path, twice ? under(labelOf(row.pass), titles[at]) : titles[at]];
  }));
}

/** What a sketch is about, each once: of a row and one inside it that it stands for, the outer.
 *  @param {Shown[]} rows */
export function mainRows(rows) {
  const main = rows.filter((row) => row.main), outer = new Set(main.filter((row) => row.exported).flatMap((row) => row.targets));
  return main.filter((row) => row.exported || !outer.has(row.targets[0]));
}

/** Split a list where a key of its items changes, keeping the order of the first of each.
 *  @template Item @param {Item[]} items @param {(item: Item) => string} key @returns {Map<string, Item[]>} */
export function grouped(items, key) {
  /** @type {Map<string, Item[]>} */
  const found = new Map();
  for (const item of items) found.set(key(item), [...(found.get(key(item)) ?? []), item]);
  return found;
}

/** Make the panel. @param {Figure} figure
 *  @param {{words: Object<string, string>, labels?: Object<string, string>, link: () => string, copied: (text: string) => void,
 *           say: (text: string) => void}} options */
export function createPanel(figure, { words, labels = {}, link, copied, say }) {
  const { session } = figure, named = (/** @type {string} */ text) => labels[text] ?? text;
  /** @type {[string, Row][]} */
  let rows = [];
  /** @type {(() => void)[]} */
  let refreshes = [];

  const search = make("input", { type: "search", placeholder: words.search, "aria-label": words.keySearch, autocomplete: "off" });
  const undo = button("↶", () => session.undo() && say(words.undone), { title: `${words.undo} (Ctrl+Z)`, "aria-label": words.undo });
  const redo = button("↷", () => session.redo() && say(words.redone), { title: `${words.redo} (Ctrl+Shift+Z)`, "aria-label": words.redo });
  const all = button(words.resetAll, () => session.resetAll());
  const preset = make("select", { "aria-label": words.preset, hidden: true });
  const copies = make("details", { className: "menu" }, make("summary", {}, words.copyAs), make("div", {},
    button(words.copyLink, () => take(link())),
    button(words.copyToml, () => take(session.anyChanged() ? asToml(session, session.sketch.name) : "")),
    button(words.copySet, () => take(asWords(session)))));
  const list = make("div", { className: "list" }), found = make("div", { className: "list", hidden: true });
  const head = make("div", { className: "panel-head" }, make("div", { className: "line" }, undo, redo, all, copies), make("div", { className: "line" }, preset, search));
  const element = make("div", { className: "panel" }, head, list, found);

  function take(/** @type {string} */ text) {
    copies.open = false;
    if (text) copied(text);
    else say(words.nothingDiffers);
  }
  copies.addEventListener("focusout", (event) => { if (!copies.contains(/** @type {Node} */ (event.relatedTarget))) copies.open = false; });

  // ── rows ───────────────────────────────────────────────────────────────────

  function rowOf(/** @type {Shown} */ one, label = named(one.label)) {
    const row = makeRow({ ...one, label, parts: one.parts.map(named) }, label, {
      words,
      changed: (value) => session.set(one.path, value),
      reset: () => session.reset(one.path),
      press: (down) => session.press(one.path, down),
    });
    rows.push([one.path, row]);
    row.show(session.value(one.path), session.changed(one.path));
    return row.element;
  }

  function refresh() {
    for (const [path, row] of rows) if (session.row(path)) row.show(session.value(path), session.changed(path));
    [...refreshes].forEach((act) => act());
    undo.disabled = !session.canUndo;
    redo.disabled = !session.canRedo;
    all.disabled = !session.anyChanged();
  }

  /** A fold whose inside is made when it is first opened. */
  function fold(/** @type {string} */ title, /** @type {boolean} */ open, /** @type {() => (Node | null)[]} */ inside, name = "section") {
    const body = make("div", { className: "fold" }), made = make("details", { className: name, open }, make("summary", {}, title), body);
    const fillIn = () => { if (made.open && !body.childNodes.length) body.append(...inside().filter((node) => node !== null)); };
    made.addEventListener("toggle", fillIn);
    fillIn();
    return made;
  }

  /** Rows by their groups, those without one first. */
  function groups(/** @type {Shown[]} */ items) {
    const sorted = grouped(items, (row) => row.group), first = sorted.get("") ?? [];
    sorted.delete("");
    return [...first.map((row) => rowOf(row)), ...[...sorted].flatMap(([group, inside]) => [
      make("h3", {}, named(group)), ...inside.map((row) => rowOf(row))])];
  }

  function section(/** @type {string} */ pass, /** @type {Shown[]} */ items, /** @type {boolean} */ open) {
    const outer = items.filter((row) => row.exported), inner = items.filter((row) => !row.exported);
    const choice = session.sketch.choices.find((one) => one.pass === pass);
    return fold(named(labelOf(pass)), open, () => [
      choice ? technique(choice) : null,
      ...groups(outer),
      inner.length ? fold(fill(words.inside, { count: inner.length }), false, () =>
        [...grouped(inner, (row) => row.path.slice(0, row.path.lastIndexOf(".")))].map(([path, inside]) =>
          fold(path.slice(path.indexOf(".") + 1), inner.length < 12, () => groups(inside), "inner")), "inner") : null,
    ]);
  }

  function technique(/** @type {Choice} */ choice) {
    const menu = make("select", { "aria-label": `${words.technique}: ${choice.label}` },
      make("option", { value: "" }, choice.now), ...choice.others.map((one) => make("option", { value: String(one.sketch) }, one.title || one.use)));
    menu.onchange = () => { if (menu.value) session.choose(+menu.value); };
    return make("div", { className: "row" }, make("span", { className: "name" }, words.technique), menu);
  }

  // ── iterations ─────────────────────────────────────────────────────────────

  function iterations() {
    const body = make("div", {});
    let known = "";
    const show = () => {
      const repeats = figure.repeats(), now = JSON.stringify([...repeats]);
      if (now !== known) body.replaceChildren(...[...repeats].map(([path, count]) => stepsRow(path, count)));
      known = now;
    };
    const between = session.sketch.kernels.some((kernel) => kernel.between);
    const box = make("input", { type: "checkbox", checked: session.interpolated });
    box.onchange = () => { session.interpolated = box.checked; };
    refreshes.push(show);
    show();
    return [body, between ? make("label", { className: "row" }, make("span", { className: "name" }, words.interpolated), box) : null];
  }

  function stepsRow(/** @type {string} */ path, /** @type {number} */ count) {
    const label = path.split(".").map(labelOf).join(", "), range = make("input", { type: "range", min: 0, max: count, step: 1, "aria-label": fill(words.iterationsOf, { name: label }) });
    const text = make("output", {}), row = make("div", { className: "row is-steps" }, make("span", { className: "name", title: path }, label), range, text);
    row.dataset.path = path;
    const show = () => {
      const at = Math.min(session.steps.get(path) ?? session.sketch.steps[path] ?? count, count);
      range.value = String(at);
      range.style.setProperty("--share", String(at / count));
      text.textContent = at === count ? fill(words.allOf, { count }) : String(at);
      range.setAttribute("aria-valuetext", text.textContent);
      row.classList.toggle("changed", session.steps.has(path));
    };
    range.oninput = () => session.stop(path, +range.value === count && !(path in session.sketch.steps) ? null : +range.value);
    row.ondblclick = () => session.stop(path, null);
    refreshes.push(show);
    show();
    return row;
  }

  // ── the whole ──────────────────────────────────────────────────────────────

  function rebuild() {
    const { sketch } = session;
    [rows, refreshes] = [[], []];
    preset.hidden = !sketch.presets.length;
    preset.replaceChildren(make("option", { value: "" }, words.preset), ...sketch.presets.map(({ name }) => make("option", { value: name }, named(name))));
    const main = mainRows(sketch.shown), titles = mainLabels(main);
    const passes = grouped(sketch.shown, (row) => row.pass);
    for (const { pass } of sketch.choices) if (!passes.has(pass)) passes.set(pass, []);
    const map = make("div", { hidden: true });
    const showMap = () => {
      map.hidden = !session.map;
      if (session.map && !map.firstChild) map.append(fold(words.map, true, mapRows));
    };
    refreshes.push(showMap);
    const terrain = session.rows().filter((row) => row.targets.length === 0);
    list.replaceChildren(map,
      ...(main.length ? [fold(words.main, true, () => main.map((row) => rowOf(row, titles.get(row.path))))] : []),
      ...[...passes].map(([pass, items]) => section(pass, items, !main.length)),
      fold(words.terrain, false, () => terrain.map((row) => rowOf(row, words[row.label]))),
      fold(words.iterations, Object.keys(sketch.steps).length > 0, iterations),
      ...(sketch.notes.length ? [fold(words.notes, false, () => sketch.notes.map((note) => make("p", {}, note)))] : []));
    filter();
    refresh();
  }

  function mapRows() {
    const { shown } = session.sketch.map;
    return [...shown.map((one) => {
      const leaf = one.targets[0];
      const row = makeRow({ ...one, label: named(one.label) }, named(one.label), {
        words,
        changed: (value) => session.map && session.setMap({ ...session.map, values: { ...session.map.values, [leaf]: value } }),
        reset: () => session.map && session.setMap({ ...session.map, values: { ...session.map.values, [leaf]: one.value } }),
        press: () => {},
      });
      const show = () => session.map && row.show(session.map.values[leaf] ?? one.value);
      refreshes.push(show);
      show();
      return row.element;
    }), button(words.fitValues, () => figure.fitMap())];
  }

  function filter() {
    const wanted = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    list.hidden = wanted.length > 0;
    found.hidden = !wanted.length;
    rows = rows.filter(([, row]) => !found.contains(row.element));
    if (!wanted.length) return found.replaceChildren();
    const hits = session.rows().filter((row) => {
      const text = [row.label, words[row.label] ?? "", row.path, row.path.replaceAll("_", " "), row.group, row.description].join(" ").toLowerCase();
      return wanted.every((word) => text.includes(word));
    }).slice(0, FOUND);
    found.replaceChildren(...(hits.length ? [...grouped(hits, (row) => row.pass)].flatMap(([pass, items]) => [
      make("h2", {}, pass ? named(labelOf(pass)) : words.terrain), ...items.map((row) => rowOf(row, row.pass ? undefined : words[row.label]))]) : [make("p", { className: "none" }, words.noneFound)]));
    return undefined;
  }

  search.oninput = filter;
  preset.onchange = () => {
    const chosen = session.sketch.presets.find(({ name }) => name === preset.value);
    if (chosen) session.setAll(Object.entries(chosen.values));
    if (chosen) say(fill(words.presetChosen, { name: named(chosen.name) }));
    preset.value = "";
  };
  session.follow((news) => {
    if (news === "sketch") rebuild();
    else if (news === "values" || news === "map") refresh();
  });
  rebuild();
  return { element, search, refresh };
}
