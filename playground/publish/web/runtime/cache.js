// cache.js -- keeps the results of passes by key, under a budget; the least recently used goes first.

// ── Keeps some earlier states of loops that follow the time, so that it may go back.
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
const createKeptStates = (limit, textures) => {
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

// ── Keeps the results of passes by key, under a budget

/** The results of one pass, or of all passes of a loop after some iteration, by the pass's path;
 *  `cancel` ends the run that is at it.
 *  @typedef {{results: Map<string, import("./textures.js").Result>, iterations: number,
 *             cancel?: (() => void) | null}} Cached */
/** @typedef {ReturnType<typeof createCache>} Cache */

const MAX_RESULTS = 1024; // results of any size: a driver spends memory on each texture besides its texels
const VERSIONS = 4; // of one pass: whoever drags a slider comes back to none of them
const SHARE_OF_STATES = 4; // a quarter of the budget may be earlier states of loops

/** @param {number} limit bytes @param {import("./textures.js").Textures} textures */
export const createCache = (limit, textures) => {
  const states = createKeptStates(limit / SHARE_OF_STATES, textures);
  /** @type {Map<string, Cached>} in the order of their last use */
  const known = new Map();
  /** What runs that have not ended use: it stays. @type {Set<Set<string>>} */
  const pinned = new Set();
  /** How far a pass that may go on has come. @type {Map<string, [string, string, number]>} */
  const latest = new Map();

  /** @param {string} key */
  const isPinned = (key) => [...pinned].some((keys) => keys.has(key));

  /** @param {string} key */
  const drop = (key) => {
    known.get(key)?.results.forEach(textures.give);
    known.delete(key);
  };

  /** Of a pass that was just computed, drop the versions that were used least recently; a loop goes on in
   *  place. @param {Cached} cached */
  const dropVersions = (cached) => {
    if (cached.results.size !== 1 || cached.iterations) return;
    const [[path, { size }]] = cached.results;
    const versions = [...known].filter(([, { results, iterations }]) => {
      const other = results.size === 1 && !iterations ? results.get(path) : undefined;
      return other && other.size[0] === size[0] && other.size[1] === size[1];
    }).map(([key]) => key);
    const over = Math.max(versions.length - VERSIONS, 0);
    versions.filter((key) => !isPinned(key)).slice(0, over).forEach(drop);
  };

  const bytes = () => {
    let total = states.bytes;
    for (const { results } of known.values()) {
      for (const result of results.values()) total += textures.bytesOf(result);
    }
    return total;
  };

  /** Drop what was used least recently, then earlier states, until the budget holds. */
  const trim = () => {
    let now = bytes();
    for (const [key, { results }] of known) {
      if (now <= limit && known.size <= MAX_RESULTS) return;
      if (isPinned(key)) continue;
      for (const result of results.values()) now -= textures.bytesOf(result);
      drop(key);
    }
    while (bytes() > limit && states.thin());
  };

  return {
    states, pinned, isPinned, drop, trim,
    get bytes() { return bytes(); },
    get size() { return known.size; },

    /** @param {string} key @returns {Cached | undefined} */
    peek: (key) => known.get(key),

    /** Return what is known, as used now. @param {string} key @param {Set<string>} used */
    get: (key, used) => {
      const found = known.get(key);
      used.add(key);
      if (!found) return undefined;
      known.delete(key);
      known.set(key, found);
      return found;
    },

    /** Keep what was computed, and return it; what another run has computed meanwhile stays instead.
     *  @param {string} key @param {Cached} cached @param {Set<string>} used @returns {Cached} */
    put: (key, cached, used) => {
      const before = known.get(key), found = before || cached;
      if (before) cached.results.forEach(textures.give);
      known.set(key, found);
      used.add(key);
      dropVersions(found);
      trim();
      return found;
    },

    /** @param {string} path @param {string} unfinished @param {string} key @param {number} iterations */
    noteProgress: (path, unfinished, key, iterations) => latest.set(path, [unfinished, key, iterations]),

    /** The key of the same pass after fewer iterations; "" where nothing is known of it.
     *  @param {string} path @param {string} unfinished @param {number} iterations */
    earlier: (path, unfinished, iterations) => {
      const [before, key, done] = latest.get(path) || ["", "", 0];
      return before === unfinished && done < iterations && known.has(key) ? key : "";
    },

    /** Hand over the result of a pass, which is known no longer. @param {string} key */
    take: (key) => {
      const [result] = /** @type {Cached} */ (known.get(key)).results.values();
      known.delete(key);
      return result;
    },

    clear: () => {
      [...known.keys()].forEach(drop);
      states.clear();
      latest.clear();
    },
  };
};
