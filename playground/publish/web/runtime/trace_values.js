// trace_values.js -- from what a traced shader records to calls, events and loops: engine/trace/model.py.

/** A place of the text that records: what `instrument` writes beside a traced text.
 *  @typedef {object} Place
 *  @property {string} kind       enter | argument | set | iteration | condition | return | leave | discard
 *  @property {string} name       as written: "sum", "rows[i]"; the text of a condition; a function's name
 *  @property {string} function
 *  @property {string} type       in GLSL; "" where it has no value
 *  @property {string} file       in `Shared.files`
 *  @property {number} line       from 1
 *  @property {number} endLine    of a function at enter
 *  @property {number[]} loops    the iteration places of the loops around it, outermost first */

/** @typedef {Object<string, [string, string][]>} Structs   the members of each struct, with their types */

/** A number, a truth, several of them, columns of a matrix, elements of an array ({ elements }), members of a
 *  struct ({ members }: of each its name, its value and its type), or null.
 *  @typedef {any} TracedValue */

/** @typedef {object} Event
 *  @property {Place} place
 *  @property {number} at            the place's number
 *  @property {TracedValue} value
 *  @property {number} call          index in `Run.calls`
 *  @property {number[]} around      the iteration places of the loops around it, its own included
 *  @property {number[]} iterations  of each of these loops, from 0 */

/** @typedef {{function: string, file: string, line: number, endLine: number, caller: number, depth: number,
 *             events: Event[]}} Call  caller: index; -1 for none */
/** @typedef {{calls: Call[], events: Event[]}} Run */

const BASES = [
  "float", "vec2", "vec3", "vec4", "int", "ivec2", "ivec3", "ivec4",
  "uint", "uvec2", "uvec3", "uvec4", "bool", "bvec2", "bvec3", "bvec4",
];
const LENGTH = BASES.length, MARK = LENGTH + 1; // codes of an array's length, and of an event without a value
const MATRIX = /^mat([234])(?:x[234])?$/;

class Cut extends Error {}

/** What a traced shader records at once: its place, the code of its type, the bits of four numbers.
 *  @typedef {{place: number, code: number, bits: ArrayLike<number>}} Leaf */

/** Join the leaves of a run into events. @param {Place[]} places @param {Structs} structs
 *  @param {Iterable<Leaf>} leaves @returns {Run} */
export function rebuild(places, structs, leaves) {
  /** @type {Call[]} */
  const calls = [];
  /** @type {Event[]} */
  const events = [];
  /** @type {{call: number, counts: Map<number, number>}[]} calls that are not left */
  const stack = [];
  const rest = leaves[Symbol.iterator]();
  for (let leaf = rest.next(); !leaf.done; leaf = rest.next()) {
    const place = places[leaf.value.place];
    try {
      add(leaf.value.place, place, valueOf(place.type, leaf.value));
    } catch (error) {
      if (error instanceof Cut) break; // the limit of events cut the value
      throw error;
    }
  }
  return { calls, events };

  /** @param {number} at @param {Place} place @param {TracedValue} value */
  function add(at, place, value) {
    if (place.kind === "enter" || !stack.length) {
      const caller = stack.at(-1)?.call ?? -1;
      calls.push({
        function: place.function, file: place.file, line: place.line, endLine: place.endLine, caller,
        depth: stack.length, events: [],
      });
      stack.push({ call: calls.length - 1, counts: new Map() });
    }
    const { call, counts } = /** @type {typeof stack[0]} */ (stack.at(-1));
    const loops = place.kind === "iteration" ? [...place.loops, at] : place.loops;
    for (const inner of [...counts.keys()]) if (!loops.includes(inner)) counts.delete(inner);
    if (place.kind === "iteration") counts.set(at, (counts.get(at) ?? -1) + 1);
    const iterations = loops.map((loop) => counts.get(loop) ?? 0);
    const event = { place, at, value, call, around: loops, iterations };
    events.push(event);
    calls[call].events.push(event);
    if (place.kind === "return" || place.kind === "leave") stack.pop();
  }

  function next() {
    const leaf = rest.next();
    if (leaf.done) throw new Cut();
    return leaf.value;
  }

  /** @param {string} type @param {Leaf} leaf @returns {TracedValue} */
  function valueOf(type, leaf) {
    if (leaf.code === MARK) return null;
    if (leaf.code === LENGTH) {
      const element = type.split("[")[0];
      return { elements: Array.from({ length: leaf.bits[1] }, () => valueOf(element, next())) };
    }
    const matrix = MATRIX.exec(type);
    if (matrix) {
      return [leaf, ...Array.from({ length: +matrix[1] - 1 }, next)].map((column) => numbersOf(column));
    }
    const members = structs[type];
    if (members) {
      const all = members.map(([name, own], i) => [name, valueOf(own, i ? next() : leaf), own]);
      return { members: all };
    }
    const numbers = numbersOf(leaf);
    return numbers.length === 1 ? numbers[0] : numbers;
  }
}

/** @param {Leaf} leaf @returns {(number | boolean)[]} */
function numbersOf({ code, bits }) {
  const type = BASES[code], own = Uint32Array.from({ length: code % 4 + 1 }, (_, i) => bits[i]);
  if (type.startsWith("b")) return Array.from(own, (each) => each !== 0);
  if (type.startsWith("i")) return Array.from(new Int32Array(own.buffer));
  return Array.from(type.startsWith("u") ? own : new Float32Array(own.buffer));
}
