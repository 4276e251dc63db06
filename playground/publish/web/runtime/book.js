// book.js -- the entry of a book's pages: starts a figure where a reader asks for it.

import { openBook, settled } from "./book_data.js";
import { liveChallenge, liveExercise } from "./book_exercise.js";
import { createBookRecovery, liveFigure } from "./book_figure.js";
import { liveCompare, liveSlider, liveSteps } from "./book_series.js";
import { liveBreak } from "./book_text.js";
import { bookWords } from "./book_words.js";
import { make } from "./dom.js";
import { createEngine } from "./engine.js";
import { lackOf } from "./recovery.js";

/** @import { Room } from "./book_figure.js" */

/** @type {Object<string, (room: Room) => Promise<unknown>>} */
const KINDS = {
  figure: liveFigure, steps: liveSteps, slider: liveSlider, compare: liveCompare, break: liveBreak,
  exercise: liveExercise, challenge: liveChallenge,
};

const BYTES = 192 * 2 ** 20; // of textures for all figures of a page: those seen last keep theirs

/** @type {ReturnType<typeof openBook> | null} */
let book = null;
/** @typedef {{engine: import("./engine.js").Engine,
 *             losses: import("./book_figure.js").BookRecovery}} Opened */
/** One context for all figures of the page. @type {Promise<Opened> | null} */
let opened = null;

/** @param {import("./book_data.js").Library} library */
async function engineFor(library) {
  const engine = createEngine(document.createElement("canvas"), library, { bytes: BYTES });
  return { engine, losses: createBookRecovery(engine, document.documentElement.lang) };
}

/** Start a block of a lesson in the place of its still pictures.
 *  @param {HTMLElement} root   with `data-block`, the block's name
 *  @param {string} folder @param {string} lesson */
export async function start(root, folder, lesson) {
  const language = document.documentElement.lang, words = bookWords(language);
  const still = /** @type {HTMLElement} */ (root.querySelector(".still"));
  const host = make("div", { className: "live" });
  root.querySelector(".live-failed")?.remove();
  let end = () => {};
  try {
    book ??= openBook(folder);
    const [library, data] = await Promise.all([book.library(), book.lesson(lesson)]);
    Object.assign(library.blobs, data.blobs);
    const block = data.blocks[root.dataset.block ?? ""];
    /** @param {import("./book_data.js").Setting} setting */
    const sketch = (setting) => settled(data.sketches[setting.sketch], setting, library.kernels);
    const sketches = block.scenes.map(sketch), begin = block.begin ? sketch(block.begin) : null;
    await book.need(library, [...sketches, ...(begin ? [begin] : [])]);
    const { engine, losses } = await (opened ??= engineFor(library));
    still.after(host);
    root.classList.add("is-live");
    const comma = /^fr/.test(language), watched = losses.watch(host);
    ({ end } = watched);
    const say = library.say[/^fr/.test(language) ? "fr" : "en"];
    await KINDS[block.kind]({ host, still, block, sketches, begin, engine, watched, words, say, comma });
  } catch (error) {
    opened &&= opened.catch(() => (opened = null, Promise.reject(error)));
    end();
    host.remove();
    root.classList.remove("is-live");
    const isFile = String(/** @type {any} */ (error)?.message).endsWith(".js");
    const text = lackOf(error, words, isFile ? words.missing : words.lacks);
    still.after(make("p", { className: "live-failed", role: "status" }, text));
  }
}
