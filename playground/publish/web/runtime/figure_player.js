// figure_player.js -- the player of a figure: opened for its sketch, and made ready for what is asked next.

import { fill } from "./words.js";

/** @typedef {import("./figure.js").Player} Player */

/** Of the figure.
 *  @typedef {object} Holder
 *  @property {import("./figure.js").Engine} engine
 *  @property {import("./session.js").Session} session
 *  @property {Object<string, string>} words
 *  @property {(text: string, error?: unknown) => void} tell
 *  @property {(to: Player) => unknown} takeState   gives a player the state of now
 *  @property {(player: Player) => unknown} [prepare]
 *  @property {(player: Player) => void} opened     it is there, its programs too
 *  @property {() => void} tellBusy                 `waits` or `isOpening` is another */

/** @param {Holder} holder */
export function holdPlayer({ engine, session, words, tell, takeState, prepare, opened, tellBusy }) {
  /** @type {Player | null} */
  let player = null;
  let opening = 0, asked = 0, loading = 0, isOpening = false, closed = false;

  const compiling = (/** @type {number} */ done, /** @type {number} */ all) =>
    tell(fill(words.compiling, { done, all }));

  /** Open a player for the sketch of now; the one before stays until it can draw. */
  async function open() {
    const mine = ++opening;
    isOpening = true;
    tellBusy();
    tell(words.loading);
    try {
      const made = engine.open(session.sketch);
      takeState(made);
      await made.load((done, all) => {
        if (mine === opening) compiling(done, all);
      });
      if (mine === opening) await prepare?.(made);
      if (mine !== opening || closed) return made.close();
      player?.close();
      player = made;
      isOpening = false;
      opened(made);
    } catch (error) {
      if (mine === opening) {
        isOpening = false;
        tell(words.failed, error);
        tellBusy();
      }
    }
    return undefined;
  }

  /** Compile what the state of now needs besides, and load its data; the last picture stays meanwhile. */
  async function more() {
    const from = player, mine = ++asked;
    if (!from) return;
    loading++;
    tellBusy();
    try {
      takeState(from);
      await from.load((done, all) => {
        if (mine === asked && done < all) compiling(done, all);
      });
    } catch (error) {
      if (mine === asked) tell(words.kept, error);
    } finally {
      loading--;
      tellBusy();
    }
  }

  return {
    open,
    more,
    get now() { return player; },
    /** Whether what is asked of the player cannot be drawn yet without waiting for a compiler. */
    get waits() { return loading > 0; },
    /** Whether a player for the sketch of now is on its way. */
    get isOpening() { return isOpening; },
    close() {
      closed = true;
      player?.close();
    },
  };
}
