// trace_view.js -- values beside the code: the lines of one call of a traced run, with a slider on each loop.

import { make } from "./dom.js";
import { general } from "./numbers.js";
import { fill } from "./words.js";

/** @import { Trace } from "./trace_run.js"
 *  @import { Call, Event, TracedValue } from "./trace_values.js" */

const DIGITS = 7; // of a number in floating point: nearly all that 32 bits have

/** Write a value as engine/trace/listing.py does. @param {TracedValue} value @param {string} type
 *  @returns {string} */
export function textOf(value, type) {
  if (value === null) return "";
  if (typeof value === "boolean") return String(value);
  if (typeof value === "number") {
    if (Number.isNaN(value)) return "NaN";
    if (!Number.isFinite(value)) return value > 0 ? "infinity" : "-infinity";
    return /^[iu]/.test(type) ? String(value) : general(value, DIGITS);
  }
  if (Array.isArray(value)) return `(${value.map((each) => textOf(each, type)).join(", ")})`;
  if (value.members) {
    const members = /** @type {[string, TracedValue, string][]} */ (value.members);
    return `{${members.map(([name, each, own]) => `${name} = ${textOf(each, own)}`).join(", ")}}`;
  }
  const element = type.split("[")[0];
  return `[${value.elements.map((/** @type {TracedValue} */ each) => textOf(each, element)).join(", ")}]`;
}

/** Whether a value has no NaN and no infinity. @param {TracedValue} value @returns {boolean} */
export function isFinite(value) {
  if (typeof value === "number") return Number.isFinite(value);
  if (value === null || typeof value === "boolean") return true;
  if (Array.isArray(value)) return value.every(isFinite);
  const parts = value.elements ?? value.members.map((/** @type {TracedValue[]} */ member) => member[1]);
  return parts.every(isFinite);
}

/** @typedef {ReturnType<typeof createTraceView>} TraceView */

/** @param {{words: Object<string, string>, textOfFile: (file: string) => string,
 *           chosen: (iteration: number) => void}} options  chosen: another iteration of the pass */
