// steering.js -- what gestures over a figure change: the camera, the sun, a line between two pictures, a map.

import { fieldFor, moved, sunMoved, turned, zoomed } from "./camera.js";
import { clamp } from "./numbers.js";
import { cameraAt } from "./values.js";

/** @import { Eye } from "./camera.js"
 *  @import { FigureMap } from "./figure_map.js"
 *  @import { Camera, Sketch } from "./schema.js"
 *  @import { Session } from "./session.js"
 *  @import { Live } from "./plain.js" */

// ── What shaders are told of the pointer and the clock of the page, as the live window tells it.

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

// ── Mouse, pen, fingers and wheel over an element, as what they mean: turn, move, zoom, reset.

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
function followGestures(element, meanings, { sideways = false, wheel = () => true } = {}) {
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

// ── What gestures over a figure change

const GRAB = 6; // [CSS pixels] from a line between two pictures

/** @param {HTMLElement} canvas @param {Session} session @param {FigureMap} map
 *  @param {{box: () => [number, number], eye: () => Eye | undefined, inText: boolean}} figure */
export function steerWith(canvas, session, map, { box, eye, inText }) {
  let held = "";
  /** Keyframes' camera goes on from where it is. @param {(now: Camera, eye: Eye) => Camera} change */
  function steer(change) {
    const from = eye(), now = cameraAt(session.sketch, session.camera, session.time);
    // Several gestures may come between two frames: the eye is that of the last frame.
    const distance = now.distance || from?.distance || 0, target = now.target ?? from?.target;
    if (from && target) session.setCamera(change(now, { ...from, distance, target }));
  }

  const turn = (/** @type {number} */ across, /** @type {number} */ down) =>
    session.map ? map.move(across, down) : steer((now) => turned(now, across, down));

  function move(/** @type {number} */ across, /** @type {number} */ down) {
    if (session.map) return map.move(across, down);
    return steer((now, from) => {
      const field = fieldFor(now.field_of_view, session.sketch.frame, box());
      return moved(now, from, field, across, down);
    });
  }

  const zoom = (/** @type {number} */ notches, x = box()[0] / 2, y = box()[1] / 2) =>
    session.map ? map.zoom(notches, x, y) : steer((now, from) => zoomed(now, from, notches));

  const resetView = () => (session.map ? map.reset() : session.setCamera(null));

  const rowsOf = (/** @type {string} */ widget) =>
    session.sketch.shown.filter((row) => row.exported && row.widget === widget && !row.locked);

  /** Take the line that is nearest to a place, if it is near. */
  function grab(/** @type {number} */ x) {
    const away = (/** @type {string} */ path) => Math.abs(Number(session.value(path)) * box()[0] - x);
    const paths = session.map ? [] : rowsOf("divider").map(({ path }) => path);
    paths.sort((a, b) => away(a) - away(b));
    held = paths.length && away(paths[0]) <= GRAB ? paths[0] : "";
    return held !== "";
  }

  /** Move the sun: every direction that the passes show, those of the view where no other has one. */
  function light(/** @type {number} */ across, /** @type {number} */ up) {
    const suns = rowsOf("direction"), terrain = suns.filter((row) => row.pass !== "view");
    /** @type {[string, number[]][]} */
    const news = (terrain.length ? terrain : suns).map(({ path }) => [
      path, sunMoved(/** @type {number[]} */ (session.value(path)), across, up),
    ]);
    if (news.length) session.setAll(news, "light");
  }

  const drag = (/** @type {number} */ x) => session.set(held, +clamp(x / box()[0]).toFixed(4));
  const wheel = () => !inText || document.activeElement === canvas;
  const meanings = { turn, move, zoom, reset: resetView, grab, drag, light, hover: map.hover };
  followGestures(canvas, meanings, { sideways: inText, wheel });
  return { turn, move, zoom, resetView };
}
