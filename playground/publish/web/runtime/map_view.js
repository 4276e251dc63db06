// map_view.js -- any texture from above: where its picture lies in a room, and what is under a place.

import { clamp, general } from "./numbers.js";
import { fill, measured } from "./words.js";

/** @typedef {{size: [number, number], channels: number, data: ArrayLike<number>}} Texels */
/** @typedef {{path: string, output: string, label: string, height: boolean}} Texture */

const MAX_MAP_SIDE = 2048; // pixels of a side of a map
const CLOSEST = 64; // pixels of the screen a texel may have

/** Where a map lies in its room: its place in the middle (shares, y down), how much it is enlarged.
 *  @typedef {{x: number, y: number, zoom: number}} View */

/** @type {View} */
export const WHOLE = { x: 0.5, y: 0.5, zoom: 1 };

/** Whether a texture is the view's, and so lies over the picture, not over the terrain.
 *  @param {string} path */
export const isOfView = (path) => path === "view" || path.startsWith("view.");

/** The size at which a map of a texture is drawn: a pixel a texel, where that is not too many.
 *  @param {[number, number]} texels @returns {[number, number]} */
export function sheetOf(texels) {
  const less = Math.min(1, MAX_MAP_SIDE / Math.max(...texels));
  return [Math.max(Math.round(texels[0] * less), 1), Math.max(Math.round(texels[1] * less), 1)];
}

/** Pixels of the room for one of the sheet. @param {[number, number]} sheet
 *  @param {[number, number]} room @param {View} view */
export const scaleOf = (sheet, room, view) => Math.min(room[0] / sheet[0], room[1] / sheet[1]) * view.zoom;

/** @param {View} view @returns {View} with its middle on the sheet */
const held = (view) => ({ x: clamp(view.x), y: clamp(view.y), zoom: view.zoom });

/** @param {View} view @param {[number, number]} sheet @param {[number, number]} room
 *  @param {number} right @param {number} down pixels */
export function movedView(view, sheet, room, right, down) {
  const scale = scaleOf(sheet, room, view);
  return held({ ...view, x: view.x - right / (sheet[0] * scale), y: view.y - down / (sheet[1] * scale) });
}

/** Enlarge around a place of the room, which stays where it is.
 *  @param {View} view @param {[number, number]} sheet @param {[number, number]} room
 *  @param {number} factor @param {[number, number]} place */
export function zoomedView(view, sheet, room, factor, place) {
  const most = CLOSEST / scaleOf(sheet, room, WHOLE),
    zoom = clamp(view.zoom * factor, 1, Math.max(most, 1));
  if (zoom === 1) return WHOLE;
  const before = scaleOf(sheet, room, view),
    after = scaleOf(sheet, room, { ...view, zoom });
  const shift = (/** @type {number} */ at) =>
    ((place[at] - room[at] / 2) * (1 / before - 1 / after)) / sheet[at];
  return held({ x: view.x + shift(0), y: view.y + shift(1), zoom });
}

/** Paint a map into a canvas as large as the room.
 *  @param {CanvasRenderingContext2D} context @param {CanvasImageSource} picture
 *  @param {[number, number]} sheet @param {View} view */
export function paintMap(context, picture, sheet, view) {
  const { width, height } = context.canvas,
    scale = scaleOf(sheet, [width, height], view);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, width, height);
  context.imageSmoothingEnabled = scale < 1;
  context.imageSmoothingQuality = "high";
  const left = width / 2 - view.x * sheet[0] * scale,
    top = height / 2 - view.y * sheet[1] * scale;
  context.drawImage(picture, left, top, sheet[0] * scale, sheet[1] * scale);
}

/** The texel at a place of the room, from the south-west; null outside.
 *  @param {[number, number]} place @param {[number, number]} room @param {View} view
 *  @param {[number, number]} sheet
 *  @param {[number, number]} texels @returns {[number, number] | null} */
export function texelAt(place, room, view, sheet, texels) {
  const scale = scaleOf(sheet, room, view);
  const across = (place[0] - room[0] / 2) / scale + view.x * sheet[0],
    down = (place[1] - room[1] / 2) / scale + view.y * sheet[1];
  // As view/map.glsl lays a texture into its picture: its proportions kept, in the middle.
  const worst = Math.max(texels[0] / sheet[0], texels[1] / sheet[1]);
  const x = Math.floor((across - sheet[0] / 2) * worst + texels[0] / 2);
  const y = Math.floor((sheet[1] / 2 - down) * worst + texels[1] / 2);
  return x >= 0 && y >= 0 && x < texels[0] && y < texels[1] ? [x, y] : null;
}

/** A map's channel and range that suit a texture: one or two components as a number from its lowest to its
 *  highest, three or four as a colour. By the names of view/map's parameters.
 *  @param {Texels} texels @returns {Object<string, number>} */
export function fitted({ channels, data }) {
  if (channels > 2) return { channel: 0, lowest: 0, highest: 1 };
  let lowest = Infinity,
    highest = -Infinity;
  for (let at = 0; at < data.length; at += channels) {
    if (!Number.isFinite(data[at])) continue;
    lowest = Math.min(lowest, data[at]);
    highest = Math.max(highest, data[at]);
  }
  return lowest < highest ? { channel: 1, lowest, highest } : { channel: 1, lowest: 0, highest: 1 };
}

/** What there is at a texel, a line each.
 *  @param {Texels} texels @param {[number, number]} texel @param {boolean} isHeight
 *  @param {{extent: number[], relief: number, base_elevation: number}} terrain
 *  @param {boolean} onTerrain @param {Object<string, string>} words */
export function linesAt({ size, channels, data }, [x, y], isHeight, terrain, onTerrain, words) {
  const values = Array.from({ length: channels }, (_, at) => data[(y * size[0] + x) * channels + at]);
  const lines = [fill(words.under, { x, y })];
  if (onTerrain) {
    const [east, north] = [
      ((x + 0.5) / size[0]) * terrain.extent[0],
      ((y + 0.5) / size[1]) * terrain.extent[1],
    ];
    lines.push(fill(words.metresEast, { x: measured(east), y: measured(north) }));
  }
  if (isHeight && Number.isFinite(values[0])) {
    const height = values[0] * terrain.relief,
      above = height + terrain.base_elevation;
    const text = terrain.base_elevation ? words.height : words.heightOnly;
    lines.push(fill(text, { height: height.toFixed(2), above: above.toFixed(2) }));
  }
  lines.push(values.map((value) => general(value, 6)).join("  "));
  return lines;
}
