// notebook_sketch.js -- the widget of a sketch, or of two: pictures, sliders, time, bound to a model.
//
// Traits: `page` holds all that a browser draws of (gzip in base64), or `outline` what can be dragged where
// the kernel draws; `sides` names the traits with values by path, one for each sketch; `camera`, `time` and
// `playing` are those of all.

import { createBookRecovery, makePicture, makeReset, makeRows, makeSwipe } from "./book_figure.js";
import { bookWords } from "./book_words.js";
import { look } from "./camera.js";
import { make } from "./dom.js";
import { createEngine } from "./engine.js";
import { grouped, labelOf } from "./labels.js";
import { unpackedJson } from "./packed.js";
import { lackOf } from "./recovery.js";
import { createSession } from "./session.js";
import { createTimeline, hasTime } from "./timeline.js";
import { isSame } from "./values.js";
import { fill, wordsOf } from "./words.js";

/** @import { Model } from "./notebook_live.js"
 *  @import { Sketch } from "./schema.js"
 *  @import { Session } from "./session.js" */

// ── Keys that a figure takes, such as arrows on a slider, from the notebook.

/** Keep keys pressed in an element from the notebook around it, but those held with Ctrl, Alt or Meta, Enter
 *  with Shift, and Escape. @param {HTMLElement} host */
export function keepKeys(host) {
  host.addEventListener("keydown", (event) => {
    const { key, ctrlKey, altKey, metaKey, shiftKey } = event;
    if (!ctrlKey && !altKey && !metaKey && key !== "Escape" && !(shiftKey && key === "Enter"))
      event.stopPropagation();
  });
}

// ── A figure as light or dark as the notebook around it, whichever program shows that.
//
// Programs say their theme in different ways; what they have in common is that text can be read on it.

const JUPYTER = "data-jp-theme-light"; // the attribute by which JupyterLab says its theme
const MIDDLE = 128; // of 255: a text that is lighter stands on something dark

/** Whether a colour, as a browser computes it, is light. @param {string} colour */
function isLight(colour) {
  const [red = 0, green = 0, blue = 0] = (colour.match(/[\d.]+/g) ?? []).map(Number);
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > MIDDLE;
}

/** Follow the theme of what is around an element; returns what ends that. @param {HTMLElement} host */
export function followTheme(host) {
  const show = () => {
    const { parentElement } = host;
    if (parentElement) host.classList.toggle("dark", isLight(getComputedStyle(parentElement).color));
  };
  const changes = new MutationObserver(() => requestAnimationFrame(show));
  for (const of of [document.documentElement, document.body])
    changes.observe(of, { attributes: true, attributeFilter: ["class", "style", "theme", JUPYTER] });
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  scheme.addEventListener("change", show);
  show();
  return () => {
    changes.disconnect();
    scheme.removeEventListener("change", show);
  };
}

// ── What a widget of sketches says besides the words of a book's figures.

/** @type {import("./words.js").Table} */
export const NOTEBOOK_WORDS = {
  en: {
    allParameters: "All parameters",
    byBrowser: "Drawn by this browser.",
    byKernel: "Drawn by the kernel: {reason}.",
    dragHere: "Drag to orbit; wheel after a click to zoom.",
  },
  fr: {
    allParameters: "Tous les paramètres",
    byBrowser: "Dessiné par ce navigateur.",
    byKernel: "Dessiné par le noyau : {reason}.",
    dragHere: "Glisser pour tourner ; molette après un clic pour zoomer.",
  },
};

/** All words of a widget. @param {string} language */
export const notebookWords = (language) => ({ ...bookWords(language), ...wordsOf(language, NOTEBOOK_WORDS) });

// ── Players whose pictures the notebook's kernel draws, and sends as a JPEG or a PNG.
//
// One picture is asked for at a time, and the next is of the newest state: so a drag never queues. The answer
// is the message with the number of the question; it comes also where the kernel could not draw.

