// gestures.js -- mouse, pen, fingers and wheel over an element, as what they mean: turn, move, zoom, reset.

/** Places are CSS pixels from the element's upper left corner; differences are in shares of its height.
 *  @typedef {object} Meanings
 *  @property {(across: number, down: number) => void} turn
 *  @property {(across: number, down: number) => void} move
 *  @property {(notches: number, x: number, y: number) => void} zoom   positive: nearer
 *  @property {() => void} reset                                        a double click or tap
 *  @property {(x: number, y: number) => boolean} [grab]   whether something else is held from there
 *  @property {(x: number) => void} [drag]                              and is now there
 *  @property {(across: number, up: number) => void} [light]            a drag with Ctrl
 *  @property {(place: [number, number] | null) => void} [hover] */

const NOTCH = 100; // [CSS pixels] of a wheel's scroll
const LINES = 3; // of a notch, where a wheel counts lines
const TWICE = 300; // [ms] between two taps
const NEAR = 25; // [CSS pixels]

/** @param {WheelEvent} event @returns {number} notches forward */
function notchesOf(event) {
  const lines =
    event.deltaMode === 1
      ? event.deltaY / LINES
      : event.deltaMode === 2
        ? event.deltaY
        : event.deltaY / NOTCH;
  // A pinch on a touchpad arrives as small scrolls with Ctrl.
  const notches = -lines * (event.ctrlKey && event.deltaMode === 0 && Math.abs(event.deltaY) < 50 ? 8 : 1);
  return Math.min(Math.max(notches, -4), 4);
}

/** Follow gestures. @param {HTMLElement} element @param {Meanings} meanings
 *  @param {{sideways?: boolean, wheel?: () => boolean}} [options]
 *  `sideways`: a finger that goes up or down scrolls the page; `wheel`: whether the wheel zooms now */
export function followGestures(element, meanings, { sideways = false, wheel = () => true } = {}) {
  /** @type {Map<number, {x: number, y: number}>} */
  const fingers = new Map();
  let mode = "",
    tapped = 0,
    tap = { x: 0, y: 0 },
    far = 0,
    several = false;
  element.style.touchAction = sideways ? "pan-y" : "none";
  const place = (/** @type {MouseEvent} */ event) => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top, height: Math.max(box.height, 1) };
  };
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, far: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 8) };
  };

  element.addEventListener("pointerdown", (event) => {
    const { x, y } = place(event);
    if (fingers.size === 0) {
      [far, several] = [0, false];
      if (event.ctrlKey && event.button === 0 && meanings.light) mode = "light";
      else if (event.button === 0 && !event.shiftKey && meanings.grab?.(x, y)) mode = "grab";
      else mode = event.button === 2 || event.button === 1 || event.shiftKey ? "move" : "turn";
    } else several = true;
    fingers.set(event.pointerId, { x, y });
    // A page that scripts drive may have no such pointer.
    try {
      element.setPointerCapture(event.pointerId);
    } catch {
      /* the gesture ends at the element's edge */
    }
    if (event.button === 1) event.preventDefault(); // the page would scroll by itself
  });
  element.addEventListener("pointermove", (event) => {
    const { x, y, height } = place(event),
      before = fingers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") meanings.hover?.([x, y]);
      return;
    }
    const [across, down] = [(x - before.x) / height, (y - before.y) / height];
    far += Math.abs(x - before.x) + Math.abs(y - before.y);
    if (fingers.size === 2) {
      const start = spread();
      fingers.set(event.pointerId, { x, y });
      const end = spread();
      meanings.move((end.x - start.x) / height, (end.y - start.y) / height);
      meanings.zoom(Math.log(end.far / start.far) / Math.log(1 / 0.88), end.x, end.y);
      return;
    }
    fingers.set(event.pointerId, { x, y });
    if (fingers.size > 2 || !(across || down)) return;
    if (mode === "grab") meanings.drag?.(x);
    else if (mode === "light") meanings.light?.(across, -down);
    else if (mode === "move") meanings.move(across, down);
    else meanings.turn(across, down);
    meanings.hover?.([x, y]);
  });
  const end = (/** @type {PointerEvent} */ event) => {
    if (!fingers.delete(event.pointerId) || event.type !== "pointerup" || fingers.size) return;
    if (event.pointerType !== "touch" || several || far > NEAR / 2) return;
    const { x, y } = place(event),
      near = Math.hypot(x - tap.x, y - tap.y) < NEAR;
    if (near && event.timeStamp - tapped < TWICE) {
      tapped = 0;
      meanings.reset();
    } else [tapped, tap] = [event.timeStamp, { x, y }];
    meanings.hover?.([x, y]);
  };
  for (const name of /** @type {const} */ (["pointerup", "pointercancel"]))
    element.addEventListener(name, end);
  element.addEventListener(
    "pointerleave",
    (event) => event.pointerType !== "touch" && meanings.hover?.(null),
  );
  element.addEventListener("dblclick", (event) => {
    if (mode === "turn") meanings.reset();
    event.preventDefault();
  });
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener(
    "wheel",
    (event) => {
      if (!wheel()) return;
      event.preventDefault();
      const { x, y } = place(event);
      meanings.zoom(notchesOf(event), x, y);
    },
    { passive: false },
  );
}
