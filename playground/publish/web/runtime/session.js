// session.js -- what a user has made of a sketch: values, terrain, time, camera, steps to undo; no page.

import { fits } from "./numbers.js";

/** @import { Camera, Shown, Sketch, Value } from "./schema.js" */

/** What can be undone: which sketch, values over its own by path of a row, repeats stopped early by path.
 *  @typedef {{index: number, edits: Map<string, Value>, steps: Map<string, number>}} Step */
/** @typedef {{path: string, output: string, values: Object<string, Value>}} MapShown */
/** @typedef {"values" | "sketch" | "camera" | "time" | "map" | "rows"} News */
/** @typedef {ReturnType<typeof createSession>} Session */

const TERRAIN = ["size", "extent", "relief", "base_elevation"];
const AT_ONCE = 800; // [ms] changes of one row that follow each other so closely are undone together
const MAX_UNDO_STEPS = 500; // steps that can be undone

/** Rows for the terrain itself, like those of parameters: its size, extent, relief, base elevation.
 *  @param {Sketch} sketch @returns {Shown[]} */
export function terrainRows(sketch) {
  const { terrain } = sketch;
  /** @type {(name: "size" | "extent" | "relief" | "base_elevation", type: string, unit: string) => Shown} */
  const row = (name, type, unit) => {
    const value = terrain[name],
      all = Array.isArray(value) ? value : [value];
    const spans =
      name === "size"
        ? all.map((n) => [Math.min(16, n), Math.max(2049, n)])
        : all.map((n) => [n / 10, n * 10]);
    const ranged = name !== "base_elevation" && all.every((n) => n > 0);
    return {
      path: name,
      pass: "",
      label: name,
      type,
      unit,
      group: "",
      description: "",
      choices: [],
      step: null,
      widget: ranged ? "log_slider" : "number",
      parts: type.endsWith("2") ? ["east", "north"] : [],
      ranges: /** @type {[number, number][]} */ (ranged ? spans : []),
      exported: true,
      main: 0,
      locked: name === "size" ? terrain.locked : (terrain.lockedMetres?.[name] ?? ""),
      value,
      targets: [],
    };
  };
  return [
    row("size", "ivec2", ""),
    row("extent", "vec2", "m"),
    row("relief", "float", "m"),
    row("base_elevation", "float", "m"),
  ];
}

/** @param {Value} a @param {Value | undefined} b */
const same = (a, b) =>
  a === b || (Array.isArray(a) && Array.isArray(b) && a.every((part, at) => part === b[at]));

/** Make the session of a page's sketches; it begins with one of them.
 *  @param {Sketch[]} sketches @param {number} [first] */
