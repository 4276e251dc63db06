// dom.js -- make elements; every text of a sketch enters as text, never as markup.

/** Make an element: properties by name, attributes where the name has a hyphen.
 *  @template {keyof HTMLElementTagNameMap} Kind
 *  @param {Kind} kind @param {Object<string, any>} [properties] @param {...(Node | string)} inside
 *  @returns {HTMLElementTagNameMap[Kind]} */
export function make(kind, properties = {}, ...inside) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role") made.setAttribute(name, String(value));
    else Object.assign(made, { [name]: value });
  }
  made.append(...inside);
  return made;
}

/** Make an element of SVG.
 *  @param {string} kind @param {Object<string, string | number>} attributes @param {...Node} inside */
export function svg(kind, attributes, ...inside) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...inside);
  return made;
}

/** A push button with a label.
 *  @param {string} label @param {() => void} act @param {Object<string, any>} [properties] */
export const button = (label, act, properties = {}) =>
  make("button", { type: "button", onclick: act, ...properties }, label);

/** Whether keys pressed there are typed into a field.
 *  @param {EventTarget | null} target */
export const isTyping = (target) =>
  target instanceof HTMLElement &&
  (target.matches("textarea, select, input:not([type=range]):not([type=checkbox])") ||
    target.isContentEditable);

/** Save a file under a name, as a browser does with what is downloaded.
 *  @param {Blob} data @param {string} name */
export function save(data, name) {
  const href = URL.createObjectURL(data);
  make("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

/** Put a text on the clipboard; false where the browser allows none.
 *  @param {string} text */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = make("textarea", { value: text, className: "unseen" });
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }
}
