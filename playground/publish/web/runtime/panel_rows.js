// panel_rows.js -- the rows of a panel: made when they are first looked at, kept as the session is.

import { makeRow, whyLocked } from "./controls.js";
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
