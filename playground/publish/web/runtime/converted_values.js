// converted_values.js -- reads the expressions of a GLSL text with their types, and notes the conversions
// that GLSL ES wants written.

import { macrosOf } from "./glsl_tokens.js";
import * as types from "./glsl_types.js";

/** @typedef {import("./glsl_types.js").Type} Type */
/** Of an expression: places in the text, and its type.
 *  @typedef {{at: number, end: number, type: Type, literal?: boolean}} Value */
/** @typedef {{parameters: {type: Type, out: boolean}[], type: Type}} Signature */
/** What is declared so far: functions by name, structures' fields, variables of each scope.
 *  @typedef {{functions: Map<string, Signature[]>, structures: Map<string, {name: string, type: Type}[]>,
 *             scopes: Map<string, Type>[]}} Declared */

const BASIC = /^(?:void|float|int|uint|bool|[iub]?vec[234]|mat[234](?:x[234])?|[iu]?sampler\w+)$/;
const SWIZZLE = /^(?:[xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4})$/;
/** @type {Object<string, number>} */
const BINDING = {
  "*": 11, "/": 11, "%": 11, "+": 10, "-": 10, "<<": 9, ">>": 9, "<": 8, ">": 8, "<=": 8, ">=": 8, "==": 7,
  "!=": 7, "&": 6, "^": 5, "|": 4, "&&": 3, "^^": 2, "||": 1,
};
const ASSIGNING = /^(?:[-+*/%&|^]|<<|>>)?=$/;

/** Make what reads expressions where a cursor is. Each throws for what it does not understand.
 *  @param {string} text @param {import("./token_cursor.js").Cursor} cursor @param {Declared} declared
 *  @param {import("./glsl_tokens.js").Edit[]} edits   gets the conversions */
export function createValues(text, { peek, take, expect, skip, end }, declared, edits) {
  const { functions, structures, scopes } = declared, macros = macrosOf(text);

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
        skip();
        type += "[]";
      }
      const values = list();
      const fields = structures.get(word);
      if (type.endsWith("[]")) values.forEach((value) => convert(value, word));
      else if (fields) values.forEach((value, index) => convert(value, fields[index]?.type ?? ""));
      return { at: begin, end: end(), type };
    }
    if (peek() !== "(") return { at: begin, end: token.end, type: typeNamed(word) };
    const values = list();
    return { at: begin, end: end(), type: called(word, values) };
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
      const first = /^tex/.test(name) ? 1 : 0; // a sampler
      if (types.takesFloats(name, given)) values.slice(first).forEach((value) => convert(value, "float"));
      return macros.has(name) ? macroType(name) : types.givenBy(name, values.map((value) => value.type));
    }
    const fitting = all.filter(({ parameters }) => parameters.length === values.length);
    const same = fitting.find((one) => one.parameters.every(({ type }, index) => type === given[index]));
    const close = fitting.find((one) => one.parameters.every(({ type }, index) => {
      const from = given[index];
      return !from || type === from || types.isWidened(types.baseOf(from), types.baseOf(type));
    }));
    if (!same && close) close.parameters.forEach(({ type, out }, index) => {
      if (!out) convert(values[index], type);
    });
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
          value = { at: value.at, end: end(), type: "int" };
        } else if (types.sizeOf(value.type) === 1 && SWIZZLE.test(field.text)) {
          const type = types.swizzled(value.type, field.text);
          edits.push({ at: value.at, end: value.at, text: `${type}(`, opens: true });
          edits.push({ at: dot.at, end: field.end, text: ")" });
          value = { at: value.at, end: field.end, type };
        } else {
          const own = structures.get(value.type)?.find(({ name }) => name === field.text);
          const part = SWIZZLE.test(field.text) ? types.swizzled(value.type, field.text) : "";
          const type = own ? own.type : part;
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
    const shut = take();
    edits.push({ at: open.at, end: open.end, text: `${type}(` }, { at: shut.at, end: shut.end, text: ")" });
  };

  return { isType, convert, list, comma, initial };
}
