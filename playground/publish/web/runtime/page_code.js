// page_code.js -- the code of a sketch's page: the editor, what keeps its texts, the version to download.

import { createEditor } from "./editor.js";
import { createGuard, keyOf } from "./last_good.js";
import { download, versionFiles } from "./my_version.js";
import { createRecovery } from "./recovery.js";
import { finished } from "./waiting.js";
import { fill } from "./words.js";

/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./player.js").Player} Player */
/** @typedef {import("./session.js").Session} Session */
/** @typedef {import("./editor.js").Editor} Editor */

/** What is asked of a figure: see figure.js.
 *  @typedef {{session: Session, ask: () => void, player: any, showPoster: (still: boolean) => void,
 *             redraw: () => Promise<unknown>, shrink: (pixels: number) => void}} CodeFigure */

const LIMIT = 10; // [s] a picture may take without a question: it is made in pieces, which no browser stops

/** @typedef {ReturnType<typeof createCode>} Code */

/** Make the code of a page whose pictures an engine draws; sentences on what fails appear in a host.
 *  @param {Engine} engine @param {HTMLElement} host
 *  @param {{words: Object<string, string>, figure: () => CodeFigure}} options */
export function createCode(engine, host, { words, figure }) {
  /** @type {Map<string, import("./last_good.js").Guard>} by sketch */
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

  /** @param {Player} player @param {Object<string, string>} texts @param {boolean} broken */
  async function saved(player, texts, broken) {
    const { sketch, shared } = player, { session } = figure(), { pack } = sketch;
    if (!pack) return words.noPack;
    const { edits: values, camera, time, steps } = session;
    const rows = new Map(session.rows().map((row) => [row.path, row]));
    try {
      const made = { texts, values, rows, camera, time, steps, frame: sketch.frame };
      const { files, aside } = await versionFiles(pack, sketch, shared, made);
      const name = `${pack.folder}-my-version.zip`;
      await download(files, name);
      const told = fill(broken ? words.withErrors : words.downloaded, { name });
      return aside.length ? `${told}. ${words.valuesAside}` : told;
    } catch (error) {
      return fill(words.versionFailed, { reason: error instanceof Error ? error.message : String(error) });
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
        download: player.sketch.pack ? (texts, broken) => saved(player, texts, broken) : undefined,
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
