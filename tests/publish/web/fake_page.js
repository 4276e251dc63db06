// fake_page.js -- a page over a player that draws without WebGL what its state says, for tests.

import { createPage } from "../../../playground/publish/web/runtime/sketch_page.js";
import { PAGE_WORDS } from "../../../playground/publish/web/runtime/page_words.js";

/** What a test looks at, and what it asks for: [ms] a million pixels take, and a third of the programs, an
 *  error to throw. */
const probe = { slow: 0, compiling: 10, error: "", frames: [], states: [], loads: [], opened: [], page: null };
globalThis.probe = probe;

const REPEATS = 24;

function open(sketch) {
  probe.opened.push(sketch.name);
  const state = {}, sheet = document.createElement("canvas");
  const value = (path) => state.values[path] ?? sketch.values[path];
  const player = {
    state,
    repeats: new Map([["height", REPEATS], ["view", 1]]),
    get plan() {
      const camera = state.camera ?? sketch.camera;
      return {
        eye: { distance: camera.distance || 4000, target: camera.target ?? [2048, 2048, 400] },
        terrain: state.terrain, time: state.time, frame: state.frame,
        steps: new Map([["height", { size: state.terrain.size }], ["view", { size: state.frame }]]),
      };
    },
    async load(progress) {
      const load = { map: state.map ?? null, before: probe.states.length };
      for (let done = 0; done <= 3; done++) {
        progress?.(done, 3);
        await new Promise((next) => setTimeout(next, probe.compiling));
      }
      probe.loads.push({ ...load, after: probe.states.length });
    },
    render() {
      if (probe.error) throw new Error(probe.error);
      const [width, height] = state.frame, end = performance.now() + (probe.slow * width * height) / 1e6;
      while (performance.now() < end);
      probe.frames.push([width, height]);
      probe.states.push(structuredClone(state));
      [sheet.width, sheet.height] = state.frame;
      const context = sheet.getContext("2d");
      state.map ? drawMap(context, width, height) : drawHills(context, width, height);
      return { ran: ["view"], milliseconds: 1 };
    },
    drawTo(context) { context.drawImage(sheet, 0, 0); },
    read({ path }) {
      const [wide, high] = path === "view" ? state.frame : state.terrain.size;
      const data = new Float32Array(wide * high);
      data.forEach((_, at) => { data[at] = height((at % wide) / wide, Math.floor(at / wide) / high); });
      return { size: [wide, high], channels: 1, data };
    },
    close() {},
  };
  const height = (x, y) => 0.5 + 0.25 * Math.sin(9 * x + 3 * y) + 0.2 * Math.sin(14 * y - 5 * x);

  function drawMap(context, width, high) {
    const picture = context.createImageData(width, high);
    for (let y = 0; y < high; y++) for (let x = 0; x < width; x++) {
      const grey = 255 * height(x / width, 1 - y / high);
      picture.data.set([grey, grey, grey, 255], 4 * (y * width + x));
    }
    context.putImageData(picture, 0, 0);
  }

  function drawHills(context, width, high) {
    const { azimuth } = state.camera, [sun] = value("light.sun"), grass = value("ground.grass");
    const sky = context.createLinearGradient(0, 0, 0, high);
    sky.addColorStop(0, "#4b6f9c");
    sky.addColorStop(1, "#c9d6dd");
    context.fillStyle = sky;
    context.fillRect(0, 0, width, high);
    for (let ridge = 0; ridge < 5; ridge++) {
      context.fillStyle = `rgb(${grass.map((light) => 255 * light ** 0.45 * (0.6 + 0.12 * ridge)).join(" ")})`;
      context.beginPath();
      context.moveTo(0, high);
      for (let x = 0; x <= width; x += 4) {
        const place = x / high + azimuth / 40 + ridge * 1.7 + sun / 500;
        const up = value("height.level") * (0.2 * Math.sin(3 * place) + 0.08 * Math.sin(9 * place + state.time));
        context.lineTo(x, high * (0.42 + 0.12 * ridge - up));
      }
      context.lineTo(width, high);
      context.fill();
    }
  }
  return player;
}

addEventListener("DOMContentLoaded", () => {
  const data = JSON.parse(document.getElementById("playground-page").textContent);
  probe.page = createPage(document.getElementById("playground"), data, { open }, {
    words: PAGE_WORDS.en,
    poster: document.getElementById("playground-poster"),
    repeats: (player) => player.repeats,
    openCode: (host) => host.append(Object.assign(document.createElement("textarea"), { value: "void main" })),
  });
});
