// token_cursor.js -- goes through the tokens of a text, one after another.

import { closing, tokensOf } from "./glsl_tokens.js";

/** @typedef {ReturnType<typeof createCursor>} Cursor */

/** Begin at a text's first token. @param {string} text */
export function createCursor(text) {
  const tokens = tokensOf(text);
  let at = 0;
  const peek = (ahead = 0) => tokens[at + ahead]?.text ?? "";
  const take = () => {
    if (at >= tokens.length) throw new Error("the text ends");
    return tokens[at++];
  };
  return {
    /** The next token's text, or that of a later one; "" behind the last. */
    peek,

    /** Take the next token; throws behind the last. */
    take,

    /** Take the next token, which has to be this one. @param {string} wanted */
    expect: (wanted) => {
      if (peek() !== wanted) throw new Error(`'${wanted}' is missing`);
      return take();
    },

    /** Pass a bracket, the next token, and all up to its end. */
    skip: () => { at = closing(tokens, at) + 1; },

    /** Where the token ends, in the text, that was taken last. */
    end: () => tokens[at - 1].end,

    /** Whether a token is left. */
    isAtEnd: () => at >= tokens.length,

    /** The number of the next token, to come back to; behind a bracket that begins there. */
    place: () => at,
    behind: () => closing(tokens, at) + 1,
    /** @param {number} place */
    goTo: (place) => { at = place; },
  };
}
