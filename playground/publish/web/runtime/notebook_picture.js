// notebook_picture.js -- a picture with sliders in a notebook whose browser cannot draw: the kernel does.
//
// While one is dragged, a change is sent only when the one before has been answered: so the
// newest position is drawn next, and none queue up. The answer is the message after the
// picture; it comes also where the picture is the same, or there is none.

import { make } from "./dom.js";
import { keepKeys } from "./notebook_sketch.js";

/** @typedef {Object<string, number>} Values */

/** The field of a control. @param {any} control @param {number} value */
function inputOf(control, value) {
  if (control.kind === "choice") {
    return make("select", {}, ...control.choices.map((/** @type {string} */ name, /** @type {number} */ at) =>
      make("option", { value: String(at), selected: at === value }, name)));
  }
  if (control.kind === "checkbox") return make("input", { type: "checkbox", checked: Boolean(value) });
  return make("input", { type: "range", min: control.low, max: control.high, step: control.step, value });
}

/** @param {{model: any, el: HTMLElement}} cell */
export function renderPicture({ model, el }) {
  el.classList.add("terrain-picture");
  const image = make("img", { alt: model.get("alt") });
  const mistake = make("p", { className: "mistake", role: "status" });
  const rows = make("div", { className: "rows" });
  keepKeys(rows);

  let url = "";
  let waiting = false;
  /** @type {Values | null} */
  let next = null;
  const show = () => {
    if (url) URL.revokeObjectURL(url);
    url = URL.createObjectURL(new Blob([model.get("picture")], { type: "image/png" }));
    image.src = url;
  };
  /** @param {Values} one @param {Values} other */
  const same = (one, other) => Object.keys(one).every((key) => one[key] === other[key]);
  function send(/** @type {Values} */ values) {
    if (waiting) { next = values; return; }
    if (same(values, model.get("values"))) return; // it would not be sent, and so not be answered
    waiting = true;
    model.set("values", values);
    model.save_changes();
  }
  function answered() {
    waiting = false;
    const values = next;
    next = null;
    if (values) send(values);
  }
  const showMistake = () => { mistake.textContent = model.get("mistake"); };
  const current = () => ({ ...model.get("values"), ...(next || {}) });

  for (const control of model.get("controls")) {
    const output = make("output"), input = inputOf(control, model.get("values")[control.key]);
    const isOn = () => /** @type {any} */ (input).checked;
    const read = () => Number(control.kind === "checkbox" ? isOn() : input.value);
    const showValue = () => {
      if (control.kind !== "range") return;
      const number = read();
      const text = `${+number.toPrecision(6)} ${control.unit}`;
      output.textContent = control.choices.length ? control.choices[number] : text;
    };
    input.addEventListener("input", () => { showValue(); send({ ...current(), [control.key]: read() }); });
    showValue();
    rows.append(make("label", {}, make("span", {}, control.label), input, output));
  }
  model.on("change:picture", show);
  model.on("change:mistake", showMistake);
  model.on("msg:custom", answered);
  el.append(image, rows, mistake);
  show();
  showMistake();
  return () => {
    model.off("change:picture", show);
    model.off("change:mistake", showMistake);
    model.off("msg:custom", answered);
    if (url) URL.revokeObjectURL(url);
  };
}

export default { render: renderPicture };
