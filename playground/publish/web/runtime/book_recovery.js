// book_recovery.js -- when the one context of many figures is lost: each stands still, says why, and goes on.

import { bookWords } from "./book_words.js";
import { createRecovery } from "./recovery.js";

/** @typedef {import("./figure.js").Figure} Figure */
/** @typedef {import("./last_good.js").Guard} Guard */
/** @typedef {ReturnType<typeof createBookRecovery>} BookRecovery */

/** What keeps the texts of an editor, and what puts one back into it.
 *  @typedef {{guard?: Guard, reopen?: (text: string, file: string) => void}} Edits */

/** What a live block has of it.
 *  @typedef {object} Watched
 *  @property {import("./recovery.js").Recovery} recovery
 *  @property {(figure: Figure) => void} add   a figure whose picture is to come back
 *  @property {(edits: Edits) => void} edit    the block has an editor
 *  @property {() => void} end */

/** Watch an engine whose figures are in several places of a page.
 *  @param {import("./engine.js").Engine} engine @param {string} language */
export function createBookRecovery(engine, language) {
  /** @type {Promise<void> | null} all wait for the same */
  let restoring = null;
  const restore = () => {
    restoring ??= engine.restore().finally(() => { restoring = null; });
    return restoring;
  };

  return {
    /** Watch for a block; sentences appear in its element.
     *  @param {HTMLElement} host @returns {Watched} */
    watch(host) {
      /** @type {Edits} */
      let edits = {};
      /** @type {Figure[]} */
      const figures = [];
      const poster = (/** @type {boolean} */ still) => {
        for (const figure of figures) {
          figure.showPoster(still);
          if (!still) figure.ask();
        }
      };
      const recovery = createRecovery(host, {
        words: bookWords(language), poster, guard: () => edits.guard,
        reopen: (text, file) => edits.reopen?.(text, file),
      });
      const player = () => /** @type {any} */ (figures[0]?.player ?? null);
      const end = recovery.watch(engine.canvas, { restore, player });
      return {
        recovery, end,
        add: (figure) => { figures.push(figure); },
        edit: (made) => { edits = made; },
      };
    },
  };
}