export function createTraceView({ words, textOfFile, chosen }) {
  const title = make("h2"), said = make("p", { className: "trace-said", role: "status" });
  const calls = make("select", { "aria-label": words.traceCall });
  const steps = make("div", { className: "trace-steps" }), lines = make("div", { className: "trace-lines" });
  const bad = make("button", { type: "button", className: "trace-bad", hidden: true }, words.traceBad);
  const bar = make("div", { className: "trace-bar" }, calls, bad);
  const element = make("div", { className: "trace" }, title, said, steps, bar, lines);
  /** @type {Trace | null} */
  let trace = null;
  /** @type {Map<number, number>} the iteration that is shown of each loop, by the place of its iterations */
  const at = new Map();

  /** @param {Event} event whether it belongs to the iterations that are shown */
  const isShown = ({ around, iterations }) =>
    around.every((loop, depth) => iterations[depth] === (at.get(loop) ?? 0));

  /** How many iterations a loop has, inside those that are shown around it. @param {Call} call
   *  @param {Event} head the first of its iterations */
  function countOf({ events }, head) {
    const depth = head.around.length - 1, outer = head.around.slice(0, -1);
    const own = events.filter((event) => event.at === head.at
      && outer.every((loop, i) => event.iterations[i] === (at.get(loop) ?? 0)));
    return own.reduce((most, event) => Math.max(most, event.iterations[depth] + 1), 0);
  }

  /** @param {Event} event */
  function written({ place, value }) {
    const text = textOf(value, place.type), sound = isFinite(value);
    const what = { return: "→", condition: "?" }[place.kind] ?? `${place.name} =`;
    if (sound) return make("span", {}, `${what} ${text}`);
    return make("span", { className: "not-finite", title: words.traceNotFinite }, `${what} ${text} !`);
  }

  /** @param {Call} call */
  function showLines(call) {
    const text = textOfFile(call.file).split("\n"), focus = document.activeElement?.getAttribute("data-loop");
    /** @type {Map<number, HTMLElement[]>} */
    const beside = new Map();
    const put = (/** @type {number} */ line, /** @type {HTMLElement} */ what) =>
      beside.set(line, [...(beside.get(line) ?? []), what]);
    const heads = new Map(call.events.filter(({ place }) => place.kind === "iteration")
      .reverse().map((event) => [event.at, event]));
    for (const head of heads.values()) {
      const count = countOf(call, head);
      if (!count) continue;
      at.set(head.at, Math.min(at.get(head.at) ?? 0, count - 1));
      put(head.place.line, loopSlider(call, head, count));
    }
    for (const event of call.events) {
      if (event.value === null || !isShown(event)) continue;
      put(event.place.line, written(event));
    }
    const used = [call.line, call.endLine, ...beside.keys()];
    const rows = [];
    for (let line = Math.min(...used); line <= Math.max(...used); line++) {
      const values = beside.get(line) ?? [];
      rows.push(make("div", { className: values.length ? "trace-line" : "trace-line is-empty" },
        make("span", { className: "trace-number" }, String(line)),
        make("code", {}, text[line - 1] ?? ""), make("span", { className: "trace-values" }, ...values)));
    }
    lines.replaceChildren(make("p", { className: "trace-file" }, call.file), ...rows);
    /** @type {HTMLElement | null} */ (lines.querySelector(`[data-loop="${focus}"]`))?.focus();
  }

  /** @param {Call} call @param {Event} head @param {number} count */
  function loopSlider(call, head, count) {
    const now = at.get(head.at) ?? 0, label = fill(words.traceLoop, { line: head.place.line });
    const slider = make("input", {
      type: "range", min: "0", max: String(count - 1), value: String(now), "aria-label": label,
      "data-loop": String(head.at),
    });
    slider.style.setProperty("--share", String(count > 1 ? now / (count - 1) : 0));
    slider.oninput = () => {
      at.set(head.at, +slider.value);
      showLines(call);
    };
    return make("span", { className: "trace-loop" }, slider,
      make("output", {}, fill(words.traceOf, { number: now + 1, count })));
  }

  /** @param {Trace} of */
  function listCalls({ run }) {
    /** @type {Map<string, number>} */
    const seen = new Map();
    const total = (/** @type {string} */ name) => run.calls.filter((call) => call.function === name).length;
    calls.replaceChildren(...run.calls.map((call, index) => {
      const number = (seen.get(call.function) ?? 0) + 1, count = total(call.function);
      seen.set(call.function, number);
      const label = count > 1 ? fill(words.traceNth, { name: call.function, number, count }) : call.function;
      return make("option", { value: String(index) }, label);
    }));
  }

  /** Show a call, and the iterations in which an event of it is.
   *  @param {number} index @param {Event} [event] */
  function open(index, event) {
    if (!trace) return;
    calls.value = String(index);
    event?.around.forEach((loop, depth) => at.set(loop, event.iterations[depth]));
    showLines(trace.run.calls[index]);
  }
  calls.onchange = () => open(+calls.value);

  return {
    element,
    /** Say something in place of a trace. @param {string} text */
    say(text) {
      said.textContent = text;
      said.classList.add("alarm");
    },
    get trace() { return trace; },
    /** Show a trace: a call of the same function as before, and the same iterations. @param {Trace} next */
    show(next) {
      const own = trace?.path === next.path ? trace.run.calls[+calls.value]?.function : undefined;
      if (trace?.path !== next.path) at.clear();
      trace = next;
      const { path, texel: [x, y], run, iteration, total } = next;
      title.textContent = fill(words.traceTitle, { path, x, y });
      const exact = next.isExact ? words.traceExact : words.traceInexact;
      said.textContent = next.isComplete ? exact : `${exact} ${words.traceCut}`;
      said.classList.toggle("alarm", !next.isExact);
      steps.replaceChildren(...(total > 1 ? [stepSlider(iteration, total)] : []));
      const first = run.events.find(({ value }) => !isFinite(value));
      bad.hidden = !first;
      bad.onclick = () => { if (first) open(first.call, first); };
      listCalls(next);
      if (!run.calls.length) return void lines.replaceChildren();
      const main = run.calls.findIndex(({ file }) => file === next.kernel.file);
      const same = run.calls.findIndex((call) => call.function === own);
      open(same >= 0 ? same : Math.max(main, 0));
    },
  };

  /** @param {number} now @param {number} total */
  function stepSlider(now, total) {
    const slider = make("input", {
      type: "range", min: "0", max: String(total - 1), value: String(now), "aria-label": words.traceIteration,
    });
    slider.style.setProperty("--share", String(now / (total - 1)));
    const number = make("output", {}, fill(words.traceOf, { number: now + 1, count: total }));
    slider.oninput = () => {
      number.textContent = fill(words.traceOf, { number: +slider.value + 1, count: total });
      slider.style.setProperty("--share", String(+slider.value / (total - 1)));
    };
    slider.onchange = () => chosen(+slider.value);
    return make("label", {}, words.traceIteration, slider, number);
  }
}
