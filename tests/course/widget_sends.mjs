// Drag the control of a picture's widget, with a model that answers as a kernel does, and print what was sent.
//
// The document is as much of one as the widget uses. Of each line of the output, "sent" is all that has been sent.
import { pathToFileURL } from "node:url";

class Element {
  constructor(name) {
    Object.assign(this, { name, inside: [], attributes: {}, heard: {} });
    this.classList = { add() {} };
  }
  append(...inside) { this.inside.push(...inside); }
  setAttribute(name, value) { this.attributes[name] = value; }
  addEventListener(name, listener) { this.heard[name] = listener; }
  find(name) { return this.name === name ? this : this.inside.map((each) => each.find?.(name)).find(Boolean); }
}
globalThis.document = { createElement: (name) => new Element(name) };

const state = {
  picture: new Uint8Array(),
  alt: "A land.",
  mistake: "",
  values: { a: 0 },
  controls: [{ key: "a", label: "A", kind: "range", low: 0, high: 1, step: 0.1, choices: [], unit: "" }],
};
const sent = [];
const heard = {};
let changed = false;
const model = {
  get: (key) => state[key],
  set(key, value) {
    changed = JSON.stringify(state[key]) !== JSON.stringify(value);
    state[key] = value;
  },
  // What is as it was is not sent, and so has no answer.
  save_changes() { if (changed) sent.push(state.values.a); changed = false; },
  on: (name, listener) => { heard[name] = listener; },
  off() {},
};
const { default: widget } = await import(pathToFileURL(process.argv[2]));
const root = new Element("div");
widget.render({ model, el: root });
const input = root.find("input");
for (const word of process.argv.slice(3)) {
  if (word === "picture") { state.picture = new Uint8Array([sent.length]); heard["change:picture"](); }
  else if (word === "mistake") { state.mistake = "no"; heard["change:mistake"](); }
  else if (word === "drawn") heard["msg:custom"]({ drawn: true });
  else { input.value = word; input.heard.input(); }
}
console.log(JSON.stringify(sent));
