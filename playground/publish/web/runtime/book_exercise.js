// book_exercise.js -- what a reader of a book sets or writes, checked where it is read; a picture to match.

import { makePicture, makeReset, makeRows } from "./book_figure.js";
import { createText, makeVerdict } from "./book_text.js";
import { button, make } from "./dom.js";
import { createSession } from "./session.js";
import { fill } from "./words.js";
import { createCheck, createJudge, createScore, sentence } from "./work_check.js";
import { followParameters } from "./written_parameters.js";

/** @import { Room } from "./book_figure.js"
 *  @import { Outcome } from "./work_check.js" */

const SETTLED = 350; // [ms] without a change, then what was set is compared
const SIDE = 240; // pixels of the pictures that a verdict shows, side by side

/** The values of the solution's picture. @param {Room} room */
const solutionOf = ({ sketches }) => createSession([sketches[0]]).state();

/** An exercise: one that is checked, or one whose picture is compared while one drags.
 *  @param {Room} room */
export async function liveExercise(room) {
  if (room.block.checks?.length) return checkedExercise(room);
  const { host, still, block, sketches, begin, engine, words } = room;
  const session = createSession([begin ?? sketches[0]]);
  const figure = makePicture(room, host, session, { poster: still.querySelector("img") });
  host.append(makeRows(session, () => block.rows ?? [], words));
  if (begin) {
    const verdict = makeVerdict(host), check = await createCheck(engine, sketches[0], solutionOf(room));
    settled(session, async () => {
      const good = await check.holds(session.state());
      if (good) verdict(words.reached, "right");
      else verdict(session.anyChanged() ? words.notReached : "", "wrong");
    });
  }
  host.append(makeReset(session, words));
  return figure.start();
}

/** Call a function some time after values were changed.
 *  @param {import("./session.js").Session} session @param {() => unknown} act */
function settled(session, act) {
  let timer = 0;
  session.follow((news) => {
    if (news !== "values") return;
    clearTimeout(timer);
    timer = window.setTimeout(act, SETTLED);
  });
}

/** The picture of a task, with the field of its text where it is one, and its rows.
 *  @param {Room} room @param {HTMLElement} host  of the picture
 *  @param {{changed: () => unknown}} news */
function makeTask(room, host, { changed }) {
  const { block, sketches, engine, watched, words } = room, begin = room.begin ?? sketches[0];
  const { file = "", starter = "", answer = "", rows = [] } = block, session = createSession([begin]);
  const parameters = file ? followParameters(begin, engine.shared, file, answer) : null;
  const figure = makePicture(room, host, session, file ? {
    opened: (/** @type {any} */ made) => text?.opened(made),
    prepare: (/** @type {any} */ made) => watched.recovery.resume(made),
  } : {});
  const text = file ? createText(room, {
    file, first: starter, label: fill(words.field, { name: file }), key: `${file} ${block.kind}`,
    whole: (shown) => shown, part: (all) => all, failed: changed,
    read: parameters?.read,
    works(read) { if (parameters?.take(read)) session.renew(); },
    made() { figure.ask(); return changed(); },
  }) : null;
  room.host.append(makeRows(session, () => [...rows, ...parameters?.added ?? []], words));
  settled(session, changed);
  const restart = text ? [button(words.restart, () => text.put(starter))] : [];
  const buttons = make("div", { className: "buttons" }, ...restart, makeReset(session, words));
  return {
    session, text, buttons,
    async start() {
      await figure.start();
      await text?.begin();
    },
  };
}

