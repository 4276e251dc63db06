// macro_calls.js -- joins calls of function-like macros that span lines: shader/source.py.

const DEFINE = /^\s*#\s*define\s+(\w+)(\(|\s+(\w+)\s*$)?/;
const DIRECTIVE = /^\s*#/;
const MAX_LINES = 1000; // that one call may span: an unclosed one must not swallow the file

/** Lines of code, comments blanked and ASCII only, with each macro call on one line; as many lines.
 *  @param {string[]} codes @returns {string[]} */
export function withCallsJoined(codes) {
  const found = [...codes];
  /** @type {Set<string>} */
  const macros = new Set();
  let pattern = /$^/g;
  for (let index = 0; index < found.length; index++) {
    const define = DEFINE.exec(found[index]);
    if (define) {
      const [, name, bracket, meaning] = define;
      if (bracket === "(" || macros.has(meaning)) {
        macros.add(name);
        pattern = new RegExp(`\\b(?:${[...macros].join("|")})\\b\\s*(\\(?)`, "g");
      }
    } else if (macros.size && !DIRECTIVE.test(found[index])) {
      join(found, index, pattern);
    }
  }
  return found;
}

/** Appends to a line those that a macro call begun on it goes on to; leaves it where the call never ends.
 *  @param {string[]} codes @param {number} index @param {RegExp} pattern */
function join(codes, index, pattern) {
  let joined = codes[index];
  let taken = joined; // as far as calls are whole
  let end = index;
  for (let last = index + 1, open = openAtEnd(joined, pattern); open !== "no"; last++) {
    if (last >= codes.length || last - index > MAX_LINES || DIRECTIVE.test(codes[last])) break;
    const code = codes[last].trim();
    if (open === "maybe" && code && !code.startsWith("(")) break;
    if (code) joined += ` ${code}`;
    open = openAtEnd(joined, pattern);
    if (open === "no") [taken, end] = [joined, last];
  }
  codes[index] = taken;
  codes.fill("", index + 1, end + 1);
}

/** Whether a macro's call is open at a line's end; "maybe": the name ends it.
 *  @param {string} code @param {RegExp} pattern @returns {"no" | "yes" | "maybe"} */
function openAtEnd(code, pattern) {
  pattern.lastIndex = 0;
  for (let match = pattern.exec(code); match; match = pattern.exec(code)) {
    const position = pattern.lastIndex;
    if (!match[1]) {
      if (!code.slice(position).trim()) return "maybe";
      continue;
    }
    let depth = 1;
    for (let at = position; at < code.length && depth; at++) {
      depth += code[at] === "(" ? 1 : code[at] === ")" ? -1 : 0;
    }
    if (depth) return "yes";
  }
  return "no";
}
