// notebook_kernel.js -- players whose pictures the notebook's kernel draws, and sends as a JPEG or a PNG.
//
// One picture is asked for at a time, and the next is of the newest state: so a drag never queues. The answer
// is the message with the number of the question; it comes also where the kernel could not draw.

import { look } from "./camera.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {{drawn: string, error: string}} Answer */

let questions = 0;
const mine = Math.random().toString(36).slice(2); // several views of a widget hear each other's answers

/** @param {any} model of the widget @param {Sketch[]} sketches by side */
export function createKernelEngine(model, sketches) {
  /** @type {Map<string, (answer: Answer, buffers: DataView[]) => void>} */
  const waiting = new Map();
  const hear = (/** @type {Answer} */ answer, /** @type {DataView[]} */ buffers) => {
    const act = waiting.get(answer?.drawn);
    waiting.delete(answer?.drawn);
    act?.(answer, buffers);
  };
  model.on("msg:custom", hear);

  /** @param {Object<string, any>} draw @returns {Promise<ImageBitmap>} */
  const asked = (draw) => new Promise((resolve, reject) => {
    const id = `${mine}-${++questions}`;
    waiting.set(id, ({ error }, buffers) => {
      if (error) reject(new Error(error));
      else resolve(createImageBitmap(new Blob([/** @type {any} */ (buffers[0])])));
    });
    model.send({ draw: { id, ...draw } });
  });

  return {
    canvas: document.createElement("canvas"), // no context to be lost
    restore: async () => {},
    /** @param {Sketch} sketch @returns {import("./figure.js").Player} */
    open(sketch) {
      const side = sketches.indexOf(sketch);
      /** @type {ImageBitmap | null} */
      let picture = null;
      /** @type {Promise<ImageBitmap> | null} */
      let busy = null;
      let number = 0, closed = false;
      /** @type {any} */
      const player = {
        sketch, state: {}, plan: null, texts: {},
        load: async () => {},
        async renderSoon() {
          const own = ++number;
          while (busy) await busy.catch(() => {});
          if (own !== number || closed) return null; // a later call asks
          const { values, camera, time, frame, moving = false } = player.state, { terrain } = sketch;
          busy = asked({ side, values, camera, time, moving, size: frame });
          try {
            const found = await busy;
            if (closed) return null;
            picture?.close();
            picture = found;
            const eye = look(camera, terrain.extent, terrain.relief, frame);
            player.plan = { eye, terrain, picture: null };
            return { ran: [], milliseconds: 0 };
          } finally {
            busy = null;
          }
        },
        drawTo(/** @type {CanvasRenderingContext2D} */ context) {
          const { width, height } = context.canvas;
          if (picture) context.drawImage(picture, 0, 0, width, height);
        },
        read: () => { throw new Error("the kernel has the texels"); },
        close() {
          closed = true;
          picture?.close();
          picture = null;
        },
      };
      return player;
    },
    close() {
      model.off("msg:custom", hear);
      waiting.clear();
    },
  };
}