/** @param {Room} room */
async function checkedExercise(room) {
  const { host, block, sketches, begin, engine, words, say: labels = {}, comma } = room;
  const { file = "", answer = "" } = block;
  const task = makeTask(room, host, { changed: () => forget() }), checks = block.checks ?? [];
  const check = button(words.check, act, { className: "check" });
  task.buttons.prepend(check);
  const list = make("ul", { className: "results" });
  const results = make("div", { className: "outcome", role: "status" }, list);
  host.append(task.buttons, results);
  const judge = createJudge(engine, sketches[0], begin ?? sketches[0], { file, answer, checks });
  await task.start();

  function forget() {
    list.replaceChildren();
    results.querySelector(".pictures")?.remove();
    results.querySelector(".verdict")?.remove();
    results.querySelector(".elsewhere")?.remove();
  }

  async function act() {
    check.setAttribute("aria-busy", "true");
    try {
      await task.text?.done();
      forget();
      if (task.text?.isWrong) return say(words.notCompiled, false);
      const found = await judge.judged(file ? null : task.session.state(), task.text?.text ?? "");
      list.replaceChildren(...found.map((one, at) => {
        const text = sentence(one, checks[at], labels, comma);
        return make("li", { className: one.passed ? "right" : "wrong" }, text);
      }));
      const all = found.every(({ passed }) => passed), count = found.filter(({ passed }) => passed).length;
      say(fill(all ? words.allRight : words.someRight, { count, all: found.length }), all);
      if (block.elsewhere) {
        results.append(
          make("p", { className: "elsewhere" }, fill(words.elsewhere, { count: block.elsewhere })));
      }
      const first = found.find((one, at) => !one.passed && !checks[at].hidden && one.mine);
      if (first) results.append(pictures(first, labels));
    } catch (error) {
      say(error instanceof Error ? error.message : String(error), false);
    } finally {
      check.removeAttribute("aria-busy");
    }
  }

  /** @param {string} text @param {boolean} good */
  function say(text, good) {
    results.prepend(make("p", { className: `verdict ${good ? "right" : "wrong"}` }, text));
  }
}

/** One's own picture, the one that is asked for, and where they differ.
 *  @param {Outcome} found @param {Object<string, string>} labels */
function pictures({ mine, wanted, differs }, labels) {
  const all = [[labels.mine, mine], [labels.wanted, wanted], [labels.differs, differs]];
  return make("div", { className: "pictures" }, ...all.map(([name, picture]) => {
    const { size: [width, height], data } = /** @type {import("./work_check.js").Shot} */ (picture);
    const canvas = make("canvas", { width, height, role: "img", "aria-label": String(name) });
    canvas.style.maxWidth = `${SIDE}px`;
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    const image = context.createImageData(width, height), row = 4 * width;
    for (let y = 0; y < height; y++) {
      image.data.set(data.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
    }
    context.putImageData(image, 0, 0);
    return make("figure", {}, canvas, make("figcaption", {}, String(name)));
  }));
}

/** A picture to match: it stands beside one's own, with a score. @param {Room} room */
export async function liveChallenge(room) {
  const { host, still, block, sketches, begin, engine, words } = room;
  const { file = "", answer = "", starter = "", goal = 95 } = block;
  const sides = make("div", { className: "sides" });
  const left = make("div", { className: "side" }), right = make("div", { className: "side" });
  const target = /** @type {HTMLImageElement} */ (still.querySelector("img")?.cloneNode());
  target?.removeAttribute("loading");
  left.append(...(target ? [target] : []), make("p", { className: "side-label" }, words.target));
  sides.append(left, right);
  host.append(sides);
  const task = makeTask(room, right, { changed: () => compare() });
  right.append(make("p", { className: "side-label" }, words.mine));
  const meter = make("meter", { min: "0", max: "100", "aria-label": words.score });
  Object.assign(meter, { high: goal, optimum: 100 });
  const said = make("p", { className: "score", role: "status" });
  host.append(make("div", { className: "scored" }, meter, said), task.buttons);
  const { lesson = "" } = document.body.dataset, name = host.closest("[data-block]")?.id ?? "";
  const kept = bestOf(`best ${lesson} ${name}`);
  const score = createScore(engine, sketches[0], begin ?? sketches[0], { file, answer, starter });
  let number = 0, ready = false;
  await task.start();
  ready = true;
  await compare();

  async function compare() {
    if (!ready || task.text?.isWrong) return;
    const mine = ++number, now = Math.floor(await score(task.session.state(), task.text?.text ?? ""));
    if (mine !== number) return;
    const best = kept.take(now);
    meter.value = now;
    said.textContent = fill(now >= goal ? words.solved : words.scored, { now, best, goal });
    said.className = `score ${now >= goal ? "right" : ""}`.trim();
  }
}

/** What keeps a best score; a page from a disk may have no memory. @param {string} key */
function bestOf(key) {
  let best = 0;
  try { best = Number(localStorage.getItem(key)) || 0; } catch { /* this visit only */ }
  return {
    take(/** @type {number} */ score) {
      if (score > best) {
        best = score;
        try { localStorage.setItem(key, String(best)); } catch { /* this visit only */ }
      }
      return best;
    },
  };
}
