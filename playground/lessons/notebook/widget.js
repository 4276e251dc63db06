// widget.js -- a picture with sliders in a notebook.
//
// While one is dragged, a change is sent only when the picture of the one before has come:
// so the newest position is drawn next, and none queue up.
function render({ model, el }) {
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
  const send = (values) => {
    if (waiting) { next = values; return; }
    waiting = true;
    model.set("values", values);
    model.save_changes();
  };
  const answered = () => {
    waiting = false;
    if (next) { const values = next; next = null; send(values); }
  };
  const said = () => { mistake.textContent = model.get("mistake"); };
  const current = () => ({ ...model.get("values"), ...(next || {}) });

  for (const control of model.get("controls")) {
    const told = make("output");
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
    const tell = () => {
      if (control.kind !== "range") return;
      const number = read();
      told.textContent = control.choices.length ? control.choices[number] : `${+number.toPrecision(6)} ${control.unit}`;
    };
    input.addEventListener("input", () => { tell(); send({ ...current(), [control.key]: read() }); });
    tell();
    rows.append(make("label", {}, make("span", { textContent: control.label }), input, told));
  }
  const drawn = () => { show(); answered(); };
  // The same picture again, or a mistake, changes no picture: the kernel's answer ends the wait as well.
  const status = () => { said(); answered(); };
  model.on("change:picture", drawn);
  model.on("change:mistake", status);
  model.on("msg:custom", answered);
  el.append(image, rows, mistake);
  show();
  said();
  return () => {
    model.off("change:picture", drawn);
    model.off("change:mistake", status);
    model.off("msg:custom", answered);
    if (url) URL.revokeObjectURL(url);
  };
}
export default { render };
