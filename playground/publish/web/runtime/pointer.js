// pointer.js -- what shaders are told of the pointer and the clock of the page, as the live window tells it.

/** @typedef {import("./usual.js").Live} Live */
/** @typedef {import("./schema.js").Sketch} Sketch */

/** Meanings of usual uniforms that the pointer changes: _MOUSE of sketch/traits.py. */
const POINTED = new Set(["mouse", "hover", "hover_share", "drag", "buttons"]);
const MAX_PAUSE = 1; // [s] between two pictures: more was a pause

/** Whether a shader of a sketch reads the pointer. @param {Sketch} sketch */
export const readsPointer = ({ kernels }) =>
  Object.values(kernels).some(({ usual = [] }) => usual.some(([, meaning]) => POINTED.has(meaning)));

/** The date as shaders have it: year, month from 0, day, seconds of the day. @param {Date} now */
export const dateOf = (now) => [
  now.getFullYear(), now.getMonth(), now.getDate(),
  3600 * now.getHours() + 60 * now.getMinutes() + now.getSeconds() + now.getMilliseconds() / 1000,
];

/** Follow the first pointer over an element; `changed` is called when it moves, presses or lets go.
 *  @param {HTMLElement} element @param {() => void} changed */
export function followPointer(element, changed) {
  /** @type {[number, number]} shares of the element, from its lower left */
  let place = [0, 0], at = place, from = place;
  let held = -1, clicked = false, told = false, began = false, last = 0;

  /** @param {PointerEvent} event */
  function take(event) {
    const box = element.getBoundingClientRect();
    const across = (event.clientX - box.left) / Math.max(box.width, 1);
    place = [across, (box.bottom - event.clientY) / Math.max(box.height, 1)];
    if (held >= 0) at = place;
    changed();
  }
  element.addEventListener("pointerdown", (event) => {
    if (held >= 0 || event.button !== 0) return;
    held = event.pointerId;
    clicked = began = true;
    told = false;
    take(event);
    from = place;
  });
  element.addEventListener("pointermove", (event) => {
    if (held < 0 || event.pointerId === held) take(event);
  });
  for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) {
    element.addEventListener(name, (event) => {
      if (event.pointerId !== held) return;
      take(event);
      held = -1;
      changed();
    });
  }

  return {
    /** What a picture is told. @param {[number, number]} size in pixels @param {boolean} playing
     *  @returns {Live} */
    live(size, playing) {
      const pixels = (/** @type {number[]} */ share) => share.map((part, i) => part * size[i]);
      const now = performance.now(), delta = (now - last) / 1000;
      last = now;
      const [x, y] = pixels(from), down = held >= 0;
      /** @type {Live} */
      const found = { hover: pixels(place), date: dateOf(new Date()) };
      if (began) {
        found.mouse = [...pixels(at), x, y];
        found.drag = [...pixels(at), down || clicked ? x : -x, clicked ? y : -y];
      }
      if (playing && delta < MAX_PAUSE) found.delta = delta;
      told = clicked;
      return found;
    },
    /** A picture was drawn: a press is new no longer; returns whether that asks for another. */
    drawn() {
      const was = clicked && told;
      if (was) clicked = false;
      return was;
    },
  };
}
