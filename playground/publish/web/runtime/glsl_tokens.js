// glsl_tokens.js -- cuts GLSL into tokens, and applies changes to it that leave its lines where they are.

/** @typedef {{text: string, at: number, end: number}} Token */
/** Text to put at a place, in place of what is up to `end`. One that `opens` goes around what others at its
 *  place go around that were made before it.
 *  @typedef {{at: number, end: number, text: string, opens?: boolean}} Edit */

const TOKEN = new RegExp(
  [
    /\/\/[^\n]*|\/\*[^]*?\*\/|\s+/.source,                               // nothing
    /([A-Za-z_]\w*)/.source,                                             // a word
    /((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*)/.source,                  // a number
    /(<<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]=|[^\w\s])/.source, // a sign
  ].join("|"), "g");
const DIRECTIVE = /^[ \t]*#(?:\\\n|[^\n])*/gm;

/** The text that was cut last: what changes nothing in it hands it on to the next.
 *  @type {{text: string, tokens: Token[]}} */
let last = { text: "", tokens: [] };

/** The tokens of a text without its comments and directives.
 *  @param {string} text @returns {Token[]} */
export function tokensOf(text) {
  if (text !== last.text) last = { text, tokens: cut(text) };
  return last.tokens;
}

/** @param {string} text @returns {Token[]} */
function cut(text) {
  const plain = text.replace(/\/\*[^]*?\*\/|\/\/[^\n]*/g, (comment) => comment.replace(/[^\n]/g, " "))
    .replace(DIRECTIVE, (line) => line.replace(/[^\n]/g, " "));
  const found = [...plain.matchAll(TOKEN)].filter(([, word, number, sign]) => word ?? number ?? sign);
  return found.map(({ 0: written, index }) => ({ text: written, at: index, end: index + written.length }));
}

/** The macros that a text defines: their parameters, null of one without any, and what stands for them.
 *  @param {string} text @returns {Map<string, {parameters: string[] | null, body: string}>} */
export function macrosOf(text) {
  const found = new Map();
  for (const [, name, list, body] of text.matchAll(/^[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)\n]*\))?(.*)$/gm)) {
    const parameters = list ? list.slice(1, -1).split(",").map((one) => one.trim()) : null;
    found.set(name, { parameters, body });
  }
  return found;
}

/** A text with changes; of those at one place the first comes first, but for those that open.
 *  @param {string} text @param {Edit[]} edits */
export function edited(text, edits) {
  let found = "", from = 0;
  const inOrder = edits.map((edit, index) => ({ edit, index }))
    .sort((a, b) => a.edit.at - b.edit.at || Number(a.edit.opens ?? 0) - Number(b.edit.opens ?? 0)
      || (a.edit.opens ? b.index - a.index : a.index - b.index));
  for (const { edit } of inOrder) {
    found += text.slice(from, edit.at) + edit.text;
    from = Math.max(edit.end, from);
  }
  return found + text.slice(from);
}

/** The index of the bracket that closes one.
 *  @param {Token[]} tokens @param {number} index of "(", "[" or "{" */
export function closing(tokens, index) {
  let depth = 0;
  for (let at = index; at < tokens.length; at++) {
    if ("([{".includes(tokens[at].text)) depth++;
    if (")]}".includes(tokens[at].text) && --depth === 0) return at;
  }
  throw new Error("a bracket is not closed");
}
