// images.js -- what a page carries as bytes: blobs, and image files as textures.

import { failure } from "./context.js";
import { unpacked } from "./packed.js";

/** @typedef {ReturnType<typeof createImages>} Images */
/** @typedef {import("./textures.js").Texture} Texture */

/** @param {import("./textures.js").Textures} textures @param {import("./schema.js").Shared} shared */
export const createImages = (textures, shared) => {
  /** @type {Map<string, Promise<ArrayBuffer>>} */
  const asked = new Map();
  /** @type {Map<string, ArrayBuffer>} */
  const blobs = new Map();
  /** @type {Map<string, Texture>} */
  const made = new Map();

  /** @param {string} key */
  const loadBlob = async (key) => {
    if (blobs.has(key)) return;
    if (!asked.has(key)) asked.set(key, unpacked(shared.blobs[key]));
    blobs.set(key, await /** @type {Promise<ArrayBuffer>} */ (asked.get(key)));
    asked.delete(key);
  };

  /** Make the texture of an image file, if it is not made.
   *  @param {string} key @param {import("./schema.js").Sampling} sampling */
  const load = async (key, { mipmap, flip = false }) => {
    const image = shared.images[key], name = `${key} ${flip}`, known = made.get(name);
    if (!image) throw failure("no-image", `The page carries no image '${key}'.`);
    if (known && (known.levels > 1 || !mipmap)) return;
    const bytes = await unpacked(shared.blobs[image.blob]);
    const texels = image.file ? await decoded(bytes, image.file, flip) : inRows(bytes, image, flip);
    const texture = textures.texture(image.size, image.kind, mipmap);
    textures.write(texture, texels);
    if (mipmap) textures.buildLevels(texture);
    const before = made.get(name); // loaded meanwhile
    if (before) textures.release(before);
    made.set(name, texture);
  };

  return {
    load, loadBlob,

    /** Return the texture of an image that was loaded.
     *  @param {string} key @param {import("./schema.js").Sampling} sampling @returns {Texture} */
    get: (key, { flip = false }) => {
      const found = made.get(`${key} ${flip}`);
      if (!found) throw failure("no-image", `The image '${key}' is not loaded.`);
      return found;
    },

    /** Return the bytes of a blob that was loaded. @param {string} key @returns {ArrayBuffer} */
    blob: (key) => {
      const found = blobs.get(key);
      if (!found) throw failure("no-image", `The data '${key}' are not loaded.`);
      return found;
    },

    clear: () => {
      made.forEach(textures.release);
      made.clear();
      blobs.clear();
    },
  };
};

/** Return an image file's pixels as they are encoded, row 0 south unless `flip`.
 *  @param {ArrayBuffer} bytes @param {string} type @param {boolean} flip */
const decoded = (bytes, type, flip) => createImageBitmap(new Blob([bytes], { type }),
  { premultiplyAlpha: "none", colorSpaceConversion: "none", imageOrientation: flip ? "none" : "flipY" });

/** Return texels, their rows the other way round where `flip`.
 *  @param {ArrayBuffer} bytes @param {{size: [number, number], kind: string}} image @param {boolean} flip */
const inRows = (bytes, { size: [, height], kind }, flip) => {
  const all = kind === "rgba16f" ? new Uint16Array(bytes) : new Uint8Array(bytes), row = all.length / height;
  if (!flip) return all;
  const found = all.slice();
  for (let y = 0; y < height; y++) found.set(all.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
  return found;
};
