// book_series.js -- live series of a book: iterations stopped early, a parameter swept, variants compared.

import { makePicture, makeReset, makeSlider, makeSwipe } from "./book_figure.js";
import { button, make } from "./dom.js";
import { clamp, isWhole, toHex, unitOf, write, written } from "./numbers.js";
import { createSession } from "./session.js";
import { fill } from "./words.js";

/** @import { Room } from "./book_figure.js"
 *  @import { Shown, Sketch, Value } from "./schema.js"
 *  @import { Session } from "./session.js" */

// ── A slider's listed values, and those between them.

/** The value at a place among listed ones, from 0 to their count less one; linear between neighbours.
 *  @param {Pick<Shown, "type">} row @param {Value[]} values @param {number} place @returns {Value} */
export function valueAt(row, values, place) {
  const held = clamp(place, 0, values.length - 1), low = Math.floor(held), share = held - low;
  const from = values[low], to = values[Math.min(low + 1, values.length - 1)];
  if (share === 0) return from;
  const mixed = (/** @type {any} */ a, /** @type {any} */ b) => {
    const between = a + (b - a) * share;
    return isWhole(row.type) ? Math.round(between) : between;
  };
  if (!Array.isArray(from) || !Array.isArray(to)) return mixed(from, to);
  return from.map((part, at) => mixed(part, to[at]));
}

/** A value as a reader sees it: with its unit, in the places that suit the parameter; each part of a
 *  direction has its degrees, as in course/scenes.py.
 *  @param {Shown} row @param {Value} value @param {boolean} comma */
export function spelled(row, value, comma) {
  if (typeof value === "boolean") return write(row, value);
  if (row.widget === "colour" && Array.isArray(value)) return toHex(value, row.raw);
  const all = Array.isArray(value) ? value : [value];
  const unit = unitOf(row), degrees = unit === "°";
  const numbers = all.map((number, part) => {
    const text = written(row, Number(number), part);
    return (comma ? text.replaceAll(".", ",") : text) + (degrees ? unit : "");
  });
  return degrees ? numbers.join(", ") : numbers.join(comma ? "\u00a0; " : ", ") + unit;
}

// ── Live series of a book

const STAYS = 700; // [ms] of an iteration that is played

/** The pictures of a series as the page has them. @param {HTMLElement} still */
const framesOf = (still) => [...still.querySelectorAll("li")];

/** Which of the pictures is shown. @param {Element[]} frames */
const shownOf = (frames) => Math.max(frames.findIndex((frame) => frame.classList.contains("now")), 0);

/** A repeat, at any of its iterations. @param {Room} room */
export function liveSteps(room) {
  const { host, still, block, sketches, words } = room, session = createSession(sketches);
  const { passes = [], iterations = [] } = block, frames = framesOf(still), first = shownOf(frames);
  const all = Math.max(...iterations), caption = make("div", { className: "step-caption" });
  const figure = makePicture(room, host, session, { poster: frames[first].querySelector("img") });

  /** What the page says of an iteration: of the last one before it that it shows. @param {number} now */
  function explain(now) {
    const at = iterations.reduce((found, count, index) => (count <= now ? index : found), 0);
    const text = frames[at].querySelector("p span");
    caption.replaceChildren(...(text ? [text.cloneNode(true)] : []));
  }
  const slider = makeSlider({
    label: words.iterations, min: Math.min(...iterations), max: all, step: 1, value: iterations[first], words,
    said: (now) => fill(words.iteration, { now, all }),
    changed(now) {
      for (const path of passes) session.stop(path, now);
      explain(now);
    },
  });
  let timer = 0, now = 0;
  const run = button(words.play, () => (timer ? halt() : play()));
  function halt() {
    clearInterval(timer);
    timer = 0;
    run.textContent = words.play;
  }
  function play() {
    const range = slider.element.querySelector("input");
    now = range && +range.value < all ? +range.value : Math.min(...iterations) - 1;
    run.textContent = words.pause;
    const step = () => {
      slider.go(++now);
      if (now >= all) halt();
    };
    step();
    timer = window.setInterval(step, STAYS);
  }
  slider.element.addEventListener("pointerdown", (event) => event.target !== run && halt());
  slider.element.append(run);
  for (const path of passes) session.stop(path, iterations[first]);
  explain(iterations[first]);
  host.append(slider.element, caption);
  return figure.start();
}

/** A parameter, at its listed values and between them. @param {Room} room */
export function liveSlider(room) {
  const { host, still, block, sketches, words, comma } = room;
  const frames = framesOf(still), first = shownOf(frames);
  const labels = frames.map((frame) => frame.querySelector("b")?.textContent ?? "");
  const { row: path, values } = block, name = still.querySelector("ol")?.dataset.name ?? "";
  const session = createSession(path ? [sketches[first]] : sketches, path ? 0 : first);
  const row = path && session.row(path);
  const figure = makePicture(room, host, session, { poster: frames[first].querySelector("img") });
  const slider = makeSlider({
    label: name, min: 0, max: labels.length - 1, step: row ? "any" : 1, value: first, words,
    said: (at) => (Number.isInteger(at) || !row || !values
      ? labels[Math.round(at)] : spelled(row, valueAt(row, values, at), comma)),
    changed(at) {
      if (row && values) session.set(row.path, valueAt(row, values, at));
      else session.choose(at);
    },
  });
  host.append(slider.element, makeReset(session, words, () => slider.go(first)));
  return figure.start();
}

/** @param {Sketch} one @param {Sketch} other */
const seenAlike = (one, other) => {
  const [first, second] = [one, other].map(({ camera, terrain }) => JSON.stringify([camera, terrain.extent]));
  return first === second;
};

/** Move the cameras of sessions together. @param {Session[]} sessions */
function shareCamera(sessions) {
  let moving = false;
  for (const one of sessions) {
    one.follow((news) => {
      if (news !== "camera" || moving) return;
      moving = true;
      for (const other of sessions) if (other !== one) other.setCamera(one.camera);
      moving = false;
    });
  }
}

/** Variants, seen by one camera; two of them one over the other, to be swiped. @param {Room} room */
export function liveCompare(room) {
  const { host, still, sketches, words } = room, frames = framesOf(still);
  const sessions = sketches.map((sketch) => createSession([sketch]));
  const alike = sketches.every((sketch) => seenAlike(sketch, sketches[0]));
  if (alike) shareCamera(sessions);
  const [wide, high] = sketches[0].frame;
  const same = sketches.every(({ frame }) => frame[0] * high === frame[1] * wide);
  const swiped = sketches.length === 2 && same;
  const box = make("div", { className: swiped ? "sides swiped" : "sides" });
  host.append(box);
  const figures = sessions.map((session, at) => {
    const side = make("div", { className: "side" });
    box.append(side);
    const figure = makePicture(room, side, session, { poster: frames[at].querySelector("img") });
    const label = frames[at].querySelector("b");
    if (label) side.append(make("p", { className: "side-label" }, label.cloneNode(true)));
    return figure;
  });
  if (swiped) host.append(makeSwipe(box, words));
  host.append(makeReset(sessions[0], words, () => sessions.forEach((session) => session.setCamera(null))));
  return Promise.all(figures.map((figure) => figure.start()));
}
