// figure.js -- one live picture in a page: the still picture until it is drawn, then what a session says.

import { fieldFor } from "./camera.js";
import { make } from "./dom.js";
import { createFigureMap, REST, pixelsOf, createQuality } from "./figure_map.js";
import { createSession } from "./session.js";
import { followPointer, readsPointer, steerWith } from "./steering.js";
import { cameraAt } from "./values.js";
import { fill } from "./words.js";

/** @import { Sketch } from "./schema.js"
 *  @import { Session } from "./session.js" */

// ── The player of a figure: opened for its sketch, and made ready for what is asked next.

/** Of the figure.
 *  @typedef {object} Holder
 *  @property {Engine} engine
 *  @property {import("./session.js").Session} session
 *  @property {Object<string, string>} words
 *  @property {(text: string, error?: unknown) => void} tell
 *  @property {(to: Player) => unknown} takeState   gives a player the state of now
 *  @property {(player: Player) => unknown} [prepare]
 *  @property {(player: Player) => void} opened     it is there, its programs too
 *  @property {() => void} tellBusy                 `waits` or `isOpening` is another */

/** @param {Holder} holder */
function holdPlayer({ engine, session, words, tell, takeState, prepare, opened, tellBusy }) {
  /** @type {Player | null} */
  let player = null;
  let opening = 0, asked = 0, loading = 0, isOpening = false, closed = false;

  const compiling = (/** @type {number} */ done, /** @type {number} */ all) =>
    tell(fill(words.compiling, { done, all }));

  /** Open a player for the sketch of now; the one before stays until it can draw. */
  async function open() {
    const mine = ++opening;
    isOpening = true;
    tellBusy();
    tell(words.loading);
    try {
      const made = engine.open(session.sketch);
      takeState(made);
      await made.load((done, all) => {
        if (mine === opening) compiling(done, all);
      });
      if (mine === opening) await prepare?.(made);
      if (mine !== opening || closed) return made.close();
      player?.close();
      player = made;
      isOpening = false;
      opened(made);
    } catch (error) {
      if (mine === opening) {
        isOpening = false;
        tell(words.failed, error);
        tellBusy();
      }
    }
    return undefined;
  }

  /** Compile what the state of now needs besides, and load its data; the last picture stays meanwhile. */
  async function more() {
    const from = player, mine = ++asked;
    if (!from) return;
    loading++;
    tellBusy();
    try {
      takeState(from);
      await from.load((done, all) => {
        if (mine === asked && done < all) compiling(done, all);
      });
    } catch (error) {
      if (mine === asked) tell(words.kept, error);
    } finally {
      loading--;
      tellBusy();
    }
  }

  return {
    open,
    more,
    get now() { return player; },
    /** Whether what is asked of the player cannot be drawn yet without waiting for a compiler. */
    get waits() { return loading > 0; },
    /** Whether a player for the sketch of now is on its way. */
    get isOpening() { return isOpening; },
    close() {
      closed = true;
      player?.close();
    },
  };
}

// ── One live picture in a page

/** @typedef {ReturnType<typeof createFigure>} Figure */

/** What figures need of a player: see engine.js.
 *  @typedef {object} Player
 *  @property {any} state
 *  @property {any} plan
 *  @property {boolean} [looks]  whether its picture depends on the camera; true where it does not say
 *  @property {(onProgress?: (done: number, all: number) => void) => Promise<unknown>} load
 *  @property {() => unknown} [render]  at once; only `renderSoon` where somebody else draws
 *  @property {() => Promise<unknown>} [renderSoon]  in pieces; null where a later one has overtaken it
 *  @property {(context: CanvasRenderingContext2D) => void} drawTo
 *  @property {(source: {path: string, output: string}) => any} read
 *  @property {() => void} close */
/** @typedef {{open: (sketch: Sketch) => Player}} Engine */

/** @typedef {object} Options
 *  @property {Session} [session]       one that others share; else a new one
 *  @property {number} [sketch]         which of the page's, at first
 *  @property {Object<string, string>} words       of a page
 *  @property {HTMLImageElement | null} [poster]
 *  @property {number} [budget]         pixels of the picture at most
 *  @property {boolean} [inText]        a finger that goes up or down, and the wheel, scroll the page
 *  @property {(player: Player) => unknown} [prepare]  what a player needs before its first picture
 *  @property {(player: Player) => void} [opened]  a player is there, its programs too
 *  @property {() => void} [drawn]      after each frame */

const EVERY = 1000; // [ms] of time that a frame may add: after a pause time goes on from where it was
const FRAME = 17; // [ms] that a frame waits for the screen
const PATIENT = 1500; // [ms] a picture that is made in pieces may take before other values overtake it
const LONG = 150; // [ms] of a picture after which the next is made in pieces
const SAID = 600; // [ms] until it is said that a picture is being made

