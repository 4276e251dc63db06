// pads.js -- squares to drag a dot in: the sky as a disc for a direction, a rectangle for a point.

import { svg } from "./dom.js";
import { clamp, rangeOf } from "./numbers.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {{element: SVGElement, show: (value: number[]) => void}} Pad */

const DEGREE = Math.PI / 180;

/** Where a direction is on the unit disc, right and up: the zenith in its middle, the horizon its rim.
 *  @param {number} azimuth @param {number} elevation degrees @returns {[number, number]} */
export function dotOf(azimuth, elevation) {
  const radius = 1 - clamp(elevation, 0, 90) / 90;
  return [radius * Math.sin(azimuth * DEGREE), radius * Math.cos(azimuth * DEGREE)];
}

/** The direction at a place of the unit disc, or at the nearest on its rim.
 *  @param {number} right @param {number} up @returns {[number, number]} azimuth, elevation in degrees */
export function directionAt(right, up) {
  const radius = Math.min(Math.hypot(right, up), 1);
  return [(Math.atan2(right, up) / DEGREE + 360) % 360, 90 * (1 - radius)];
}

/** The ranges of a point's two numbers.
 *  @param {Shown} one @returns {[number, number][]} */
export const axesOf = (one) => [0, 1].map((part) => rangeOf(one, part) ?? [0, 1]);

/** A number in as many places as a pad can be pointed to.
 *  @param {number} number @param {[number, number]} range */
export function rounded(number, [low, high]) {
  const places = clamp(4 - Math.floor(Math.log10(high - low) + 1e-9), 1, 9);
  return clamp(+number.toFixed(places), low, high);
}

/** Make a pad; `changed` gets the new value of each drag.
 *  @param {Shown} one @param {(value: number[]) => void} changed @returns {Pad} */
export function makePad(one, changed) {
  const sky = one.widget === "direction";
  const dot = svg("circle", { r: 0.11, class: "dot" });
  const lines = sky
    ? [1, 2 / 3, 1 / 3].map((r) => svg("circle", { r, class: "line" }))
    : ["x", "y"].map(() => svg("line", { class: "line" }));
  const ground = sky
    ? svg("circle", { r: 1, class: "ground" })
    : svg("rect", { x: -1, y: -1, width: 2, height: 2, class: "ground" });
  const ray = svg("line", { class: "ray" });
  const north = svg("path", { d: "M-.08-.72v-.2l.16.2v-.2", class: "line" });
  const element = /** @type {SVGElement} */ (
    svg(
      "svg",
      { viewBox: "-1.06 -1.06 2.12 2.12", class: "pad", "aria-hidden": "true" },
      ground,
      ...lines,
      ...(sky ? [north, ray] : []),
      dot,
    )
  );
  const point = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect();
    const right = 2.12 * ((event.clientX - box.left) / box.width - 0.5),
      up = 2.12 * (0.5 - (event.clientY - box.top) / box.height);
    if (sky) return directionAt(right, up).map((degrees) => +degrees.toFixed(1));
    return axesOf(one).map((range, at) =>
      rounded(range[0] + ((at ? up : right) + 1) * 0.5 * (range[1] - range[0]), range),
    );
  };
  element.onpointerdown = (event) => {
    if (one.locked || event.button) return;
    event.preventDefault();
    element.setPointerCapture(event.pointerId);
    changed(point(event));
  };
  element.onpointermove = (event) => element.hasPointerCapture(event.pointerId) && changed(point(event));
  const show = (/** @type {number[]} */ value) => {
    const share = (/** @type {number} */ at) => {
      const [low, high] = axesOf(one)[at];
      return (2 * (value[at] - low)) / (high - low) - 1;
    };
    const [x, y] = sky ? dotOf(value[0], value[1]) : [share(0), share(1)];
    const place = (/** @type {Element} */ shape, /** @type {Object<string, number>} */ at) =>
      Object.entries(at).forEach(([name, number]) => shape.setAttribute(name, String(number)));
    place(dot, { cx: x, cy: -y });
    dot.classList.toggle("below", sky && value[1] < 0);
    if (sky) place(ray, { x2: x, y2: -y });
    else {
      place(lines[0], { x1: x, x2: x, y1: -1, y2: 1 });
      place(lines[1], { y1: -y, y2: -y, x1: -1, x2: 1 });
    }
  };
  return { element, show };
}
