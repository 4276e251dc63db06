// notebook_picture.js -- a picture with sliders in a notebook whose browser cannot draw: the kernel does.
//
// While one is dragged, a change is sent only when the one before has been answered: so the
// newest position is drawn next, and none queue up. The answer is the message after the
// picture; it comes also where the picture is the same, or there is none.
/** @param {{model: any, el: HTMLElement}} cell */
export function renderPicture({ model, el }) {
  const make = (name, properties = {}, ...inside) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...inside);
    return element;
  };
  el.classList.add("terrain-picture");
  const image = make("img", { alt: model.get("alt") });
  const mistake = make("p", { className: "mistake" });
  mistake.setAttribute("role", "status");
  const rows = make("div", { className: "rows" });

  let url = "";
  let waiting = false;
  let next = null;
  const show = () => {
    const bytes = model.get("picture");
    if (url) URL.revokeObjectURL(url);
    url = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
    image.src = url;
  };
  const same = (one, other) => Object.keys(one).every((key) => one[key] === other[key]);
  const send = (values) => {
    if (waiting) { next = values; return; }
    if (same(values, model.get("values"))) return; // it would not be sent, and so not be answered
    waiting = true;
    model.set("values", values);
    model.save_changes();
  };
  const answered = () => {
    waiting = false;
    if (next) { const values = next; next = null; send(values); }
  };
  const showMistake = () => { mistake.textContent = model.get("mistake"); };
  const current = () => ({ ...model.get("values"), ...(next || {}) });

  for (const control of model.get("controls")) {
    const output = make("output");
    const value = model.get("values")[control.key];
    let input;
    if (control.kind === "choice") {
      input = make("select");
      control.choices.forEach((name, i) => input.append(make("option", { value: i, textContent: name, selected: i === value })));
    } else if (control.kind === "checkbox") {
      input = make("input", { type: "checkbox", checked: Boolean(value) });
    } else {
      input = make("input", { type: "range", min: control.low, max: control.high, step: control.step });
      input.value = value;
    }
    const read = () => (control.kind === "checkbox" ? Number(input.checked) : Number(input.value));
    const showValue = () => {
      if (control.kind !== "range") return;
      const number = read();
      output.textContent = control.choices.length ? control.choices[number] : `${+number.toPrecision(6)} ${control.unit}`;
    };
    input.addEventListener("input", () => { showValue(); send({ ...current(), [control.key]: read() }); });
    showValue();
    rows.append(make("label", {}, make("span", { textContent: control.label }), input, output));
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
