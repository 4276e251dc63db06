// conversions.js -- writes out the conversions that desktop GLSL does by itself and GLSL ES leaves undone.
//
// There a whole number becomes a float where one is wanted, "f.xx" of a number is a vector, "{ a, b }" a
// value. The text is read as far as types need it; what is not understood, such as a macro that takes types,
// stays.

import { closing, edited, macrosOf, tokensOf } from "./glsl_tokens.js";
import * as types from "./glsl_types.js";

/** @typedef {import("./glsl_types.js").Type} Type */
/** Of an expression, with its places in the text.
 *  @typedef {{at: number, end: number, type: Type, literal?: boolean}} Value */
/** @typedef {{parameters: {type: Type, out: boolean}[], type: Type}} Signature */

const QUALIFIERS = new Set(("const in out inout uniform varying attribute centroid flat smooth noperspective "
  + "invariant highp mediump lowp precise patch sample").split(" "));
const BASIC = /^(?:void|float|int|uint|bool|[iub]?vec[234]|mat[234](?:x[234])?|[iu]?sampler\w+)$/;
const SWIZZLE = /^(?:[xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4})$/;
/** @type {Object<string, number>} */
const BINDING = {
  "*": 11, "/": 11, "%": 11, "+": 10, "-": 10, "<<": 9, ">>": 9, "<": 8, ">": 8, "<=": 8, ">=": 8, "==": 7,
  "!=": 7, "&": 6, "^": 5, "|": 4, "&&": 3, "^^": 2, "||": 1,
};
const ASSIGNING = /^(?:[-+*/%&|^]|<<|>>)?=$/;

/** A stage's text with the conversions written out; its lines stay where they are.
 *  @param {string} text @returns {string} */
