// timeline.js -- the bar of time under a picture that moves: play, a slider with the keyframes' marks, speed.

import { button, make } from "./dom.js";
import { clamp } from "./numbers.js";
import { fill } from "./words.js";

/** @import { Figure } from "./figure.js"
 *  @import { Sketch } from "./schema.js" */

const DEFAULT_DURATION = 10; // [s] that the bar of a sketch without keyframes shows at least
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 10];
const FPS = 30; // frames of a film, as FPS of playground/publish/series.py
const EPSILON = 1e-6;

/** Times of a sketch's keyframes, each once, in order. @param {Sketch} sketch */
const marksOf = (sketch) =>
  [...new Set(sketch.tracks.flatMap((track) => track.times))].sort((a, b) => a - b);

/** The last time on the bar, which begins at 0. @param {Sketch} sketch @param {number} time */
function spanOf(sketch, time) {
  const last = sketch.duration || DEFAULT_DURATION;
  return time <= last ? last : Math.ceil(time / DEFAULT_DURATION) * DEFAULT_DURATION;
}

/** The time of the film's frame before or after. @param {number} time @param {number} frames */
export function stepped(time, frames) {
  const now = time * FPS,
    whole = frames > 0 ? Math.floor(now + EPSILON) : Math.ceil(now - EPSILON);
  return Math.max(whole + frames, 0) / FPS;
}

/** Whether a sketch has a time to show. @param {Sketch} sketch */
export const hasTime = (sketch) => sketch.moves || sketch.duration > 0;

/** Make the bar. @param {Figure} figure @param {Object<string, string>} words */
export function createTimeline(figure, words) {
  const { session } = figure;
  const run = button(words.play, () => play(!figure.playing), { className: "run" });
  const range = make("input", { type: "range", min: 0, step: "any", "aria-label": words.time });
  const marks = make("div", { className: "marks", "aria-hidden": "true" });
  const now = make("output", { className: "now" });
  const speed = make(
    "select",
    { "aria-label": words.speed, title: words.speed },
    ...SPEEDS.map((times) => make("option", { value: String(times), selected: times === 1 }, `${times} ×`)),
  );
  const bar = make(
    "div",
    { className: "timeline", role: "group", "aria-label": words.time },
    run,
    make("div", { className: "track" }, marks, range),
    now,
    speed,
  );
  speed.onchange = () => {
    figure.speed = +speed.value;
  };
  range.oninput = () => {
    const time = +range.value,
      span = spanOf(session.sketch, session.time),
      near = marksOf(session.sketch).find((mark) => Math.abs(mark - time) < span / 100);
    session.setTime(near ?? time);
  };

  function play(/** @type {boolean} */ on) {
    figure.play(on);
    run.textContent = on ? words.pause : words.play;
    run.setAttribute("aria-pressed", String(on));
  }

  function show() {
    const span = spanOf(session.sketch, session.time),
      text = fill(words.seconds, { time: session.time.toFixed(2) });
    range.max = String(span);
    range.value = String(session.time);
    range.style.setProperty("--share", String(clamp(session.time / span)));
    range.setAttribute("aria-valuetext", text);
    now.textContent = text;
  }

  function rebuild() {
    const { sketch } = session,
      span = spanOf(sketch, session.time);
    bar.hidden = !hasTime(sketch);
    marks.replaceChildren(
      ...marksOf(sketch).map((time) => {
        const mark = make("span", { title: `${words.keyframe}, ${fill(words.seconds, { time })}` });
        mark.style.setProperty("--at", String(time / span));
        return mark;
      }),
    );
    show();
  }
  session.follow((news) => {
    if (news === "time") show();
    else if (news === "sketch") rebuild();
  });
  rebuild();
  return { element: bar, play, toggle: () => play(!figure.playing) };
}
