// figure.js -- one live picture in a page: the still picture until it is drawn, then what a session says.

import { fieldFor, moved, sunMoved, turned, zoomed } from "./camera_moves.js";
import { make } from "./dom.js";
import { followGestures } from "./gestures.js";
import { WHOLE, fitted, followsFrame, linesAt, movedView, paintMap, sheetOf, texelAt, zoomedView } from "./map_view.js";
import { REST, createQuality, pixelsOf } from "./quality.js";
import { createSession } from "./session.js";
import { cameraAt } from "./values.js";
import { ENGLISH, fill } from "./words.js";

/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./session.js").Session} Session */
/** @typedef {ReturnType<typeof createFigure>} Figure */

/** What figures need of a player: see engine.js.
 *  @typedef {object} Player
 *  @property {any} state
 *  @property {any} plan
 *  @property {(onProgress?: (done: number, all: number) => void) => Promise<void>} load
 *  @property {() => {ran: string[], milliseconds: number}} render
 *  @property {(context: CanvasRenderingContext2D) => void} drawTo
 *  @property {(source: {path: string, output: string}) => any} read
 *  @property {() => void} close */
/** @typedef {{open: (sketch: Sketch) => Player}} Engine */

/** @typedef {object} Options
 *  @property {Session} [session]       one that others share; else a new one
 *  @property {number} [sketch]         which of the page's, at first
 *  @property {Object<string, string>} [words]
 *  @property {HTMLImageElement | null} [poster]
 *  @property {number} [budget]         pixels of the picture at most
 *  @property {boolean} [inText]        a finger that goes up or down, and the wheel, scroll the page
 *  @property {(text: string, alarm?: boolean) => void} [say]
 *  @property {(player: Player) => void} [opened]  a player is there, its programs too
 *  @property {() => void} [drawn]      after each frame */

const GRAB = 6; // [CSS pixels] from a line between two pictures
const EVERY = 1000; // [ms] of time that a frame may add: after a pause time goes on from where it was

/** Make a figure in an element, whose size it fills. `start` opens the player.
 *  @param {HTMLElement} host @param {Engine} engine @param {{sketches: Sketch[]}} page @param {Options} [options] */
