// page_code.js -- the code of a sketch's page: the editor, and what keeps its texts.

import { finished } from "./context.js";
import { createEditor } from "./editor.js";
import { createGuard, createRecovery, keyOf } from "./recovery.js";

/** @import { Editor } from "./editor.js"
 *  @import { Engine } from "./engine.js"
 *  @import { Player } from "./player.js"
 *  @import { Session } from "./session.js" */

/** What is asked of a figure: see figure.js.
 *  @typedef {{session: Session, ask: () => void, player: any, showPoster: (still: boolean) => void,
 *             redraw: () => Promise<unknown>, shrink: (pixels: number) => void}} CodeFigure */

const LIMIT = 10; // [s] a picture may take without a question: it is made in pieces, which no browser stops

/** @typedef {ReturnType<typeof createCode>} Code */

/** Make the code of a page whose pictures an engine draws; sentences on what fails appear in a host.
 *  @param {Engine} engine @param {HTMLElement} host
 *  @param {{words: Object<string, string>, figure: () => CodeFigure}} options */
export function createCode(engine, host, { words, figure }) {
  /** @type {Map<string, import("./recovery.js").Guard>} by sketch */
  const guards = new Map();
  /** @type {Editor | null} */
  let editor = null;
  let asked = false;

  /** @param {Player} player */
  function guardOf({ sketch, shared }) {
    const key = keyOf(sketch.name, shared.files), guard = guards.get(key) ?? createGuard(key);
    guards.set(key, guard);
    return guard;
  }

  /** @param {Player} player */
  function recoveryOf(player) {
    const poster = (/** @type {boolean} */ still) => figure().showPoster(still);
    const reopen = (/** @type {string} */ text, /** @type {string} */ file) => {
      editor?.open(file);
      editor?.put(text);
    };
    return createRecovery(host, { words, poster, guard: () => guardOf(player), reopen });
  }

  /** Wait until a picture with what was edited has been drawn to its end, wherever the page is scrolled.
   *  @param {Player} player */
  async function shown(player) {
    await player.renderSoon();
    await finished(engine.parts.context.gl);
    figure().ask();
  }

  /** Ask, once in a page, whether fewer pixels will do. @param {Player} player */
  async function paced(player) {
    if (asked) return;
    const { gl } = engine.parts.context;
    const asks = createRecovery(host, { words, poster: () => {}, limit: LIMIT });
    try {
      const smaller = await asks.pace(player, () => finished(gl), () => { asked = true; });
      if (smaller) figure().shrink(smaller[0] * smaller[1]);
    } catch {
      // What takes some sizes only, or cannot be drawn, says so with its own picture.
    }
  }

  return {
    /** Before a player's first picture: go on with texts that worked before a reload, and ask where a picture
     *  will take too long.
     *  @param {Player} player */
    async prepare(player) {
      await recoveryOf(player).resume(player);
      await paced(player);
    },

    /** Fill the tab of the code. @param {HTMLElement} tab @param {Player} player */
    open(tab, player) {
      editor?.close();
      editor = createEditor(tab, player, {
        words, guard: guardOf(player), shown: () => shown(player),
      });
      return editor;
    },

    /** Make the picture again when the engine's context comes back after a loss; returns what ends it. */
    watch() {
      const { canvas } = engine, player = () => figure().player;
      const restore = async () => {
        await engine.restore();
        await figure().redraw();
      };
      const poster = (/** @type {boolean} */ still) => figure().showPoster(still);
      const guard = () => (player() ? guardOf(player()) : undefined);
      return createRecovery(host, { words, poster, guard }).watch(canvas, { player, restore });
    },
  };
}
