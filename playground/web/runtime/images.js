// images.js -- what a page carries as bytes: blobs, and image files as textures.

import { failure } from "./context.js";

/** @typedef {ReturnType<typeof createImages>} Images */
/** @typedef {import("./textures.js").Texture} Texture */

/** Return the bytes of a blob: gzip in base64. @param {string} text @returns {Promise<ArrayBuffer>} */
export const unpacked = async (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

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

  /** Make the texture of an image file, if it is not made. @param {string} key @param {boolean} levels */
  const load = async (key, levels) => {
    const image = shared.images[key];
    if (!image) throw failure("no-image", `The page carries no image '${key}'.`);
    const known = made.get(key);
    if (known && (known.levels > 1 || !levels)) return;
    /** @type {ArrayBufferView | ImageBitmap} */
    let texels;
    if (image.file) texels = await decoded(await unpacked(shared.blobs[image.blob]));
    else {
      await loadBlob(image.blob);
      const bytes = /** @type {ArrayBuffer} */ (blobs.get(image.blob));
      texels = image.kind === "rgba16f" ? new Uint16Array(bytes) : new Uint8Array(bytes);
      blobs.delete(image.blob);
    }
    const texture = textures.texture(image.size, image.kind, levels);
    textures.write(texture, texels);
    if (levels) textures.buildLevels(texture);
    if (known) textures.release(known);
    made.set(key, texture);
  };

  return {
    load, loadBlob,

    /** Return the texture of an image that was loaded. @param {string} key @returns {Texture} */
    get: (key) => {
      const found = made.get(key);
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

/** Return an image file's pixels as they are encoded, row 0 south. @param {ArrayBuffer} bytes */
const decoded = (bytes) => createImageBitmap(new Blob([bytes]),
  { premultiplyAlpha: "none", colorSpaceConversion: "none", imageOrientation: "flipY" });
