// address.js -- what differs from a sketch, as the end of an address, read with care; as TOML; as words.

import { quoted, read, shellWord, toml, write } from "./numbers.js";
import { terrainRows } from "./session.js";

/** @import { Camera, Shown, Sketch, Value } from "./schema.js"
 *  @import { Session } from "./session.js" */

/** @typedef {{index: number, values: [string, Value][], camera: Camera | null, time: number | null,
 *             refused: string[]}} Link */

const MAX_LETTERS = 32768; // characters that are read
const CAMERA = 7; // numbers: azimuth, elevation, distance, target, field of view

/** @param {string} text what may stand unescaped stays readable */
const escaped = (text) => encodeURIComponent(text).replace(/%2C/g, ",").replace(/%2F/g, "/");

/** @param {string} text */
function unescaped(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return "";
  }
}

/** What differs, as text: "height.seed=3&camera=…"; "" where nothing does.
 *  @param {Session} session @param {{time: boolean}} options */
export function fragmentOf(session, { time }) {
  const found = session.index ? [`sketch=${session.index}`] : [];
  for (const [path, value] of session.edits) {
    const row = session.row(path);
    if (row) found.push(`${escaped(path)}=${escaped(write(row, value))}`);
  }
  const { camera } = session;
  if (camera) {
    const { azimuth, elevation, distance, target, field_of_view } = camera;
    const numbers = [azimuth, elevation, distance, ...(target ?? []), field_of_view];
    found.push(`camera=${numbers.map((number) => +number.toFixed(2)).join(",")}`);
  }
  if (time && session.time !== session.sketch.time) found.push(`time=${+session.time.toFixed(3)}`);
  return found.join("&");
}

/** Read what an address says; what is unknown, of another type or out of range is left out and listed.
 *  @param {string} fragment with or without its "#" @param {Sketch[]} sketches
 *  @param {(sketch: Sketch) => Shown[]} rowsOf @returns {Link} */
export function readFragment(fragment, sketches, rowsOf) {
  const pairs = fragment
    .replace(/^#/, "")
    .slice(0, MAX_LETTERS)
    .split("&")
    .filter(Boolean)
    .map((pair) => {
      const at = pair.indexOf("=");
      return at < 0 ? [unescaped(pair), ""] : [unescaped(pair.slice(0, at)), unescaped(pair.slice(at + 1))];
    });
  /** @type {Link} */
  const found = { index: 0, values: [], camera: null, time: null, refused: [] };
  const wanted = pairs.find(([name]) => name === "sketch");
  if (wanted && /^\d{1,3}$/.test(wanted[1]) && sketches[+wanted[1]]) found.index = +wanted[1];
  const sketch = sketches[found.index],
    rows = new Map(rowsOf(sketch).map((row) => [row.path, row]));
  for (const [name, text] of pairs) {
    const row = rows.get(name);
    const value = row && !row.locked ? read(row, text) : undefined;
    if (row && value !== undefined) found.values.push([name, value]);
    else if (name === "camera" && !row) found.camera = readCamera(text, sketch.camera);
    else if (name === "time" && !row && text && +text >= 0 && +text < 1e9) found.time = +text;
    else if (name !== "sketch") found.refused.push(name.slice(0, 80));
  }
  return found;
}

/** @param {string} text @param {Camera} usual @returns {Camera | null} */
function readCamera(text, usual) {
  const numbers = text.split(",").map(Number);
  if (
    ![CAMERA, CAMERA - 3].includes(numbers.length) ||
    !numbers.every((n) => Number.isFinite(n) && Math.abs(n) < 1e9)
  )
    return null;
  const [azimuth, elevation, distance] = numbers,
    field = numbers[numbers.length - 1];
  if (Math.abs(elevation) > 90 || distance < 0 || field < 1 || field > 170) return null;
  const target =
    numbers.length === CAMERA ? /** @type {[number, number, number]} */ (numbers.slice(3, 6)) : usual.target;
  return { azimuth, elevation, distance, target, field_of_view: field };
}

/** What is edited, as words of the command line: "--set height.seed=3 --set …".
 *  @param {Session} session */
export function asWords(session) {
  return listed(session)
    .map(([row, value]) => `--set ${shellWord(`${row.path}=${terrainText(row, value)}`)}`)
    .join(" ");
}

/** @param {Shown} row @param {Value} value as --set takes it: a size and an extent as 513x257 */
const terrainText = (row, value) =>
  row.targets.length ? write(row, value) : write(row, value).replace(",", "x");

/** What is edited, as a preset of the sketch's file.
 *  @param {Session} session @param {string} name */
export function asToml(session, name) {
  const lines = listed(session).map(([row, value]) => `${quoted(row.path)} = ${toml(row, value)}\n`);
  return `[[preset]]\nname = ${quoted(name)}\n[preset.set]\n${lines.join("")}`;
}

/** @param {Session} session @returns {[Shown, Value][]} */
function listed(session) {
  return [...session.edits].flatMap(([path, value]) => {
    const row = session.row(path);
    return row ? [/** @type {[Shown, Value]} */ ([row, value])] : [];
  });
}

// ── Keeps a page's address as its session is, and the session as the address says.

const SETTLED = 400; // [ms] without a change until the address says it

/** @param {Session} session @param {() => boolean} hasTime whether the time is one that a user has chosen
 *  @param {(names: string[]) => void} refused */
export function followAddress(session, hasTime, refused) {
  let settling = 0;
  const now = () => fragmentOf(session, { time: hasTime() });

  function write() {
    const text = now();
    try {
      history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
    } catch { /* the browser keeps the address of this page as it is */ }
  }

  function read() {
    /** @param {import("./schema.js").Sketch} sketch */
    const rowsOf = (sketch) => [...sketch.shown, ...terrainRows(sketch)];
    const link = readFragment(location.hash, session.sketches, rowsOf);
    session.begin(link);
    if (link.refused.length) refused(link.refused);
  }

  session.follow((news) => {
    if (news === "time" && !hasTime()) return;
    clearTimeout(settling);
    settling = setTimeout(write, SETTLED);
  });
  addEventListener("hashchange", () => {
    if (location.hash.slice(1) !== now()) read();
  });
  return {
    read,
    /** The page's address with what differs. */
    link: () => [location.href.split("#")[0], now()].filter(Boolean).join("#"),
  };
}
