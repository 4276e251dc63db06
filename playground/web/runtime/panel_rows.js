// panel_rows.js -- the rows of a panel: made when they are first looked at, kept as the session is.

import { makeRow } from "./controls.js";
import { button, make } from "./dom.js";
import { grouped } from "./labels.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./session.js").Session} Session */
/** @typedef {ReturnType<typeof createRows>} Rows */

/** Make the rows of a session. @param {Session} session @param {Object<string, string>} words */
export function createRows(session, words) {
  /** @type {[Element, () => void][]} what is shown, and what makes it as the session is */
  let shown = [];

  function keep(/** @type {Element} */ element, /** @type {() => void} */ show) {
    shown.push([element, show]);
    show();
    return element;
  }

  /** A parameter, or what the terrain has. */
  function rowOf(/** @type {Shown} */ one) {
    const label = one.pass ? one.label : words[one.label];
    return labelled(one, label);
  }

  function labelled(/** @type {Shown} */ one, /** @type {string} */ label) {
    const row = makeRow({ ...one, label }, label, {
      words,
      changed: (value) => session.set(one.path, value),
      reset: () => session.reset(one.path),
      press: (down) => session.press(one.path, down),
    });
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

  /** Rows by their groups, those without one first. @param {Shown[]} items */
  function groups(items) {
    const sorted = grouped(items, (row) => row.group), first = sorted.get("") ?? [];
    sorted.delete("");
    const headed = [...sorted].flatMap(([group, inside]) => [
      make("h3", {}, group), ...inside.map(rowOf),
    ]);
    return [...first.map(rowOf), ...headed];
  }

  return {
    keep, rowOf, labelled, groups,
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
