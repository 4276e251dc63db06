// my_version.js -- the zip of "download my version": a sketch with all that was changed in a page.

import { copiesOf, isReached } from "./library_copies.js";
import { unpacked } from "./packed.js";
import { fill, shotText } from "./toml_fill.js";
import { shellWord, write } from "./value_text.js";
import { zip } from "./zip.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Shared} Shared */
/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./schema.js").Pack} Pack */

/** What was changed in a page.
 *  @typedef {object} Made
 *  @property {Object<string, string>} texts      edited files, by the page's names
 *  @property {Map<string, Value>} values         by path of a row, or of the terrain
 *  @property {Map<string, Shown>} rows           by path
 *  @property {Camera | null} camera              null: the sketch's
 *  @property {number} time
 *  @property {Map<string, number>} steps         repeats that are stopped early, by path
 *  @property {[number, number]} frame            pixels of the picture */

/** @typedef {Map<string, string | Uint8Array>} Files */

const SETTINGS = "settings.txt";

/** Return the files of the zip, by name.
 *  @param {Pack} pack @param {Sketch} sketch @param {Shared} shared @param {Made} made
 *  @returns {Promise<{files: Files, aside: string[]}>} aside: settings that its files have no place for */
export async function versionFiles(pack, sketch, shared, made) {
  const { folder, main } = pack, texts = changedTexts(made.texts, shared);
  /** @type {Files} */
  const files = new Map();
  /** @type {Map<string, string>} the page's name of a file → its name in the folder */
  const names = new Map();
  for (const [name, [kind, key]] of Object.entries(pack.files)) if (ofPage(kind)) names.set(key, name);
  const edited = Object.keys(texts).filter((file) => !names.has(file));
  const reached = edited.filter((file) => isReached(file, pack, shared));
  const lost = edited.filter((file) => !reached.includes(file)), copies = copiesOf(reached, pack, shared);
  const place = (/** @type {string} */ file) => names.get(file) ?? file.replace(/^\.\//, "");
  /** @param {string} from  where a technique is named */
  const use = (from) => (/** @type {string} */ of) => (copies.has(of) ? relative(from, place(of)) : null);
  /** @param {string} file  of the page, as it goes into the zip */
  const written = (file) => {
    const pieces = pack.techniques[file], nothing = { values: new Map(), rows: new Map(), camera: null };
    if (!pieces) return texts[file] ?? shared.files[file];
    return fill(pieces, { ...nothing, use: use(place(file)) }).text;
  };
  for (const [name, [kind, key]] of Object.entries(pack.files)) {
    const bytes = kind === "blob" ? new Uint8Array(await unpacked(shared.blobs[key])) : null;
    files.set(name, bytes ?? (ofPage(kind) ? written(key) : key));
  }
  for (const file of copies) files.set(place(file), written(file));
  for (const file of lost) {
    files.set(`page/${file.replace(/^\.\//, "").replace(/[^\w./-]+/g, "-")}`, texts[file]);
  }
  let aside = [...made.values.keys()];
  if (pack.toml) {
    const { text, left } = fill(pack.toml, { ...made, use: use(main) });
    files.set(main, text + shotOf(pack, sketch, made));
    aside = left;
  }
  if (aside.length || lost.length || pack.leftOut.length || (!pack.toml && isAtAnotherTime(made))) {
    files.set(SETTINGS, settings(pack, made, aside, lost));
  }
  const manifest = {
    format: pack.format, sketch: `${folder}/${main}`, version: pack.version,
    shipped: pack.shipped, ...(pack.libraries.length ? { libraries: pack.libraries } : {}),
  };
  /** @type {Files} */
  const all = new Map([[pack.manifest, `${JSON.stringify(manifest, null, 1)}\n`]]);
  for (const [name, data] of files) all.set(`${folder}/${name}`, data);
  return { files: all, aside: [...aside, ...lost] };
}

/** Whether a file of the zip is one that the page knows. @param {string} kind */
const ofPage = (kind) => kind === "file" || kind === "pieces";

/** Save the zip under a name, as a browser does with what is downloaded.
 *  @param {Files} files @param {string} name */
export async function download(files, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([await zip(files)], { type: "application/zip" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** Without those that say the same as before. @param {Object<string, string>} texts @param {Shared} shared */
function changedTexts(texts, shared) {
  return Object.fromEntries(Object.entries(texts).filter(([file, text]) => text !== shared.files[file]));
}

/** How a technique is named in the folder of the sketch: "./generation/fbm", from the folder of a file.
 *  @param {string} from  the file that names it @param {string} file @returns {string} */
function relative(from, file) {
  const up = from.split("/").slice(0, -1), to = file.replace(/\.[^./]+$/, "").split("/");
  while (up.length && up[0] === to[0]) [up, to].forEach((parts) => parts.shift());
  return `./${[...up.map(() => ".."), ...to].join("/")}`;
}

/** A shot of the page's time, and of what keyframes would steer otherwise; "" where there is nothing of it.
 *  @param {Pack} pack @param {Sketch} sketch @param {Made} made @returns {string} */
function shotOf(pack, sketch, made) {
  const steered = sketch.tracks.length > 0;
  if (!isAtAnotherTime(made) && !(steered && (made.values.size || made.camera))) return "";
  let name = "page";
  for (let number = 2; pack.shots.includes(name); number++) name = `page-${number}`;
  const { frame, time, steps, rows } = made;
  const values = steered ? made.values : new Map();
  return shotText(name, { size: frame, time, steps, camera: steered ? made.camera : null, values, rows });
}

/** @param {Made} made */
const isAtAnotherTime = (made) => made.time !== 0 || made.steps.size > 0;

/** What the sketch's files have no place for: settings as the command line takes them, texts by name.
 *  @param {Pack} pack @param {Made} made @param {string[]} aside @param {string[]} lost @returns {string} */
function settings(pack, made, aside, lost) {
  const words = aside.map((path) => {
    const row = made.rows.get(path), value = made.values.get(path);
    const text = row && value !== undefined ? write(row, value) : String(value);
    return `--set ${shellWord(`${path}=${text}`)}`;
  });
  if (!pack.toml && made.time) words.push(`--time ${made.time}`);
  const steps = pack.toml ? [] : [...made.steps];
  words.push(...steps.map(([path, count]) => `--steps ${shellWord(`${path}=${count}`)}`));
  const lines = words.length ? [`playground render ${pack.main} ${words.join(" ")}`] : [];
  lines.push(...lost.map((file) => `${file}: its text is in the folder page, where no pass reads it`));
  const parts = [];
  if (lines.length) parts.push(`What was changed in the page, and has no place in ${pack.main}:\n`, ...lines);
  if (pack.leftOut.length) {
    parts.push("Files that are too large for a page, which the sketch needs here as well:", ...pack.leftOut);
  }
  return `${parts.join("\n")}\n`;
}