/** Make a figure in an element, whose size it fills. `start` opens the player.
 *  @param {HTMLElement} host @param {Engine} engine @param {{sketches: Sketch[]}} page
 *  @param {Options} options */
export function createFigure(host, engine, page, options) {
  const { words, poster = null, inText = false } = options;
  let { budget = 2.1e6 } = options;
  const session = options.session ?? createSession(page.sketches, options.sketch ?? 0);
  const canvas = make("canvas", { tabIndex: 0, role: "application", hidden: true });
  const message = make("p", { className: "message", role: "status" });
  const readout = make("p", { className: "readout", hidden: true });
  const notice = make("p", { className: "message", role: "status" });
  const notes = make("div", { className: "notes" }, readout, notice, message);
  const stage = make("div", { className: "stage" }, ...(poster ? [poster] : []), canvas, notes);
  host.append(stage);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const quality = createQuality();
  let asked = 0, askedAt = 0, resting = 0, last = 0, took = 0, speed = 1;
  let inSight = true, closed = false, playing = false, moving = false, long = true, again = false;
  let due = false; // something was asked for since the state was last taken
  let overtaken = false; // values have changed since a picture was begun in pieces
  /** @type {(() => void)[]} who waits for the next picture */
  const waiting = [];
  /** @type {number | null} when the picture was begun that is made in pieces */
  let begun = null;

  /** @returns {[number, number]} CSS pixels */
  const box = () => [Math.max(stage.clientWidth, 1), Math.max(stage.clientHeight, 1)];
  const room = { session, words, canvas, context, readout, box, budget: budget * 2, player: () => held.now };
  const map = createFigureMap(room);
  const eye = () => (held.now?.looks ?? true ? held.now?.plan?.eye : undefined);
  const steering = steerWith(canvas, session, map, { box, eye, inText });

  const pointer = followPointer(canvas, () => {
    if (!session.map && readsPointer(session.sketch)) ask(true);
  });

  /** Say how far the picture is, or what is wrong with it. */
  function tell(/** @type {string} */ text, /** @type {unknown} */ error = null) {
    const reason = error instanceof Error ? error.message : String(error);
    const whole = error ? fill(text, { reason }) : text;
    if (message.textContent !== whole) message.textContent = whole;
    message.classList.toggle("alarm", Boolean(error));
  }

  /** Whether another picture is to come: who listens, or tests, waits for the last. Out of sight, it comes
   *  when the figure is seen again; without a player none does. */
  function tellBusy() {
    const coming = held.isOpening || (held.now !== null && (due || begun !== null || held.waits));
    stage.setAttribute("aria-busy", String(coming || moving));
  }

  // ── what is drawn ──────────────────────────────────────────────────────────

  /** The camera as it is shown: opened where the room is narrower than the sketch's picture. */
  function framed(/** @type {[number, number]} */ size) {
    const camera = cameraAt(session.sketch, session.camera, session.time);
    return { ...camera, field_of_view: fieldFor(camera.field_of_view, session.sketch.frame, size) };
  }

  function takeState(/** @type {Player} */ to) {
    const scale = moving && !session.map ? quality.scale : 1;
    const size = map.size() ?? pixelsOf(box(), devicePixelRatio || 1, budget, scale);
    const live = pointer.live(size, playing);
    Object.assign(to.state, session.state(), { frame: size, camera: framed(size), live, moving });
    return size;
  }

  function draw() {
    asked = 0;
    const from = held.now;
    if (!from || held.waits || closed || document.hidden || !inSight) return;
    const start = performance.now();
    again = begun !== null && !(overtaken && start - begun > PATIENT);
    if (again) return;
    const late = Math.max(start - askedAt - FRAME, 0), inPieces = (long || !from.render) && from.renderSoon;
    if (playing) advance(start);
    due = false;
    try {
      const size = takeState(from);
      if (inPieces) drawInPieces(from, size, start);
      else {
        from.render?.();
        show(from, size, start, late);
      }
    } catch (error) {
      tell(canvas.hidden ? words.failed : words.kept, error);
    }
    if (playing) ask();
    tellBusy();
  }

  /** What a value changes may take long: the page stays at hand meanwhile.
   *  @param {Player} from @param {[number, number]} size @param {number} start */
  async function drawInPieces(from, size, start) {
    const mapped = Boolean(session.map);
    begun = start;
    overtaken = false;
    const slow = setTimeout(() => { if (!playing) tell(words.working); }, SAID);
    try {
      const done = await from.renderSoon?.();
      clearTimeout(slow);
      if (!done || from !== held.now || closed || mapped !== Boolean(session.map)) return;
      show(from, size, start, 0);
      long = overtaken || took > LONG;
    } catch (error) {
      tell(canvas.hidden ? words.failed : words.kept, error);
    } finally {
      clearTimeout(slow);
      if (begun === start) begun = null;
      if (again) ask();
      tellBusy();
    }
  }

  /** @param {Player} from @param {[number, number]} size @param {number} start @param {number} late */
  function show(from, size, start, late) {
    if (session.map) map.drawn(from, size);
    else {
      if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
      from.drawTo(context);
    }
    took = performance.now() - start;
    canvas.hidden = false;
    if (poster) poster.hidden = true;
    name();
    tell("");
    if (moving) {
      quality.took(took + late);
      settle(); // a slow picture is no rest
    }
    const newer = pointer.drawn() && readsPointer(session.sketch);
    if (session.drawn() || newer) ask();
    waiting.splice(0).forEach((resolve) => resolve());
    options.drawn?.();
  }

  function name() {
    const title = session.sketch.title || session.sketch.name;
    const text = session.map ? fill(words.mapLabel, { label: map.label }) : fill(words.picture, { title });
    if (canvas.getAttribute("aria-label") !== text) canvas.setAttribute("aria-label", text);
  }

  /** Ask for a frame; `motion`: others follow soon, so that it may have fewer pixels. */
  function ask(motion = false) {
    if (motion || playing) {
      if (!moving) quality.begin();
      moving = true;
      settle();
    }
    due = true;
    if (asked || closed) return tellBusy();
    askedAt = performance.now();
    asked = requestAnimationFrame(draw);
    tellBusy();
  }

  function settle() {
    clearTimeout(resting);
    resting = setTimeout(() => {
      if (playing) return;
      if (begun !== null) return settle();
      moving = false;
      quality.rest();
      ask(); // whole
    }, REST);
  }

  const held = holdPlayer({
    engine, session, words, tell, takeState, prepare: options.prepare,
    opened: (made) => {
      quality.forget();
      options.opened?.(made);
      ask();
    },
    tellBusy: () => tellBusy(),
  });

  // ── time ───────────────────────────────────────────────────────────────────

  function advance(/** @type {number} */ now) {
    const passed = last ? Math.min(now - last, EVERY) / 1000 : 0, { duration } = session.sketch;
    last = now;
    const time = session.time + passed * speed;
    session.setTime(duration > 0 && time > duration ? time % duration : time);
  }

  function play(/** @type {boolean} */ on) {
    playing = on;
    last = 0;
    settle();
    ask();
  }

  /** Time goes on from here. */
  function wake() {
    last = 0;
    if (!document.hidden && inSight) ask();
  }

  // ── what it follows ────────────────────────────────────────────────────────

  const unfollow = session.follow((news) => {
    if (news !== "camera" && news !== "time") long = overtaken = true;
    if (news === "sketch") held.open();
    else if (news !== "map") ask(true);
    else held.more().then(() => ask());
  });
  const sizes = new ResizeObserver(() => ask());
  const sights = new IntersectionObserver(([entry]) => {
    inSight = entry.isIntersecting;
    wake();
  });
  sizes.observe(stage);
  sights.observe(stage);
  document.addEventListener("visibilitychange", wake);

  return {
    session, stage, canvas, ask, play, ...steering,
    /** Show a notice. @param {string} text */
    say(text) { notice.textContent = text; },
    /** Draw no more pixels than these from now on. @param {number} pixels */
    shrink(pixels) { budget = pixels; },
    showMap: map.show,
    /** The pass and the texel that a place shows; null where it shows none.
     *  @param {[number, number]} place [CSS pixels] from the upper left
     *  @returns {{path: string, texel: [number, number]} | null} */
    pick(place) {
      if (session.map) {
        const texel = map.texel(place);
        return texel && { path: session.map.path, texel };
      }
      const plan = held.now?.plan, size = plan?.steps?.get(plan.picture.path)?.size, room = box();
      if (!size) return null;
      const at = place.map((part, axis) => Math.floor((part / room[axis]) * size[axis]));
      const [x, y] = at.map((each, axis) => Math.min(Math.max(each, 0), size[axis] - 1));
      return { path: plan.picture.path, texel: [x, size[1] - 1 - y] };
    },
    fitMap: map.fit,
    get player() { return held.now; },
    get playing() { return playing; },
    get speed() { return speed; },
    set speed(/** @type {number} */ wanted) { speed = wanted; },
    /** [ms] that the last frame took. */
    get took() { return took; },
    /** Open the player, and draw. */
    start: held.open,
    /** Draw anew; done when the picture is there. @returns {Promise<void>} */
    redraw() {
      long = true;
      ask();
      return new Promise((resolve) => { waiting.push(resolve); });
    },
    /** Show the still picture in place of the live one, or no longer. @param {boolean} still */
    showPoster(still) {
      if (!poster) return;
      poster.hidden = !still;
      canvas.hidden = still;
    },
    close() {
      closed = true;
      cancelAnimationFrame(asked);
      clearTimeout(resting);
      unfollow();
      sizes.disconnect();
      sights.disconnect();
      document.removeEventListener("visibilitychange", wake);
      held.close();
      stage.remove();
    },
  };
}