/** @typedef {{drawn: string, error: string}} Answer */

let questions = 0;
const mine = Math.random().toString(36).slice(2); // several views of a widget hear each other's answers

/** @param {any} model of the widget @param {Sketch[]} sketches by side */
function createKernelEngine(model, sketches) {
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

// ── The widget of a sketch, or of two

/** @typedef {Object<string, string>} Words */

const BYTES = 384 * 2 ** 20; // of textures of one widget
const NARROW = 360; // [CSS pixels] that rows get below a smaller picture
const OFTEN = 200; // [ms] between two times that are told while time goes on

/** Who draws: the browser where it can, else the kernel, where there is one.
 *  @param {any} model @param {{sketches: Sketch[], shared?: any}} page @param {Words} words
 *  @param {boolean} hasKernel */
function drawer(model, page, words, hasKernel) {
  if (page.shared) {
    try {
      const engine = createEngine(document.createElement("canvas"), page.shared, { bytes: BYTES });
      return { engine: /** @type {any} */ (engine), by: "browser", why: "" };
    } catch (error) {
      if (!hasKernel || model.get("draws") === "browser") throw error;
      const why = lackOf(error, words).replace(/\.$/, "");
      return { engine: createKernelEngine(model, page.sketches), by: "kernel", why };
    }
  }
  return { engine: createKernelEngine(model, page.sketches), by: "kernel", why: model.get("why") };
}

/** Keep the values of a session and those of a trait alike. A page knows files by other names than Python:
 *  one that changes asks for another page.
 *  @param {Model} model @param {Session} session @param {string} name of the trait */
function bindValues(model, session, name) {
  const rows = session.sketch.shown.filter(({ widget }) => widget !== "file" || !model.get("page"));
  const end = session.follow((news) => {
    if (news !== "values") return;
    const now = Object.fromEntries(rows.map(({ path }) => [path, session.value(path)]));
    const old = model.get(name);
    if (rows.every(({ path }) => isSame(now[path], old[path]))) return;
    model.set(name, { ...old, ...now });
    model.save_changes();
  });
  const receive = () => {
    const given = model.get(name);
    const news = rows.filter(({ path }) => path in given && !isSame(session.value(path), given[path]));
    if (news.length) session.setAll(news.map(({ path }) => [path, given[path]]), "kernel");
  };
  model.on(`change:${name}`, receive);
  receive();
  return () => {
    end();
    model.off(`change:${name}`, receive);
  };
}

/** Keep camera and time of sessions and of a model alike; the first session's time is that of all.
 *  @param {Model} model @param {Session[]} sessions */
function bindView(model, sessions) {
  let taking = false, timer = 0;
  const place = (/** @type {Sketch} */ { terrain }) => JSON.stringify(terrain.extent);
  const together = sessions.every(({ sketch }) => place(sketch) === place(sessions[0].sketch));
  /** Do something to which no session is to react. @param {() => void} act */
  function take(act) {
    if (taking) return;
    taking = true;
    act();
    taking = false;
  }
  function tellTime() {
    timer = 0;
    if (model.get("time") === sessions[0].time) return;
    model.set("time", sessions[0].time);
    model.save_changes();
  }
  const ends = sessions.map((one, at) => one.follow((news) => take(() => {
    const others = sessions.filter((other) => other !== one);
    if (news === "camera") {
      if (together) for (const other of others) other.setCamera(one.camera);
      if (!together && at) return;
      model.set("camera", one.camera);
      model.save_changes();
    } else if (news === "time") {
      for (const other of others) other.setTime(one.time);
      timer ||= window.setTimeout(tellTime, OFTEN);
    }
  })));
  const takeCamera = () => take(() => {
    const given = model.get("camera");
    for (const session of together ? sessions : sessions.slice(0, 1))
      if (JSON.stringify(session.camera) !== JSON.stringify(given)) session.setCamera(given);
  });
  const takeTime = () => take(() => {
    const given = model.get("time");
    for (const session of sessions) if (session.time !== given && !timer) session.setTime(given);
  });
  model.on("change:camera", takeCamera);
  model.on("change:time", takeTime);
  takeCamera();
  takeTime();
  return () => {
    clearTimeout(timer);
    ends.forEach((end) => end());
    model.off("change:camera", takeCamera);
    model.off("change:time", takeTime);
  };
}

/** A bar of time whose button and the model's `playing` are alike.
 *  @param {Model} model @param {import("./figure.js").Figure} figure @param {Words} words */
function boundTimeline(model, figure, words) {
  const told = Object.create(figure, { play: { value: (/** @type {boolean} */ on) => {
    figure.play(on);
    if (model.get("playing") === on) return;
    model.set("playing", on);
    model.save_changes();
  } } });
  const bar = createTimeline(told, words);
  const receive = () => { if (model.get("playing") !== figure.playing) bar.play(model.get("playing")); };
  model.on("change:playing", receive);
  receive();
  return { element: bar.element, end: () => model.off("change:playing", receive) };
}

/** A shared row moves both; what differs has a row for each.
 *  @param {Session[]} sessions @param {string[]} paths @param {string[]} names @param {Words} words */
function comparedRows(sessions, paths, names, words) {
  const [left, right] = sessions;
  const shared = paths.filter((path) => {
    const [one, other] = [left.row(path), right.row(path)];
    return one && other && one.type === other.type && isSame(one.value, other.value);
  });
  let before = new Map(shared.map((path) => [path, left.value(path)]));
  left.follow((news) => {
    if (news !== "values") return;
    const now = new Map(shared.map((path) => [path, left.value(path)]));
    const changed = shared.filter((path) => !isSame(left.value(path), before.get(path) ?? ""));
    before = now;
    if (changed.length) right.setAll(changed.map((path) => [path, left.value(path)]), "shared");
  });
  const own = sessions.map((session, at) => {
    const rest = paths.filter((path) => session.row(path) && !shared.includes(path));
    return rest.length ? [make("div", { className: "own" }, make("b", {}, names[at] ?? ""),
      makeRows(session, () => rest, words))] : [];
  });
  return [makeRows(left, () => shared, words), make("div", { className: "owns" }, ...own.flat())];
}

/** Every parameter, by pass; a pass is made when it is unfolded.
 *  @param {Session} session @param {Words} words */
function allRows(session, words) {
  const folded = (/** @type {string} */ title, /** @type {() => Node[]} */ inside) => {
    const made = make("details", {}, make("summary", {}, title));
    made.addEventListener("toggle", () => {
      if (made.open && made.childElementCount === 1) made.append(...inside());
    });
    return made;
  };
  const passes = grouped(session.sketch.shown, ({ pass }) => pass);
  return folded(words.allParameters, () => [...passes].map(([pass, rows]) =>
    folded(labelOf(pass), () => [makeRows(session, () => rows.map(({ path }) => path), words)])));
}

/** Values that a sketch names. @param {Session} session @param {Words} words */
function presets(session, words) {
  const all = session.sketch.presets;
  const menu = make("select", { "aria-label": words.preset },
    ...[words.preset, ...all.map(({ name }) => name)].map((name) => make("option", {}, name)));
  menu.onchange = () => {
    const chosen = all[menu.selectedIndex - 1];
    menu.selectedIndex = 0;
    if (chosen) session.setAll(Object.entries(chosen.values));
  };
  return menu;
}

/** Make all of a widget in its element.
 *  @param {{model: Model, el: HTMLElement}} cell @param {string} url of the picture
 *  @param {Sketch[]} sketches @param {ReturnType<typeof drawer>} drawing @param {Words} words */
function build({ model, el }, url, sketches, { engine, by, why }, words) {
  const names = model.get("names") ?? [], rows = model.get("rows"), several = sketches.length > 1;
  const swiped = several && model.get("swipe"), [wide] = model.get("size");
  const host = make("div", { className: "live terrain-figure sketches" });
  keepKeys(host);
  const box = make("div", { className: swiped ? "sides swiped" : "sides" });
  const room = several && !swiped ? `calc(${2 * wide}px + 0.75rem)` : `${wide}px`;
  box.style.maxWidth = room;
  box.style.setProperty("--least", `min(17rem, ${wide}px)`);
  host.style.maxWidth = `max(${room}, ${NARROW}px)`;
  const watched = createBookRecovery(/** @type {any} */ (engine), model.get("language")).watch(host);
  const parts = /** @type {any} */ ({ engine, watched, words });
  const sessions = sketches.map((sketch) => createSession([sketch])), [first] = sessions;
  host.append(box);
  const figures = sessions.map((session, at) => {
    const side = make("div", { className: "side" }), poster = several ? null : make("img", { src: url });
    if (poster) poster.alt = model.get("alt");
    box.append(side);
    const figure = makePicture(parts, side, session, { poster });
    figure.canvas.title = words.dragHere;
    if (names[at]) side.append(make("p", { className: "side-label" }, names[at]));
    return figure;
  });
  if (swiped) host.append(makeSwipe(box, words));
  const timeline = boundTimeline(model, figures[0], words);
  timeline.element.hidden = !sketches.some(hasTime);
  const mistake = make("p", { className: "mistake", role: "status" });
  const showMistake = () => { mistake.textContent = model.get("mistake"); };
  const reset = makeReset(first, words, () => sessions.slice(1).forEach((session) => session.resetAll()));
  const said = by === "browser" ? words.byBrowser : fill(words.byKernel, { reason: why });
  host.append(timeline.element, mistake);
  const own = () => [makeRows(first, () => rows, words)];
  host.append(...(several ? comparedRows(sessions, rows, names, words) : own()));
  host.append(make("div", { className: "foot" }, reset,
    ...(!several && first.sketch.presets.length ? [presets(first, words)] : []),
    make("small", { className: "drawn-by" }, said)));
  if (!several) host.append(allRows(first, words));
  el.replaceChildren(host);
  const ends = [
    followTheme(host), watched.end, timeline.end, bindView(model, sessions),
    ...sessions.map((session, at) => bindValues(model, session, model.get("sides")[at])),
    () => model.off("change:mistake", showMistake),
    () => figures.forEach((figure) => figure.close()), () => engine.close(),
  ];
  model.on("change:mistake", showMistake);
  showMistake();
  return { figures, close: () => ends.forEach((end) => end()) };
}

/** Show a widget's sketches in place of what is in an element; give what ends it.
 *  @param {{model: Model, el: HTMLElement}} cell @param {string} url of the picture
 *  @param {boolean} hasKernel */
export async function renderSketch(cell, url, hasKernel) {
  const { model } = cell, words = notebookWords(model.get("language"));
  const page = await unpackedJson(model.get("page") || model.get("outline"));
  let drawing = drawer(model, page, words, hasKernel);
  let made = build(cell, url, page.sketches, drawing, words);
  await Promise.all(made.figures.map((figure) => figure.start()));
  const failed = made.figures.find((figure) => !figure.player);
  if (failed && drawing.by === "browser" && hasKernel && model.get("draws") !== "browser") {
    const why = (failed.stage.querySelector(".message.alarm")?.textContent ?? "").replace(/\.$/, "");
    made.close();
    drawing = { engine: createKernelEngine(model, page.sketches), by: "kernel", why };
    made = build(cell, url, page.sketches, drawing, words);
    await Promise.all(made.figures.map((figure) => figure.start()));
  }
  model.set("drawn_by", drawing.by);
  model.set("why", drawing.why);
  model.save_changes();
  return made.close;
}