export function createFigure(host, engine, page, options = {}) {
  const { words = ENGLISH, poster = null, budget = 2.1e6, inText = false } = options;
  const session = options.session ?? createSession(page.sketches, options.sketch ?? 0);
  const title = () => session.sketch.title || session.sketch.name;
  const canvas = make("canvas", { tabIndex: 0, role: "application", hidden: true });
  const message = make("p", { className: "message", role: "status" });
  const readout = make("p", { className: "readout", hidden: true });
  const notes = make("div", { className: "notes" }, readout, message);
  const stage = make("div", { className: "stage" }, ...(poster ? [poster] : []), canvas, notes);
  host.append(stage);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const sheet = document.createElement("canvas"), sheetContext = /** @type {CanvasRenderingContext2D} */ (sheet.getContext("2d"));
  const quality = createQuality();
  /** @type {Player | null} */
  let player = null;
  /** @type {any} */
  let texels = null;
  /** @type {[number, number] | null} */
  let pointer = null;
  let asked = 0, askedAt = 0, opening = 0, resting = 0, last = 0, inSight = true, closed = false;
  let playing = false, speed = 1, moving = false, view = WHOLE, fits = false, took = 0;

  const say = options.say ?? ((text, alarm = false) => {
    message.textContent = text;
    message.classList.toggle("alarm", alarm);
  });
  let told = false; // what stands there is of a frame, or of what comes before one
  const tell = (/** @type {string} */ text, alarm = false) => {
    if (text || told) say(text, alarm);
    told = Boolean(text);
  };
  const reason = (/** @type {unknown} */ error) => (error instanceof Error ? error.message : String(error));

  // ── what is drawn ──────────────────────────────────────────────────────────

  /** @returns {[number, number]} */
  const box = () => [Math.max(stage.clientWidth, 1), Math.max(stage.clientHeight, 1)];
  const cameraNow = () => cameraAt(session.sketch, session.camera, session.time);

  /** The camera as it is shown: opened where the room is narrower than the sketch's picture. */
  function framed(/** @type {[number, number]} */ size) {
    const camera = cameraNow();
    return { ...camera, field_of_view: fieldFor(camera.field_of_view, session.sketch.frame, size) };
  }

  const texture = () => session.sketch.textures.find((one) => one.path === session.map?.path && one.output === session.map.output);

  /** @returns {[number, number]} */
  function frameSize() {
    const { map } = session, step = map && player?.plan?.steps?.get(map.path);
    if (map && step && !followsFrame(session.sketch, map.path)) return sheetOf(step.size);
    return pixelsOf(box(), devicePixelRatio || 1, budget, moving && !map ? quality.scale : 1);
  }

  function draw() {
    asked = 0;
    if (!player || closed || document.hidden || !inSight) return;
    const start = performance.now(), late = Math.max(start - askedAt - 17, 0);
    if (playing) {
      const passed = last ? Math.min(start - last, EVERY) / 1000 : 0;
      last = start;
      advance(passed * speed);
    }
    const size = frameSize();
    Object.assign(player.state, session.state(), { frame: size, camera: framed(size) });
    try {
      const { map } = session;
      player.render();
      texels = null;
      if (map && !fits) fitMap();
      else if (map) {
        [sheet.width, sheet.height] = size;
        player.drawTo(sheetContext);
        paint();
      } else {
        if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
        player.drawTo(context);
      }
      took = performance.now() - start;
      tell("");
    } catch (error) {
      tell(fill(words.kept, { reason: reason(error) }), true);
    }
    reveal();
    if (moving) quality.took(took + late);
    if (session.drawn() || playing) ask();
    point();
    options.drawn?.();
  }

  function reveal() {
    canvas.hidden = false;
    if (poster) poster.hidden = true;
    const text = session.map ? fill(words.mapLabel, { label: texture()?.label ?? "" }) : fill(words.picture, { title: title() });
    if (canvas.getAttribute("aria-label") !== text) canvas.setAttribute("aria-label", text);
  }

  /** Ask for a frame; `motion`: others follow soon, so that it may have fewer pixels. */
  function ask(motion = false) {
    if (motion || playing) {
      if (!moving) quality.begin();
      moving = true;
      clearTimeout(resting);
      resting = setTimeout(rest, REST);
    }
    if (asked || closed) return;
    askedAt = performance.now();
    asked = requestAnimationFrame(draw);
  }

  function rest() {
    if (playing) return;
    moving = false;
    if (quality.scale < 1) {
      quality.rest();
      ask();
    }
  }

  async function open() {
    const mine = ++opening;
    tell(words.loading);
    try {
      const made = engine.open(session.sketch);
      Object.assign(made.state, session.state(), { frame: frameSize() });
      await made.load((done, all) => { if (mine === opening) tell(fill(words.compiling, { done, all })); });
      if (mine !== opening || closed) return made.close();
      player?.close();
      player = made;
      quality.forget();
      options.opened?.(made);
      ask();
    } catch (error) {
      if (mine === opening) tell(fill(words.failed, { reason: reason(error) }), true);
    }
    return undefined;
  }

  // ── time ───────────────────────────────────────────────────────────────────

  function advance(/** @type {number} */ seconds) {
    const { duration } = session.sketch, time = session.time + seconds;
    session.setTime(duration > 0 && time > duration ? time % duration : time);
  }

  function play(/** @type {boolean} */ on) {
    playing = on;
    last = 0;
    if (!on) resting = setTimeout(rest, REST);
    ask();
  }

  // ── the camera, and maps ───────────────────────────────────────────────────

  const eye = () => player?.plan?.eye;
  /** @param {(now: Camera, eye: {distance: number, target: [number, number, number]}) => Camera} change */
  function steer(change) {
    const at = eye();
    if (at) session.setCamera(change(cameraNow(), at)); // keyframes' camera goes on from where it is
  }
  /** @returns {[number, number]} */
  const room = () => [canvas.width, canvas.height];
  const density = () => canvas.width / box()[0];

  function paint() {
    const size = pixelsOf(box(), devicePixelRatio || 1, budget * 4);
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    paintMap(context, sheet, [sheet.width, sheet.height], view);
    point();
  }
  const look = (/** @type {import("./map_view.js").View} */ next) => { view = next; paint(); };

  async function readTexels() {
    if (!session.map || !player) return null;
    texels ??= player.read({ path: session.map.path, output: session.map.output });
    return (texels = await texels);
  }

  /** Choose the channel and the range of a map by what there is in it. */
  async function fitMap() {
    fits = true;
    const map = session.map, found = await readTexels();
    if (!map || session.map !== map || !found) return;
    const values = { ...map.values };
    for (const [name, value] of Object.entries(fitted(found))) {
      const row = session.sketch.map.shown.find((one) => one.path.split(".").pop() === name);
      for (const leaf of row?.targets ?? []) values[leaf] = value;
    }
    session.setMap({ ...map, values });
  }

  async function point() {
    readout.hidden = !session.map;
    if (!session.map) return;
    const place = pointer && /** @type {[number, number]} */ (pointer.map((at) => at * density()));
    const found = place && (await readTexels()), { map, sketch } = session;
    const at = map && found && place && texelAt(place, room(), view, [sheet.width, sheet.height], found.size);
    if (!map) return;
    const { terrain } = player?.plan ?? session.state();
    const lines = at ? linesAt(found, at, Boolean(texture()?.height), terrain, !followsFrame(sketch, map.path), words) : [words.pointAt];
    readout.textContent = lines.join("\n");
  }

  const pixels = (/** @type {number} */ share) => share * canvas.height;
  const turn = (/** @type {number} */ across, /** @type {number} */ down) => {
    if (session.map) look(movedView(view, [sheet.width, sheet.height], room(), pixels(across), pixels(down)));
    else steer((now) => turned(now, across, down));
  };
  const move = (/** @type {number} */ across, /** @type {number} */ down) => {
    if (session.map) turn(across, down);
    else steer((now, at) => moved(now, at, fieldFor(now.field_of_view, session.sketch.frame, box()), across, down));
  };
  const zoom = (/** @type {number} */ notches, x = box()[0] / 2, y = box()[1] / 2) => {
    const at = /** @type {[number, number]} */ ([x * density(), y * density()]);
    if (session.map) look(zoomedView(view, [sheet.width, sheet.height], room(), 0.88 ** -notches, at));
    else steer((now, from) => zoomed(now, from, notches));
  };
  const resetView = () => (session.map ? look(WHOLE) : session.setCamera(null));

  const rowsOf = (/** @type {string} */ widget) => session.sketch.shown.filter((row) => row.exported && row.widget === widget && !row.locked);
  let held = "";
  followGestures(canvas, {
    turn, move, zoom, reset: resetView,
    grab(x) {
      const away = (/** @type {string} */ path) => Math.abs(Number(session.value(path)) * box()[0] - x);
      const paths = session.map ? [] : rowsOf("divider").map((row) => row.path).sort((a, b) => away(a) - away(b));
      held = paths.length && away(paths[0]) <= GRAB ? paths[0] : "";
      return Boolean(held);
    },
    drag: (x) => session.set(held, +Math.min(Math.max(x / box()[0], 0), 1).toFixed(4)),
    light(across, up) {
      const suns = rowsOf("direction"), terrain = suns.filter((row) => row.pass !== "view");
      const news = (terrain.length ? terrain : suns).map((row) => [row.path, sunMoved(/** @type {number[]} */ (session.value(row.path)), across, up)]);
      if (news.length) session.setAll(/** @type {[string, any][]} */ (news), "light");
    },
    hover(place) { pointer = place ?? pointer; if (session.map) point(); },
  }, { sideways: inText, wheel: () => !inText || document.activeElement === canvas });

  // ── what it follows ────────────────────────────────────────────────────────

  const unfollow = session.follow((news) => {
    if (news === "sketch") open();
    else {
      if (!session.map) view = WHOLE;
      ask(news === "camera" || news === "values" || news === "time");
    }
  });
  const sizes = new ResizeObserver(() => ask());
  sizes.observe(stage);
  const sights = new IntersectionObserver(([entry]) => { inSight = entry.isIntersecting; last = 0; if (inSight) ask(); });
  sights.observe(stage);
  const wake = () => { last = 0; if (!document.hidden) ask(); };
  document.addEventListener("visibilitychange", wake);

  return {
    session, stage, canvas, say, ask, play, turn, move, zoom, resetView, fitMap,
    get player() { return player; },
    get playing() { return playing; },
    get speed() { return speed; },
    set speed(/** @type {number} */ wanted) { speed = wanted; },
    /** [ms] that the last frame took. */
    get took() { return took; },
    /** Open the player, and draw. */
    start: open,
    /** Show a texture from above, or the picture. @param {{path: string, output: string} | null} texture */
    showMap(texture) {
      fits = false;
      view = WHOLE;
      session.setMap(texture && { path: texture.path, output: texture.output, values: { ...session.sketch.map.values } });
    },
    /** Repeats with more than one step, by path. */
    repeats() {
      /** @type {Map<string, number>} */
      const found = new Map();
      for (const [path, step] of player?.plan?.steps ?? []) if (step.whole > 1 || step.repeat > 1) found.set(path, Math.max(step.whole, step.repeat));
      return found;
    },
    close() {
      closed = true;
      cancelAnimationFrame(asked);
      clearTimeout(resting);
      unfollow();
      sizes.disconnect();
      sights.disconnect();
      document.removeEventListener("visibilitychange", wake);
      player?.close();
      stage.remove();
    },
  };
}
