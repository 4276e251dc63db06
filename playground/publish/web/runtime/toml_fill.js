// toml_fill.js -- fills the holes that Python left in a TOML text: values, techniques, keys that are new.

import { fromHex } from "./colours.js";
import { quoted, toml } from "./value_text.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./schema.js").Piece} Piece */

/** What a user has made of a sketch.
 *  @typedef {object} Changes
 *  @property {Map<string, Value>} values            by path of a row, or of the terrain
 *  @property {Camera | null} camera                 null: as it was
 *  @property {Map<string, Shown>} rows              by path
 *  @property {(of: string) => string | null} use    how a technique is named now; null: as before */

const TERRAIN = ["size", "extent", "relief", "base_elevation"];

/** Return the text with what was changed.
 *  @param {Piece[]} pieces @param {Changes} changes
 *  @returns {{text: string, left: string[]}} left: paths that the text has no place for */
export function fill(pieces, { values, camera, rows, use }) {
  const written = new Set();
  /** Names of one kind that the text has values of already.
   *  @param {"path" | "camera" | "terrain" | "aside"} kind */
  const has = (kind) => new Set(pieces.flatMap((piece) => {
    const found = typeof piece === "string" ? undefined : new Map(Object.entries(piece)).get(kind);
    return found === undefined ? [] : [found];
  }));
  const known = new Set([...has("path"), ...has("aside")]);
  const cameraHas = has("camera"), terrainHas = has("terrain");
  const view = camera ? cameraText(camera) : new Map();
  /** @param {string} into @returns {string[]} keys with their values */
  const added = (into) => {
    const keys = [...view].filter(([key]) => !cameraHas.has(key));
    if (into === "#camera") return keys.map((pair) => pair.join(" = "));
    return [...values].flatMap(([path, value]) => {
      const row = rows.get(path), terrain = TERRAIN.includes(path);
      const fits = into === "#terrain" ? terrain && !terrainHas.has(path)
        : !terrain && row?.pass === into && !known.has(path) && path.startsWith(`${into}.`);
      if (!fits) return [];
      written.add(path);
      const key = terrain ? path : keyText(path.slice(into.length + 1));
      return [`${key} = ${terrain || !row ? terrainText(value) : valueText(row, value)}`];
    });
  };
  const text = pieces.map((piece) => {
    if (typeof piece === "string") return piece;
    if ("aside" in piece) return "";
    if ("use" in piece) return use(piece.of) ?? piece.use;
    if ("camera" in piece) return view.get(piece.camera) ?? piece.was;
    if ("into" in piece) {
      const keys = added(piece.into);
      return keys.length ? piece.open + keys.join(piece.join) + piece.close : piece.was;
    }
    const path = "path" in piece ? piece.path : piece.terrain, value = values.get(path), row = rows.get(path);
    if (value === undefined) return piece.was;
    written.add(path);
    return "terrain" in piece ? terrainText(value) : row ? valueText(row, value) : piece.was;
  }).join("");
  return { text, left: [...values.keys()].filter((path) => !written.has(path)) };
}

/** @typedef {{size: [number, number], time: number, steps: Map<string, number>, camera: Camera | null,
 *             values: Map<string, Value>, rows: Map<string, Shown>}} PageShot */

/** A table of a shot, to be added at the end of a sketch's TOML.
 *  @param {string} name @param {PageShot} shot
 *  @returns {string} */
export function shotText(name, { size, time, steps, camera, values, rows }) {
  const lines = ["", "[[shot]]", `name = ${quoted(name)}`, `size = [${size.join(", ")}]`];
  if (time) lines.push(`time = ${numberText(time)}`);
  const inBraces = (/** @type {string[]} */ pairs) => `{ ${pairs.join(", ")} }`;
  if (steps.size) lines.push(`steps = ${inBraces([...steps].map(([path, n]) => `${quoted(path)} = ${n}`))}`);
  if (camera) lines.push(`camera = ${inBraces([...cameraText(camera)].map((pair) => pair.join(" = ")))}`);
  const pairs = [...values].map(([path, value]) => {
    const row = rows.get(path);
    return `${quoted(path)} = ${TERRAIN.includes(path) || !row ? terrainText(value) : valueText(row, value)}`;
  });
  if (pairs.length) lines.push(`set = ${inBraces(pairs)}`);
  return `${lines.join("\n")}\n`;
}

/** A value exactly: a colour in hexadecimal only where that says every digit of it.
 *  @param {Shown} row @param {Value} value @returns {string} */
function valueText(row, value) {
  const text = toml(row, value);
  if (row.widget !== "colour" || !text.startsWith('"#') || !Array.isArray(value)) return text;
  const there = fromHex(text.slice(1, -1), row.raw) ?? [];
  const same = value.every((part, at) => Math.fround(part) === Math.fround(there[at] ?? 1));
  return same ? text : `[${value.map(numberText).join(", ")}]`;
}

/** @param {Camera} camera @returns {Map<string, string>} */
function cameraText({ azimuth, elevation, distance, target, field_of_view }) {
  const found = new Map(Object.entries({ azimuth, elevation, distance, field_of_view })
    .map(([key, value]) => [key, numberText(value)]));
  if (target) found.set("target", `[${target.map(numberText).join(", ")}]`);
  return found;
}

/** Two equal sides as one number. @param {Value} value @returns {string} */
function terrainText(value) {
  if (!Array.isArray(value)) return String(value);
  return value[0] === value[1] ? String(value[0]) : `[${value.join(", ")}]`;
}

/** @param {number} number @returns {string} with a point, so that TOML reads it as a fraction */
const numberText = (number) => (/[.e]/.test(String(number)) ? String(number) : `${number}.0`);

/** @param {string} key @returns {string} in quotes where it is more than one bare word */
const keyText = (key) => (/^[A-Za-z0-9_-]+$/.test(key) ? key : quoted(key));