export function withConversions(text) {
  const tokens = tokensOf(text), macros = macrosOf(text);
  /** @type {import("./glsl_tokens.js").Edit[]} */
  const edits = [];
  /** @type {Map<string, Signature[]>} */
  const functions = new Map();
  /** @type {Map<string, {name: string, type: Type}[]>} */
  const structures = new Map();
  /** @type {Map<string, Type>[]} */
  const scopes = [new Map()];
  let at = 0;

  const peek = (ahead = 0) => tokens[at + ahead]?.text ?? "";
  const take = () => {
    if (at >= tokens.length) throw new Error("the text ends");
    return tokens[at++];
  };
  /** @param {string} wanted */
  const expect = (wanted) => {
    if (peek() !== wanted) throw new Error(`'${wanted}' is missing`);
    return take();
  };
  const isType = (/** @type {string} */ word) => BASIC.test(word) || structures.has(word);
  /** @param {string} name @returns {Type} */
  const typeNamed = (name) => {
    for (const scope of [...scopes].reverse()) if (scope.has(name)) return scope.get(name) ?? "";
    if (name === "gl_FragCoord") return "vec4";
    if (name === "gl_VertexID" || name === "gl_InstanceID") return "int";
    const macro = macros.get(name);
    if (!macro || macro.parameters) return "";
    const body = macro.body.replace(/\/\/.*/, "").trim().replace(/^\((.*)\)$/, "$1");
    if (/^[-+]?\d+$/.test(body)) return "int";
    if (/^[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][-+]?\d+)?f?$/.test(body)) return "float";
    const made = /^(\w+)\s*\(/.exec(body)?.[1] ?? "";
    if (BASIC.test(made)) return made;
    return /^\w+$/.test(body) && body !== name ? typeNamed(body) : "";
  };

  /** Make of a value one whose numbers are of another kind, where a desktop does.
   *  @param {Value} value @param {Type} wanted */
  const convert = (value, wanted) => {
    const base = types.baseOf(wanted), from = types.baseOf(value.type);
    if (!types.isWidened(from, base)) return;
    const written = text.slice(value.at, value.end);
    if (value.literal && /^\d+$/.test(written)) {
      edits.push({ at: value.end, end: value.end, text: base === "float" ? ".0" : "u" });
    } else {
      const type = types.typeOf(base, types.sizeOf(value.type));
      edits.push({ at: value.at, end: value.at, text: `${type}(`, opens: true });
      edits.push({ at: value.end, end: value.end, text: ")" });
    }
    value.type = types.typeOf(base, types.sizeOf(value.type));
  };

  /** @returns {Value} */
  const primary = () => {
    const token = take(), { text: word, at: begin } = token;
    if (/^[\d.]/.test(word) && word !== ".") {
      const float = /^(?!0[xX]).*[.eEfF]/.test(word), unsigned = /[uU]$/.test(word);
      return { at: begin, end: token.end, type: float ? "float" : unsigned ? "uint" : "int", literal: true };
    }
    if (word === "(") {
      const inner = comma();
      return { at: begin, end: expect(")").end, type: inner.type };
    }
    if (["-", "+", "!", "~", "++", "--"].includes(word)) {
      const inner = unary();
      return { at: begin, end: inner.end, type: inner.type };
    }
    if (!/^[A-Za-z_]/.test(word)) throw new Error(`'${word}' begins no value`);
    if (word === "true" || word === "false") return { at: begin, end: token.end, type: "bool" };
    if (isType(word) && (peek() === "[" || peek() === "(")) {
      let type = word;
      while (peek() === "[") {
        at = closing(tokens, at) + 1;
        type += "[]";
      }
      const values = list();
      const fields = structures.get(word);
      if (type.endsWith("[]")) values.forEach((value) => convert(value, word));
      else if (fields) values.forEach((value, index) => convert(value, fields[index]?.type ?? ""));
      return { at: begin, end: tokens[at - 1].end, type };
    }
    if (peek() !== "(") return { at: begin, end: token.end, type: typeNamed(word) };
    const values = list();
    return { at: begin, end: tokens[at - 1].end, type: called(word, values) };
  };

  /** The values between brackets. */
  const list = () => {
    const values = [];
    expect("(");
    if (peek() === "void" && peek(1) === ")") take();
    while (peek() !== ")") {
      values.push(assignment());
      if (peek() === ",") take();
    }
    take();
    return values;
  };

  /** What a call gives, its values converted. @param {string} name @param {Value[]} values @returns {Type} */
  const called = (name, values) => {
    const given = values.map((value) => value.type), all = functions.get(name);
    if (!all) {
      if (types.takesFloats(name, given)) {
        for (const value of values.slice(/^tex/.test(name) ? 1 : 0)) convert(value, "float");
      }
      return macros.has(name) ? macroType(name) : types.givenBy(name, values.map((value) => value.type));
    }
    const fitting = all.filter(({ parameters }) => parameters.length === values.length);
    const same = fitting.find(({ parameters }) =>
      parameters.every(({ type }, index) => type === given[index]));
    const close = fitting.find(({ parameters }) => parameters.every(({ type }, index) =>
      !given[index] || type === given[index]
      || types.isWidened(types.baseOf(given[index]), types.baseOf(type))));
    if (!same && close) {
      values.forEach((value, index) => {
        const { type, out } = close.parameters[index];
        convert(value, out ? "" : type);
      });
    }
    return (same ?? close ?? fitting[0] ?? all[0]).type;
  };

  /** What a macro with parameters gives, where it is a value of a type.
   *  @param {string} name @returns {Type} */
  const macroType = (name) => {
    const made = /^\s*\(?\s*(\w+)\s*\(/.exec(macros.get(name)?.body ?? "")?.[1] ?? "";
    return BASIC.test(made) ? made : "";
  };

  /** @returns {Value} */
  const unary = () => {
    let value = primary();
    for (;;) {
      if (peek() === "[") {
        take();
        comma();
        value = { at: value.at, end: expect("]").end, type: types.elementOf(value.type) };
      } else if (peek() === ".") {
        const dot = take(), field = take();
        if (field.text === "length" && peek() === "(") {
          list();
          value = { at: value.at, end: tokens[at - 1].end, type: "int" };
        } else if (types.sizeOf(value.type) === 1 && SWIZZLE.test(field.text)) {
          const type = types.swizzled(value.type, field.text);
          edits.push({ at: value.at, end: value.at, text: `${type}(`, opens: true });
          edits.push({ at: dot.at, end: field.end, text: ")" });
          value = { at: value.at, end: field.end, type };
        } else {
          const own = structures.get(value.type)?.find(({ name }) => name === field.text);
          const parts = SWIZZLE.test(field.text) ? types.swizzled(value.type, field.text) : "";
          const type = own ? own.type : parts;
          value = { at: value.at, end: field.end, type };
        }
      } else if (peek() === "++" || peek() === "--") {
        value = { ...value, end: take().end, literal: false };
      } else {
        return value;
      }
    }
  };

  /** @param {number} least how strongly an operator has to bind @returns {Value} */
  const binary = (least) => {
    let left = unary();
    while ((BINDING[peek()] ?? 0) >= least) {
      const sign = take().text, right = binary(BINDING[sign] + 1);
      if (sign !== "<<" && sign !== ">>") {
        convert(left, right.type);
        convert(right, left.type);
      }
      left = { at: left.at, end: right.end, type: types.given(sign, left.type, right.type) };
    }
    return left;
  };

  /** @returns {Value} */
  const assignment = () => {
    const left = binary(1);
    if (peek() === "?") {
      take();
      const one = comma();
      expect(":");
      const other = assignment();
      convert(one, other.type);
      convert(other, one.type);
      return { at: left.at, end: other.end, type: one.type || other.type };
    }
    if (!ASSIGNING.test(peek())) return left;
    const sign = take().text, right = assignment();
    if (!/^(?:<<|>>)/.test(sign)) convert(right, left.type);
    return { at: left.at, end: right.end, type: left.type };
  };

  /** @returns {Value} */
  const comma = () => {
    let value = assignment();
    while (peek() === ",") {
      take();
      value = { ...assignment(), at: value.at };
    }
    return value;
  };

  /** A value of a type: "{ a, b }" too. @param {Type} type */
  const initial = (type) => {
    if (peek() !== "{") {
      convert(assignment(), type);
      return;
    }
    const open = take();
    let count = 0;
    const fields = structures.get(type);
    while (peek() !== "}") {
      initial(fields ? fields[count]?.type ?? "" : types.elementOf(type));
      count++;
      if (peek() === ",") {
        const mark = take();
        if (peek() === "}") edits.push({ at: mark.at, end: mark.end, text: "" });
      }
    }
    const end = take();
    edits.push({ at: open.at, end: open.end, text: `${type}(` }, { at: end.at, end: end.end, text: ")" });
  };

  /** The brackets of an array; how many there are. @returns {string} */
  const brackets = () => {
    let found = "";
    for (; peek() === "["; found += "[]") at = closing(tokens, at) + 1;
    return found;
  };

  const qualifiers = () => {
    let out = false;
    for (;;) {
      if (peek() === "layout") {
        take();
        at = closing(tokens, at) + 1;
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
    const end = closing(tokens, at), before = edits.length, depth = scopes.length;
    scopes.push(scope);
    try {
      statement(type);
    } catch {
      edits.splice(before); // what is not understood stays
    }
    scopes.length = depth;
    at = end + 1;
  };

  while (at < tokens.length) {
    const begin = at;
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
      at = begin + 1;
    }
  }
  return edited(text, edits);
}
