// usual.js -- what other tools' shaders are given by their own names: Runner._usual of engine/runner.py.

import { unitVector } from "./directions.js";
import { stepsOf } from "./plan_nodes.js";

/** @typedef {import("./plan.js").Plan} Plan */
/** @typedef {import("./plan_nodes.js").Step} Step */

/** What only somebody at the page has; without them all is at rest. Pixels from the lower left.
 *  @typedef {object} Live
 *  @property {number[]} [mouse]   the pointer, then where it was pressed
 *  @property {number[]} [hover]   the pointer, pressed or not
 *  @property {number[]} [drag]    as ShaderToy's iMouse
 *  @property {number} [delta]     seconds since the last picture
 *  @property {number[]} [date]    year, month from 0, day, seconds */

const FRAME_RATE = 60;
const TEMPO = 2; // beats a second, of a sound that is not there
const IDENTITY = (/** @type {number} */ side) =>
  Array.from({ length: side * side }, (_, at) => (at % (side + 1) ? 0 : 1));

/** What never changes, by meaning: NEUTRAL of shader/reserved_names.py.
 *  @type {Object<string, number[]>} */
const NEUTRAL = {
  frame_rate: [60], sample_rate: [44100], forward: [0, 0, 1], none: [0], one: [1, 1, 1, 1],
  identity3: IDENTITY(3), identity4: IDENTITY(4),
};

/** How strong low, middle and high tones are at a time [s], each from 0 to 1: data/media.py.
 *  @param {number} time */
function bandsAt(time) {
  const since = (time * TEMPO) % 1;
  const [middle, high] = [3, 1.3].map((seconds) => 0.5 + 0.4 * Math.sin((2 * Math.PI * time) / seconds));
  return [Math.exp(-4 * (since < 0 ? since + 1 : since)), middle, high];
}

/** The place of the camera, and the unit vector towards the sun, of a sketch that has them.
 *  @param {Plan} plan */
function sceneOf(plan) {
  const steps = stepsOf(plan.nodes), { forward } = NEUTRAL;
  const directions = steps.flatMap((step) => step.kernel.parameters
    .filter((one) => one.widget === "direction")
    .map((one) => ({ name: one.name, value: step.values[one.name] })));
  const sun = directions.find(({ name }) => name === "sun") ?? directions[0];
  const drawn = steps.some((step) => step.kernel.kind === "draw");
  const light = sun ? unitVector(/** @type {[number, number]} */ (sun.value)) : forward;
  return { camera: drawn ? [...plan.eye.eye] : forward, light };
}

/** What the usual uniforms of a plain shader are given, by meaning: those that its text names.
 *  @param {Plan} plan @param {Step} step @param {number | null} frame of the loop around it that counts them
 *  @param {Live} live @returns {Object<string, number[]>} */
export function usualOf(plan, step, frame, live) {
  const [width, height] = step.size, time = frame === null ? plan.time : frame / FRAME_RATE;
  const { mouse = [0, 0, 0, 0], hover = [0, 0], drag = [0, 0, 0, 0], date = [1970, 0, 1, 0] } = live;
  const shown = Math.floor(FRAME_RATE * time + 1e-6);
  /** @type {Object<string, number[]>} */
  const known = {
    time: [time], resolution: [width, height, 1], square_resolution: [width, width, 1],
    buttons: [drag[2] > 0 ? 1 : 0, 0, 0, 0], mouse, drag, hover,
    hover_share: [hover[0] / width, hover[1] / height],
    delta: [frame === null ? live.delta ?? 1 / FRAME_RATE : 1 / FRAME_RATE],
    date, date_from_1: [date[0], date[1] + 1, ...date.slice(2)],
    frame: [shown], frame_of_time: [shown], bands: bandsAt(time), ...NEUTRAL,
  };
  const usual = step.kernel.usual ?? [], meanings = usual.map(([, meaning]) => meaning);
  const scene = meanings.some((meaning) => meaning === "camera" || meaning === "light") ? sceneOf(plan) : {};
  const all = { ...known, ...scene };
  return Object.fromEntries(meanings.filter((meaning) => meaning in all).map((meaning) => {
    return [meaning, all[/** @type {keyof typeof all} */ (meaning)]];
  }));
}
