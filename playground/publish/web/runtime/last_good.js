// last_good.js -- which edited texts worked, and which is being tried: kept over a reload of the tab.
//
// A loop without end may take the tab with it. So what is tried is written down before it is compiled, and
// once its picture is there it counts as good: what is found as tried after a reload did not get that far.

/** @typedef {Object<string, string>} Texts */
/** @typedef {{file: string, text: string}} Tried */
/** @typedef {ReturnType<typeof createGuard>} Guard */

/** Where texts are kept: in the tab's storage, in its name where that is refused, or nowhere.
 *  @typedef {"storage" | "name" | ""} Place */

const MAX_LETTERS = 2_000_000; // characters

/** Make what keeps the texts of a page.
 *  @param {string} key                          of the sketch: see keyOf
 *  @param {{storage?: Storage | null, tab?: {name: string} | null}} [places]  other than the tab's own */
export function createGuard(key, places = {}) {
  const storage = places.storage === undefined ? ownStorage() : places.storage;
  const tab = places.tab === undefined ? globalThis.window ?? null : places.tab;
  const name = `playground ${key}`;
  let place = /** @type {Place} */ (storage ? "storage" : tab ? "name" : "");
  /** @type {Tried | null} */
  let left = null;
  /** @type {Texts} */
  let good = {};

  /** @param {unknown} value */
  function write(value) {
    const text = value ? JSON.stringify(value) : "";
    if (text.length > MAX_LETTERS) return;
    if (place === "storage" && storage) {
      try {
        if (text) storage.setItem(name, text);
        else storage.removeItem(name);
        return;
      } catch {
        place = tab ? "name" : "";
      }
    }
    if (place === "name" && tab && (text || tab.name.startsWith(name))) tab.name = text && `${name} ${text}`;
  }

  function read() {
    try {
      const text = place === "storage" ? storage?.getItem(name)
        : tab?.name.startsWith(`${name} `) ? tab.name.slice(name.length + 1) : "";
      const found = JSON.parse(text || "{}");
      good = plainTexts(found.good);
      const { file, text: tried } = found.tried ?? {};
      if (typeof file === "string" && typeof tried === "string") left = { file, text: tried };
    } catch {
      good = {}; // what is there is not ours
    }
  }

  read();
  return {
    /** Where texts are kept. */
    get place() { return place; },
    /** The texts that worked before this page was loaded; those of files that it edits. */
    get good() { return good; },
    /** The text that was being tried when the page was closed; null: none. */
    get left() { return left; },
    /** A text is about to be compiled and drawn.
     *  @param {string} file @param {string} text @param {Texts} texts  that work so far */
    trying(file, text, texts) {
      good = { ...texts };
      left = { file, text };
      write({ good, tried: left });
    },
    /** The picture of these texts is there. @param {Texts} texts */
    worked(texts) {
      good = { ...texts };
      left = null;
      write(Object.keys(good).length ? { good } : null);
    },
    /** What was tried is given up; what worked stays. */
    forget() {
      left = null;
      write(Object.keys(good).length ? { good } : null);
    },
  };
}

/** A key for a sketch's texts: those of another version of the page are not taken for this one's.
 *  @param {string} name of the sketch @param {Texts} files
 *  @returns {string} */
export function keyOf(name, files) {
  let hash = 0x811c9dc5; // FNV-1a, 32 bits
  for (const file of Object.keys(files).sort()) {
    for (const character of `${file}\0${files[file]}\0`) {
      hash = Math.imul(hash ^ /** @type {number} */ (character.codePointAt(0)), 0x01000193);
    }
  }
  return `${name} ${(hash >>> 0).toString(16).padStart(8, "0")}`;
}

/** @param {unknown} value @returns {Texts} */
function plainTexts(value) {
  const pairs = value && typeof value === "object" ? Object.entries(value) : [];
  return Object.fromEntries(pairs.filter(([, text]) => typeof text === "string"));
}

/** The tab's storage; null where the browser refuses it, as it may for a file.
 *  @returns {Storage | null} */
function ownStorage() {
  try {
    const { sessionStorage } = globalThis;
    sessionStorage.setItem("playground", "");
    sessionStorage.removeItem("playground");
    return sessionStorage;
  } catch {
    return null;
  }
}
