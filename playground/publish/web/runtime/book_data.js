// book_data.js -- what a book's scripts hold: lessons, what all share, bytes; each loaded when it is needed.
//
// A page that is opened from disk may fetch nothing, but it may add scripts. Each of the book's says
//     (globalThis.bookData ??= {})["NAME"] = "gzip in base64";

import { unpackedJson } from "./packed.js";

/** @import { Kernel, Leaf, Shared, Sketch, Value } from "./schema.js" */

/** A scene: one of a lesson's sketches, and what it sets of that. See course/book/live.py.
 *  @typedef {object} Setting
 *  @property {number} sketch
 *  @property {import("./schema.js").Terrain} [terrain]
 *  @property {import("./schema.js").Camera} [camera]
 *  @property {[number, number]} [frame]
 *  @property {number} [time]
 *  @property {Object<string, number>} [steps]
 *  @property {Object<string, Value>} [values]
 *  @property {Object<string, Value>} [shown]       by the paths of the rows
 *  @property {Object<string, Leaf["data"]>} [data] by the paths of sources */

/** What a page can run of a lesson's block. See course/book/live.py.
 *  @typedef {object} LiveBlock
 *  @property {"figure" | "steps" | "slider" | "compare" | "break" | "exercise"
 *            | "challenge"} kind
 *  @property {Setting[]} scenes
 *  @property {string[]} [rows]         of the panel, by path
 *  @property {string[]} [passes]       of steps: stopped together
 *  @property {number[]} [iterations]
 *  @property {string} [row]            of a slider between whose values there are others
 *  @property {Value[]} [values]
 *  @property {string} [file]           of a break, or that a reader writes
 *  @property {string} [starter]        what a reader begins from
 *  @property {string} [answer]
 *  @property {import("./work_check.js").PageCheck[]} [checks]
 *  @property {number} [elsewhere]      checks that no page can do
 *  @property {number} [goal]           score of a challenge
 *  @property {number} [first]          its lines before those with the bug
 *  @property {number} [rest]           and after them
 *  @property {number} [indent]         blanks that those do not show
 *  @property {string} [broken]
 *  @property {Setting} [begin]         of an exercise or a challenge */

/** @typedef {Omit<Sketch, "kernels"> & {kernels: number[]}} Stored  its kernels are numbers in the book */
/** @typedef {{sketches: Stored[], blocks: Object<string, LiveBlock>,
 *             blobs: Object<string, string>}} LessonData */
/** say: by language, what is said of works that are checked.
 *  @typedef {Shared & {kernels: Kernel[], say: Object<string, Object<string, string>>}} Library */

/** A scene as a sketch of its own.
 *  @param {Stored} base @param {Setting} setting @param {Kernel[]} kernels @returns {Sketch} */
export function settled(base, setting, kernels) {
  const { sketch: _, values = {}, shown = {}, data = {}, ...whole } = setting;
  return {
    ...base, ...whole,
    kernels: base.kernels.map((number) => kernels[number]),
    values: { ...base.values, ...values },
    shown: base.shown.map((row) => (row.path in shown ? { ...row, value: shown[row.path] } : row)),
    nodes: base.nodes.map((node) => (node.path in data ? { ...node, data: data[node.path] } : node)),
  };
}

/** The keys of the bytes that a sketch needs: what its sources give, and its images.
 *  @param {Sketch} sketch @param {Pick<Shared, "images">} shared @returns {string[]} */
function blobsOf(sketch, shared) {
  const made = sketch.nodes.flatMap((node) => ("data" in node && node.data ? node.data : []));
  const images = Object.values(sketch.values).flatMap((value) => {
    const image = typeof value === "string" && Object.hasOwn(shared.images, value) && shared.images[value];
    return image ? [image.blob] : [];
  });
  return [...new Set([...made.map(({ blob }) => blob), ...images])];
}

/** Read the scripts of a book; each is loaded once. @param {string} folder  of the book, from the page */
export function openBook(folder) {
  /** @type {Map<string, Promise<string>>} */
  const texts = new Map();
  /** @type {Map<string, Promise<any>>} */
  const parsed = new Map();

  /** The text that a script holds. @param {string} name @returns {Promise<string>} */
  function text(name) {
    let found = texts.get(name);
    if (!found) texts.set(name, (found = read(name)));
    found.catch(() => texts.delete(name)); // to be tried again
    return found;
  }

  /** @param {string} name */
  async function read(name) {
    const script = document.createElement("script");
    script.src = `${folder}/${name}.js`;
    await new Promise((resolve, reject) => {
      script.onload = resolve;
      script.onerror = () => reject(new Error(`${name}.js`));
      document.head.append(script);
    });
    script.remove();
    const all = /** @type {any} */ (globalThis).bookData, found = all?.[name];
    if (typeof found !== "string") throw new Error(`${name}.js`);
    delete all[name];
    return found;
  }

  /** @param {string} name */
  async function json(name) {
    if (!parsed.has(name)) parsed.set(name, text(name).then(unpackedJson));
    const found = /** @type {Promise<any>} */ (parsed.get(name));
    found.catch(() => parsed.delete(name));
    return found;
  }

  return {
    /** @returns {Promise<Library>} */
    async library() {
      const found = await json("glsl");
      found.blobs ??= {};
      return found;
    },
    /** @param {string} name @returns {Promise<LessonData>} */
    lesson: (name) => json(`data/${name}`),
    /** Load the bytes that sketches need into what they share, but for those that are there.
     *  @param {Library} library @param {Sketch[]} sketches */
    async need(library, sketches) {
      const keys = new Set(sketches.flatMap((sketch) => blobsOf(sketch, library)));
      await Promise.all([...keys].map(async (key) => { library.blobs[key] ??= await text(`data/${key}`); }));
    },
  };
}
