// my_version.js -- the zip of "download my version": a sketch with all that was changed in a page.

import { fill, shotText } from "./toml_fill.js";
import { shellWord, write } from "./value_text.js";
import { through, zip } from "./zip.js";

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

/** Return the pack of a sketch; null where the page does not hold one.
 *  @param {Sketch} sketch @param {Shared} shared @returns {Promise<Pack | null>} */
export async function packOf(sketch, shared) {
  if (!sketch.pack) return null;
  return JSON.parse(new TextDecoder().decode(await unpacked(shared.blobs[sketch.pack])));
}

/** Return the files of the zip, by name.
 *  @param {Pack} pack @param {Sketch} sketch @param {Shared} shared @param {Made} made
 *  @returns {Promise<{files: Files, aside: string[]}>} aside: what the sketch's own files have no place for */
export async function versionFiles(pack, sketch, shared, made) {
  const { folder, main } = pack, texts = changedTexts(made.texts, shared);
  /** @type {Files} */
  const files = new Map();
  /** @type {Map<string, string>} the page's name of a file → its name in the folder */
  const names = new Map();
  for (const [name, [kind, key]] of Object.entries(pack.files)) if (ofPage(kind)) names.set(key, name);
  const copies = copiesOf(Object.keys(texts).filter((file) => !names.has(file)), pack, shared);
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
    files.set(name, ofPage(kind) ? written(key) : kind === "blob" ? await unpacked(shared.blobs[key]) : key);
  }
  for (const file of copies) files.set(place(file), written(file));
  let aside = [...made.values.keys()];
  if (pack.toml) {
    const { text, left } = fill(pack.toml, { ...made, use: use(main) });
    files.set(main, text + shotOf(pack, sketch, made));
    aside = left;
  }
  if (aside.length || (!pack.toml && (made.camera || isAtAnotherTime(made)))) {
    files.set(SETTINGS, settings(pack, made, aside));
  }
  const manifest = {
    format: pack.format, sketch: `${folder}/${main}`, version: pack.version,
    shipped: pack.shipped, ...(pack.libraries.length ? { libraries: pack.libraries } : {}),
  };
  /** @type {Files} */
  const all = new Map([[pack.manifest, `${JSON.stringify(manifest, null, 1)}\n`]]);
  for (const [name, data] of files) all.set(`${folder}/${name}`, data);
  return { files: all, aside };
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

/** The files that come along with edited ones of the library: what includes or uses them, and what those
 *  include by a name that leads elsewhere from the sketch's folder.
 *  @param {string[]} edited @param {Pack} pack @param {Pick<Shared, "includes">} shared
 *  @returns {Set<string>} */
export function copiesOf(edited, pack, shared) {
  const found = new Set(edited);
  for (let before = -1; before !== found.size;) {
    before = found.size;
    for (const [file, includes] of Object.entries(shared.includes)) {
      if (Object.values(includes).some((target) => found.has(target))) found.add(file);
    }
    for (const [file, pieces] of Object.entries(pack.techniques)) {
      const uses = pieces.some((piece) => typeof piece !== "string" && "use" in piece && found.has(piece.of));
      if (uses) found.add(file);
    }
    for (const file of [...found]) {
      const includes = Object.entries(shared.includes[file] ?? {});
      for (const [name, target] of includes) if (name !== target) found.add(target);
    }
  }
  const own = new Set(Object.values(pack.files).map(([, key]) => key));
  return new Set([...found].filter((file) => !own.has(file)));
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

/** What a file of a shader cannot hold, as the command line takes it.
 *  @param {Pack} pack @param {Made} made @param {string[]} aside @returns {string} */
function settings(pack, made, aside) {
  const words = aside.map((path) => {
    const row = made.rows.get(path), value = made.values.get(path);
    const text = row && value !== undefined ? write(row, value) : String(value);
    return `--set ${shellWord(`${path}=${text}`)}`;
  });
  if (made.time) words.push(`--time ${made.time}`);
  for (const [path, count] of made.steps) words.push(`--steps ${shellWord(`${path}=${count}`)}`);
  const command = ["playground render", pack.main, ...words].join(" ");
  return `What was set in the page, and has no place in ${pack.main}:\n\n${command}\n`;
}

/** @param {string} base64  of gzip @returns {Promise<Uint8Array>} */
function unpacked(base64) {
  return through(Uint8Array.from(atob(base64), (one) => one.charCodeAt(0)), new DecompressionStream("gzip"));
}
