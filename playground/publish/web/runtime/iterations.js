// iterations.js -- repeats that may be stopped early, a slider each; of one that may not, why.

import { whyLocked } from "./controls.js";
import { make } from "./dom.js";
import { labelOf } from "./labels.js";
import { fill } from "./words.js";

/** @typedef {import("./session.js").Session} Session */
/** @typedef {import("./panel_rows.js").Rows} Rows */

/** Make the sliders. `repeats` gives the iterations in all of each repeat, by path; none before a plan.
 *  @param {Session} session @param {Object<string, string>} words @param {Rows} rows
 *  @param {() => Map<string, number>} repeats */
export function iterationRows(session, words, rows, repeats) {
  const body = make("div", {});
  let known = "";

  const lockedOf = (/** @type {string} */ path) => session.sketch.passes[path]?.locked ?? "";

  function slider(/** @type {string} */ path, /** @type {number} */ count) {
    const label = path.split(".").map(labelOf).join(", "), own = session.sketch.steps[path];
    const called = fill(words.iterationsOf, { name: label });
    const range = make("input", { type: "range", min: 0, max: count, step: 1, "aria-label": called });
    const text = make("output"), name = make("span", { className: "name", title: path }, label);
    const row = make("div", { className: "row is-steps" }, name, range, text);
    row.dataset.path = path;
    const locked = lockedOf(path);
    if (locked) range.setAttribute("aria-description", locked);
    range.disabled = Boolean(locked);
    row.classList.toggle("locked", range.disabled);
    range.oninput = () => session.stop(path, +range.value === (own ?? count) ? null : +range.value);
    row.ondblclick = () => session.stop(path, null);
    return rows.keep(row, () => {
      const at = Math.min(session.steps.get(path) ?? own ?? count, count);
      range.value = String(at);
      range.style.setProperty("--share", String(at / count));
      text.textContent = at === count ? fill(words.allOf, { count }) : String(at);
      range.setAttribute("aria-valuetext", text.textContent);
      row.classList.toggle("changed", session.steps.has(path));
    });
  }

  rows.keep(body, () => {
    const found = [...repeats()].filter(([, count]) => count > 1), now = JSON.stringify(found);
    if (now === known) return;
    known = now;
    rows.forget(body);
    const said = new Set([""]); // why repeats are locked: once, before the first of those
    body.replaceChildren(...found.flatMap(([path, count]) => {
      const locked = lockedOf(path), why = said.has(locked) ? [] : [whyLocked(locked)];
      said.add(locked);
      return [...why, slider(path, count)];
    }));
  });
  if (!session.sketch.kernels.some((kernel) => kernel.between)) return [body];
  const box = make("input", { type: "checkbox", checked: session.interpolated });
  box.onchange = () => { session.interpolated = box.checked; };
  const name = make("span", { className: "name" }, words.interpolated);
  return [body, make("label", { className: "row" }, name, box)];
}
