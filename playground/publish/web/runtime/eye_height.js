// eye_height.js -- keeps the eye above the terrain: engine/eye_height.py.
//
// The terrain is what the first draw reads as its input `height`, if that draw names `relief` and the
// camera. Its
// texels are read once for each place of the eye; an eye outside the terrain is left where it is.

import { stepsOf } from "./plan_nodes.js";

/** @typedef {import("./plan.js").Plan} Plan */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {{path: string, output: string}} Ref */

const CLEARANCE = 0.002; // above the ground, as a share of the eye's distance from its target
const MAX_ELEVATION = 89; // degrees of elevation, at most

/** @param {(kernel: import("./schema.js").Kernel) => Set<string>} namesOf the names in a kernel's text */
export const createEyeHeight = (namesOf) => {
  let raisedBy = 0, terrainKey = "", read = "", height = 0;

  /** @param {Plan} plan @returns {Ref | null} */
  const terrainOf = (plan) => {
    for (const { kernel, inputs } of stepsOf(plan.nodes)) {
      const source = kernel.kind === "draw" && inputs.find(([name]) => name === "height")?.[1];
      if (!source || !("path" in source)) continue;
      const names = namesOf(kernel);
      if (names.has("relief") && names.has("clip_from_world")) return source;
    }
    return null;
  };

  /** Return where the eye is above the terrain, in shares of its sides; null outside it.
   *  @param {Plan} plan */
  const placeOf = ({ eye, terrain }) => {
    const [x, y] = [0, 1].map((axis) => eye.eye[axis] / terrain.extent[axis]);
    return x >= 0 && x <= 1 && y >= 0 && y <= 1 ? [x, y] : null;
  };

  /** Return a camera over the height that was read; null where the plan's own eye may stay.
   *  @param {Plan} plan @returns {Camera | null} */
  const over = (plan) => {
    const [x, y, z] = plan.eye.eye, lowest = height * plan.terrain.relief + CLEARANCE * plan.eye.distance;
    raisedBy = 0;
    if (!(z < lowest)) return null;
    raisedBy = lowest - z;
    const { target } = plan.eye, [east, north, up] = [x, y, lowest].map((side, axis) => side - target[axis]);
    const level = Math.hypot(east, north), degrees = 180 / Math.PI;
    return {
      ...plan.camera,
      azimuth: level > 0 ? Math.atan2(east, north) * degrees : plan.camera.azimuth,
      elevation: Math.min(Math.atan2(up, level) * degrees, MAX_ELEVATION),
      distance: Math.hypot(level, up),
      target: /** @type {[number, number, number]} */ ([...target]),
    };
  };

  return {
    /** By how many metres the last picture's eye was raised; 0: it was above the terrain. */
    get raisedBy() { return raisedBy; },

    /** Return a camera over the terrain where the last eye was raised over the same terrain, at the same
     *  place;
     *  null: the terrain must be drawn and read first.
     *  @param {Plan} plan @param {import("./staleness.js").Keys} keys */
    raisedAsBefore: (plan, keys) => {
      const source = raisedBy ? terrainOf(plan) : null, place = placeOf(plan);
      const isRead = !!source && keys.steps.get(source.path) === terrainKey && read.endsWith(` ${place}`);
      return isRead && place ? over(plan) : null;
    },

    /** Return a camera whose eye is over the terrain, or null where the plan's own is.
     *  @param {Plan} plan @param {import("./staleness.js").Keys} keys
     *  @param {(ref: Ref) => import("./binder.js").Wired | null} wired
     *  @param {(texture: import("./textures.js").Texture, corner: number[], size: number[]) => number[]}
     *  texels
     *  the first channel of a block of texels */
    raised: (plan, keys, wired, texels) => {
      const source = terrainOf(plan), place = placeOf(plan), found = source && wired(source);
      raisedBy = 0;
      if (!source || !place || !found) return null;
      const key = `${found.result.number} ${place}`;
      if (read !== key) {
        const { size } = found.texture, at = place.map((share, axis) => share * (size[axis] - 1));
        const low = at.map((all, axis) => Math.min(Math.trunc(all), Math.max(size[axis] - 2, 0)));
        const [wide, tall] = size.map((side) => Math.min(2, side));
        const block = texels(found.texture, low, [wide, tall]);
        const [p, q] = at.map((all, axis) => all - low[axis]);
        /** @param {number} i @param {number} j */
        const corner = (i, j) => block[Math.min(j, tall - 1) * wide + Math.min(i, wide - 1)];
        const [west, east] = [0, 1].map((i) => (1 - q) * corner(i, 0) + q * corner(i, 1));
        height = west * (1 - p) + east * p;
        read = key;
      }
      terrainKey = keys.steps.get(source.path) || "";
      return over(plan);
    },
  };
};