export function createSession(sketches, first = 0) {
  /** @type {Step} */
  let now = { index: first, edits: new Map(), steps: new Map() };
  /** @type {Step[]} */
  let before = [];
  /** @type {Step[]} */
  let after = [];
  /** @type {Map<string, Shown>} */
  let rows = new Map();
  /** @type {Map<string, Value>} */
  let leaves = new Map();
  /** @type {Map<string, boolean>} leaf → whether it is still held */
  const pressed = new Map();
  /** @type {Set<string>} leaves that the last state has pressed */
  let seen = new Set();
  /** @type {Set<(news: News) => void>} */
  const listeners = new Set();
  /** @type {Camera | null} */
  let camera = null;
  /** @type {MapShown | null} */
  let map = null;
  let time = sketches[first].time,
    interpolated = true,
    changing = "",
    changedAt = 0;

  const tell = (/** @type {News} */ news) => listeners.forEach((listener) => listener(news));
  const sketch = () => sketches[now.index];

  function take(/** @type {Step} */ step) {
    const news = rows.size === 0 || step.index !== now.index ? "sketch" : "values";
    now = step;
    if (news === "sketch")
      rows = new Map([...sketch().shown, ...terrainRows(sketch())].map((row) => [row.path, row]));
    leaves = new Map();
    for (const [path, value] of now.edits)
      for (const leaf of rows.get(path)?.targets ?? []) leaves.set(leaf, value);
    return news;
  }

  /** Make a step that can be undone. */
  function go(/** @type {Step} */ step, group = "") {
    const moment = Date.now();
    if (!group || group !== changing || moment - changedAt > AT_ONCE)
      before = [...before, now].slice(-MAX_UNDO_STEPS);
    [changing, changedAt, after] = [group, moment, []];
    tell(take(step));
  }

  function value(/** @type {string} */ path) {
    const row = rows.get(path);
    if (!row) throw new Error(`no parameter ${path}`);
    return (row.targets.length ? leaves.get(row.targets[0]) : now.edits.get(path)) ?? row.value;
  }

  /** Change some rows; a value that is the sketch's own is no edit, unless another edit covers it. */
  function edited(/** @type {Iterable<[string, Value]>} */ values) {
    const edits = new Map(now.edits);
    for (const [path, given] of values) {
      const row = rows.get(path);
      if (!row || row.locked || !fits(row, given)) continue;
      const inside = new Set(row.targets);
      for (const other of edits.keys()) {
        const targets = rows.get(other)?.targets ?? [];
        if (other === path || (targets.length && targets.every((leaf) => inside.has(leaf))))
          edits.delete(other);
      }
      const covered = [...edits.keys()].some((other) =>
        rows.get(other)?.targets.some((leaf) => inside.has(leaf)),
      );
      if (covered || !same(row.value, given)) edits.set(path, given);
    }
    return edits;
  }

  function back(/** @type {Step[]} */ from, /** @type {Step[]} */ to) {
    const step = from.pop();
    if (!step) return false;
    to.push(now);
    changing = "";
    tell(take(step));
    return true;
  }

  take(now);
  return {
    sketches,
    get sketch() {
      return sketch();
    },
    get index() {
      return now.index;
    },
    get edits() {
      return now.edits;
    },
    get steps() {
      return now.steps;
    },
    get time() {
      return time;
    },
    get camera() {
      return camera;
    },
    get map() {
      return map;
    },
    get interpolated() {
      return interpolated;
    },
    set interpolated(/** @type {boolean} */ wanted) {
      interpolated = wanted;
      tell("values");
    },
    get canUndo() {
      return before.length > 0;
    },
    get canRedo() {
      return after.length > 0;
    },
    rows: () => [...rows.values()],
    row: (/** @type {string} */ path) => rows.get(path),
    value,
    changed: (/** @type {string} */ path) => !same(value(path), rows.get(path)?.value),
    anyChanged: () => now.edits.size > 0 || now.steps.size > 0 || now.index !== first,

    /** @param {string} path @param {Value} given what fits; else nothing happens */
    set: (path, given) => go({ ...now, edits: edited([[path, given]]) }, path),
    /** As one step; changes of one `group` that follow each other closely are one step too.
     *  @param {Iterable<[string, Value]>} values @param {string} [group] */
    setAll: (values, group) => go({ ...now, edits: edited(values) }, group),
    /** @param {string[]} paths */
    reset: (...paths) =>
      go({ ...now, edits: edited(paths.map((path) => [path, /** @type {Shown} */ (rows.get(path)).value])) }),
    resetAll: () => go({ index: first, edits: new Map(), steps: new Map() }),
    /** The next change is a step of its own. */
    settle: () => {
      changing = "";
    },
    undo: () => back(before, after),
    redo: () => back(after, before),

    /** Show another of the sketches, with the values that it has as well. @param {number} index */
    choose(index) {
      if (index === now.index || !sketches[index]) return;
      const known = new Map(sketches[index].shown.map((row) => [row.path, row]));
      const edits = new Map(
        [...now.edits].filter(([path, given]) => {
          const row = known.get(path);
          return TERRAIN.includes(path) || (row && !row.locked && fits(row, given));
        }),
      );
      map = null;
      go({ index, edits, steps: new Map() });
    },
    /**
     * Stop a repeat early, unless that is locked; null: not at all.
     * @param {string} path
     * @param {number | null} count
     */
    stop(path, count) {
      if (sketch().passes[path]?.locked) return;
      const steps = new Map(now.steps);
      if (count === null) steps.delete(path);
      else steps.set(path, count);
      go({ ...now, steps }, `step ${path}`);
    },
    /** A button is held, or let go. @param {string} path @param {boolean} down */
    press(path, down) {
      for (const leaf of rows.get(path)?.targets ?? [])
        if (down || pressed.has(leaf)) pressed.set(leaf, down);
      tell("values");
    },
    /** A frame was drawn: what it saw and was let go of is pressed no longer; returns whether that asks for
     *  another. What was pressed while it was being made waits for the next. */
    drawn() {
      const gone = [...pressed].filter(([leaf, down]) => !down && seen.has(leaf));
      gone.forEach(([leaf]) => pressed.delete(leaf));
      return gone.length > 0;
    },
    setCamera(/** @type {Camera | null} */ wanted) {
      camera = wanted;
      tell("camera");
    },
    setTime(/** @type {number} */ seconds) {
      time = Math.max(seconds, 0);
      tell("time");
    },
    setMap(/** @type {MapShown | null} */ wanted) {
      map = wanted;
      tell("map");
    },
    /** Call a function at every change; returns one that ends it. @param {(news: News) => void} listener */
    follow(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },

    /** The sketch has other rows now: what was set and still fits stays. */
    renew() {
      const fitting = (/** @type {Step} */ step) => {
        const edits = [...step.edits].filter(([path, given]) => {
          const row = rows.get(path);
          return row && !row.locked && fits(row, given);
        });
        return { ...step, edits: new Map(edits) };
      };
      rows = new Map([...sketch().shown, ...terrainRows(sketch())].map((row) => [row.path, row]));
      [before, after] = [before.map(fitting), after.map(fitting)];
      take(fitting(now));
      tell("rows");
    },

    /** What a player's state is to be, but for its frame. */
    state() {
      const values = Object.fromEntries(leaves);
      seen = new Set(pressed.keys());
      for (const leaf of seen) values[leaf] = true;
      const { size, extent, relief, base_elevation } = sketch().terrain;
      /** @type {Object<string, any>} */
      const terrain = { size, extent, relief, base_elevation };
      for (const name of TERRAIN) if (now.edits.has(name)) terrain[name] = now.edits.get(name);
      return {
        values,
        terrain,
        camera,
        time,
        map,
        interpolated,
        steps: { ...sketch().steps, ...Object.fromEntries(now.steps) },
      };
    },
    /** Take up what a link says, as the beginning.
     *  @param {import("./address.js").Link} link */
    begin(link) {
      if (sketches[link.index]) take({ index: link.index, edits: new Map(), steps: new Map() });
      now = { ...now, edits: edited(link.values) };
      take(now);
      camera = link.camera;
      time = link.time ?? sketch().time;
      tell("sketch");
    },
  };
}
