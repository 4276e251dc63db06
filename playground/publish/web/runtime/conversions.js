// conversions.js -- writes out the conversions that desktop GLSL does by itself and GLSL ES leaves undone.
//
// There a whole number becomes a float where one is wanted, "f.xx" of a number is a vector, "{ a, b }" a
// value. The text is read as far as types need it, declarations and statements here, expressions in
// converted_values.js; what is not understood, such as a macro that takes types, stays.

import { createValues } from "./converted_values.js";
import { edited } from "./glsl_tokens.js";
import { createCursor } from "./token_cursor.js";

/** @typedef {import("./glsl_types.js").Type} Type */

const QUALIFIERS = new Set(("const in out inout uniform varying attribute centroid flat smooth noperspective "
  + "invariant highp mediump lowp precise patch sample").split(" "));

/** A stage's text with the conversions written out; its lines stay where they are.
 *  @param {string} text @returns {string} */
export function withConversions(text) {
  const cursor = createCursor(text), { peek, take, expect, skip, goTo } = cursor;
  /** @type {import("./glsl_tokens.js").Edit[]} */
  const edits = [];
  /** @type {import("./converted_values.js").Declared} */
  const declared = { functions: new Map(), structures: new Map(), scopes: [new Map()] };
  const { functions, structures, scopes } = declared;
  const { isType, convert, list, comma, initial } = createValues(text, cursor, declared, edits);

  /** The brackets of an array; how many there are. @returns {string} */
  const brackets = () => {
    let found = "";
    for (; peek() === "["; found += "[]") skip();
    return found;
  };

  const qualifiers = () => {
    let out = false;
    for (;;) {
      if (peek() === "layout") {
        take();
        skip();
      } else if (QUALIFIERS.has(peek())) {
        out = /out$/.test(take().text) || out;
      } else {
        return out;
      }
    }
  };

  const structure = () => {
    take();
    const name = peek() === "{" ? "" : take().text, fields = [];
    expect("{");
    while (peek() !== "}") {
      qualifiers();
      const type = take().text + brackets();
      for (;;) {
        const field = take().text;
        fields.push({ name: field, type: type + brackets() });
        if (take().text === ";") break;
      }
    }
    take();
    structures.set(name, fields);
    return name;
  };

  /** Declarations after their type, up to the semicolon. @param {Type} type */
  const declarations = (type) => {
    for (;;) {
      const name = take().text, whole = type + brackets();
      scopes[scopes.length - 1].set(name, whole);
      if (peek() === "=") {
        take();
        initial(whole);
      }
      if (take().text === ";") return;
    }
  };

  /** @param {Type} returns what the function around it gives */
  const statement = (returns) => {
    const word = peek();
    if (word === "{") {
      take();
      scopes.push(new Map());
      while (peek() !== "}") statement(returns);
      take();
      scopes.pop();
    } else if (word === "if" || word === "while" || word === "switch") {
      take();
      expect("(");
      comma();
      expect(")");
      statement(returns);
      if (peek() === "else") {
        take();
        statement(returns);
      }
    } else if (word === "for") {
      take();
      expect("(");
      scopes.push(new Map());
      statement(returns);
      if (peek() !== ";") comma();
      expect(";");
      if (peek() !== ")") comma();
      expect(")");
      statement(returns);
      scopes.pop();
    } else if (word === "do") {
      take();
      statement(returns);
      expect("while");
      list();
      expect(";");
    } else if (word === "return") {
      take();
      if (peek() !== ";") convert(comma(), returns);
      expect(";");
    } else if (word === "case" || word === "default") {
      while (take().text !== ":");
    } else if (word === ";" || word === "else") {
      take();
    } else if (word === "struct") {
      declarations(structure());
    } else if (QUALIFIERS.has(word) || (isType(word) && /^[A-Za-z_[]/.test(peek(1)))) {
      qualifiers();
      declarations(take().text + brackets());
    } else {
      comma();
      if (peek() === ";") take(); // a macro may bring its own
    }
  };

  /** A function's head, and its body where it has one. @param {Type} type @param {string} name */
  const functionOf = (type, name) => {
    expect("(");
    const scope = new Map(), parameters = [];
    if (peek() === "void") take();
    while (peek() !== ")") {
      const out = qualifiers();
      let own = take().text + brackets();
      const named = [",", ")"].includes(peek()) ? "" : take().text;
      own += brackets();
      scope.set(named, own);
      parameters.push({ type: own, out });
      if (peek() === ",") take();
    }
    take();
    functions.set(name, [...(functions.get(name) ?? []), { parameters, type }]);
    if (peek() === ";") take();
    if (peek() !== "{") return;
    const behind = cursor.behind(), before = edits.length, depth = scopes.length;
    scopes.push(scope);
    try {
      statement(type);
    } catch {
      edits.splice(before); // what is not understood stays
    }
    scopes.length = depth;
    goTo(behind);
  };

  while (!cursor.isAtEnd()) {
    const begin = cursor.place();
    try {
      qualifiers();
      if (peek() === "precision") while (take().text !== ";");
      else if (peek() === "struct") {
        const name = structure();
        if (peek() === ";") take();
        else declarations(name);
      } else if (isType(peek())) {
        const type = take().text + brackets();
        if (/^[A-Za-z_]/.test(peek()) && peek(1) === "(") functionOf(type, take().text);
        else declarations(type);
      } else take();
    } catch {
      goTo(begin + 1);
    }
  }
  return edited(text, edits);
}
