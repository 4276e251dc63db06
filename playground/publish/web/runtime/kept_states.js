// kept_states.js -- keeps some earlier states of loops that follow the time, so that it may go back.
//
// A state is what a loop feeds back after some of its iterations. States are dense close to the present
// and ever
// sparser away from it: the one that goes first is the one without which the longest run, measured by how far
// away it is, grows least. Results do not depend on what is kept.

/** @typedef {Map<string, import("./textures.js").Result>} State  by the path of the step that computed it */
/** @typedef {{now: number, states: Map<number, State>}} Kept  the states of one key, by iterations done */

const MAX_STATES = 48; // of one loop
const MAX_KEYS = 2; // of one loop's path

/** @param {number} limit bytes @param {import("./textures.js").Textures} textures */
export const createKeptStates = (limit, textures) => {
  /** @type {Map<string, Map<string, Kept>>} */
  const known = new Map();

  /** @param {State} state */
  const weight = (state) => sum([...state.values()].map(textures.bytesOf));
  /** @param {Kept} kept */
  const weightOf = (kept) => sum([...kept.states.values()].map(weight));
  const every = () => [...known.values()].flatMap((keys) => [...keys.values()]);

  /** @param {Kept} kept @param {number} number */
  const pop = (kept, number) => {
    const state = /** @type {State} */ (kept.states.get(number));
    kept.states.delete(number);
    return state;
  };

  /** @param {State} state */
  const give = (state) => state.forEach(textures.give);

  /** Return the state that is missed least. @param {Kept} kept */
  const least = ({ now, states }) => {
    const numbers = [...states.keys()].sort((a, b) => a - b);
    const costs = numbers.map((number, i) => {
      const before = i ? numbers[i - 1] : 0, after = numbers[i + 1] ?? Math.max(now, number);
      return (after - before) / (Math.abs(now - number) + 1);
    });
    return numbers[costs.indexOf(Math.min(...costs))];
  };

  /** Drop the state that is missed least, of the loop whose states are largest; return whether there was
   *  one. */
  const thin = () => {
    const largest = every().filter(({ states }) => states.size).sort((a, b) => weightOf(b) - weightOf(a))[0];
    if (largest) give(pop(largest, least(largest)));
    return !!largest;
  };

  return {
    get bytes() { return sum(every().map(weightOf)); },
    thin,

    /** Return the most iterations, up to `most`, after which there is a state; 0 for none.
     *  @param {string} path @param {string} key @param {number} most */
    latest: (path, key, most) => {
      const numbers = [...(known.get(path)?.get(key)?.states.keys() || [])];
      return Math.max(0, ...numbers.filter((number) => number <= most));
    },

    /** Hand over a state that there is. @param {string} path @param {string} key @param {number} number */
    take: (path, key, number) => pop(/** @type {Kept} */ (known.get(path)?.get(key)), number),

    /** Take over a state after some iterations; `now` are those that are wanted.
     *  @param {string} path @param {string} key @param {number} number @param {State} state
     *  @param {number} now */
    keep: (path, key, number, state, now) => {
      const keys = known.get(path) || new Map(), kept = keys.get(key) || { now, states: new Map() };
      known.set(path, keys);
      keys.delete(key);
      keys.set(key, kept);
      const oldest = keys.keys().next().value;
      if (keys.size > MAX_KEYS) {
        keys.get(oldest).states.forEach(give);
        keys.delete(oldest);
      }
      kept.now = now;
      if (kept.states.has(number)) give(pop(kept, number));
      kept.states.set(number, state);
      if (kept.states.size > MAX_STATES) give(pop(kept, least(kept)));
      while (sum(every().map(weightOf)) > limit && thin());
    },

    clear: () => {
      every().forEach(({ states }) => states.forEach(give));
      known.clear();
    },
  };
};

/** @param {number[]} numbers */
const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);
