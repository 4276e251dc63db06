// words.js -- every word of the interface in English; other languages have a table of their own.

import { addOns } from "./addons.js";

/** @typedef {Object<string, string>} Words */

/** @type {Words} */
export const ENGLISH = {
  // the picture
  picture: "{title}: the picture. Drag to orbit, wheel to zoom; press ? for the keys",
  loading: "Making the picture",
  working: "Computing",
  compiling: "Compiling {done} of {all} programs",
  failed: "The picture cannot be made: {reason}",
  kept: "This setting cannot be shown, the last picture stays: {reason}",
  frameTook: "{size}, {time} ms",
  still: "This is a still picture: {reason}",
  // the bar over the picture
  save: "Save picture",
  saved: "Saved {name}",
  notSaved: "This page does not hold what a version needs",
  full: "Full screen",
  leaveFull: "Leave full screen",
  resetView: "Reset the view",
  keys: "Keys",
  theme: "Light or dark",
  close: "Close",
  panel: "Show or hide the panel",
  tools: "Tools",
  // the panel
  parameters: "Parameters",
  code: "Code",
  search: "Search",
  noneFound: "No parameter is like that",
  main: "Main parameters",
  terrain: "Terrain",
  inside: "Inside: {count} more",
  technique: "Technique",
  preset: "Preset",
  presetChosen: "Preset {name}",
  reset: "Reset",
  resetAll: "Reset all",
  undo: "Undo",
  redo: "Redo",
  undone: "Undone",
  redone: "Redone",
  copyAs: "Copy",
  copyLink: "Link to these values",
  copyToml: "Values as TOML",
  copySet: "Values as --set",
  copied: "Copied",
  notCopied: "The browser allows no copying",
  nothingDiffers: "Nothing differs from the sketch",
  refused: "The link names what this page does not have: {names}",
  notes: "About this page",
  changedValues: "Values that differ from the sketch",
  azimuth: "azimuth",
  elevation: "elevation",
  hex: "as #rrggbb",
  size: "Texels",
  extent: "Extent",
  relief: "Relief",
  base_elevation: "Base elevation",
  // steps of repeats
  iterations: "Iterations",
  iterationsOf: "Iterations of {name}",
  allOf: "all {count}",
  interpolated: "Interpolated",
  // time
  time: "Time",
  seconds: "{time} s",
  play: "Play",
  pause: "Pause",
  speed: "Speed",
  keyframe: "keyframe",
  // maps
  map: "View",
  mapShown: "Map",
  ownPicture: "The picture",
  mapLabel: "{label} from above, north on top. Drag to move, wheel to enlarge",
  under: "Texel {x}, {y}",
  metresEast: "{x} m east, {y} m north",
  height: "{height} m high, {above} m above the sea",
  heightOnly: "{height} m high",
  pointAt: "Point at the map to read its values",
  fitValues: "Fit to the values",
  // keys
  keyOrbit: "orbit",
  keyPan: "move over the terrain",
  keyZoom: "nearer, farther",
  keyResetView: "reset the view",
  keyPlay: "play or pause",
  keyFrame: "a frame of time back, on",
  keyStart: "time to 0",
  keyMap: "the next map, or the picture",
  keySave: "save a PNG",
  keyPanel: "show or hide the panel",
  keySearch: "search the parameters",
  keyFull: "fill the screen, or no longer",
  keyUndo: "undo, redo",
  keyHelp: "show or hide these keys",
  keyClose: "close what is open",
  arrows: "Arrows",
  shiftArrows: "Shift+arrows",
  space: "Space",
  mouse:
    "With the mouse: drag to orbit, right drag or Shift+drag to move, wheel to zoom, double click to reset.",
  touch: "By touch: one finger orbits, two fingers move and zoom, a double tap resets.",
  rows: "In the panel: double click on a row resets it; drag on a name without a slider changes its number.",
};

/** The words of a language, by its tag; English where the page has none.
 *  @param {string} [language] */
export const wordsOf = (language = "en") => ((/^fr\b/i.test(language) && addOns.french) || ENGLISH);

/** Put values in the places of a text: fill("{time} s", {time: 2}).
 *  @param {string} text @param {Object<string, string | number>} values */
export const fill = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? ""));

/** A number of metres, or another number that is read, in as many digits as it needs.
 *  @param {number} number */
export const measured = (number) =>
  Math.abs(number) >= 1000
    ? number.toFixed(0)
    : Math.abs(number) >= 10
      ? number.toFixed(1)
      : number.toFixed(2);
