// remote.js -- the page of a window's remote: rows of what GET parameters says, which follow its events.

import { makeRow } from "./controls.js";
import { make } from "./dom.js";
import { isLike, labelOf } from "./labels.js";
import { isSame, shownValue, toldValue } from "./numbers.js";
import { PAGE_WORDS } from "./page_words.js";

/** @import { Told } from "./numbers.js" */

/** @typedef {{one: Told, label: string, element: HTMLElement, told: (value: any) => void}} Row */

const ECHO = 300; // [ms] after a change of its own that a row takes none from the window: they are older

/** @template {HTMLElement} [Kind=HTMLElement] @param {string} id @returns {Kind} */
const part = (id) => /** @type {Kind} */ (document.getElementById(id));
const time = /** @type {HTMLInputElement} */ (part("time"));
const presets = /** @type {HTMLSelectElement} */ (part("preset"));
const sought = /** @type {HTMLInputElement} */ (part("search"));
const image = /** @type {HTMLImageElement} */ (part("picture"));

/** @type {Map<string, Row>} */
const rows = new Map();
/** Values to be sent with the next frame of the browser. @type {Map<string, any>} */
const pending = new Map();
/** @type {WebSocket | undefined} */
let socket;
/** @type {any} */
let state = {};
let stamp = 0, mark = 0, pictureWanted = false, pictureBusy = false;

/** @param {Object<string, any>} wishes */
function send(wishes) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ id: ++mark, ...wishes }));
}

/** @param {string} path @param {any} value */
function set(path, value) {
  if (!pending.size) requestAnimationFrame(flush);
  pending.set(path, value);
}

function flush() {
  send({ set: Object.fromEntries(pending) });
  pending.clear();
}

function connect() {
  const here = new URL("events", location.href);
  here.protocol = "ws:";
  socket = new WebSocket(here);
  socket.onopen = () => { say(""); list(); };
  socket.onmessage = (message) => take(JSON.parse(message.data));
  socket.onclose = () => { say("The window is closed, or does not answer."); setTimeout(connect, 2000); };
}

/** @param {any} news */
function take(news) {
  if (news.error) return say(news.error);
  if (news.ok) return say(problems());
  if (news.event === "state") showState(news);
  if (news.event === "time") showTime({ ...state, ...news });
  if (news.event === "sketch") list();
  if (news.event === "errors") { state.errors = news.errors; say(problems()); }
  if (news.event === "values")
    for (const [path, value] of Object.entries(news.values)) rows.get(path)?.told(value);
  picture();
  return undefined;
}

const problems = () => (state.errors || []).map((/** @type {any} */ { file, line, message }) =>
  `${file}${line ? `:${line}` : ""}: ${message}`).join("\n");

/** @param {string} text */
function say(text) {
  part("message").textContent = text;
  part("message").hidden = !text;
}

/** @param {any} news */
function showState(news) {
  part("title").textContent = news.title || news.sketch;
  presets.hidden = !news.presets.length;
  const names = news.presets.map((/** @type {string} */ name) => new Option(name, name));
  presets.replaceChildren(new Option("Preset", ""), ...names);
  showTime(news);
  say(problems());
}

/** @param {any} news */
function showTime(news) {
  state = news;
  stamp = performance.now();
  part("play").textContent = state.playing ? "Pause" : "Play";
}

function clock() {
  const moved = state.playing ? ((performance.now() - stamp) / 1000) * state.speed : 0;
  if (state.moves && document.activeElement !== time) time.value = (state.time + moved).toFixed(1);
  if (state.moves && state.playing) picture();
}

async function picture() {
  pictureWanted = true;
  if (pictureBusy) return;
  pictureBusy = true;
  while (pictureWanted && !document.hidden) {
    pictureWanted = false;
    try {
      const answer = await fetch("picture.png?width=640");
      if (answer.ok) {
        const old = image.src;
        image.src = URL.createObjectURL(await answer.blob());
        if (old) URL.revokeObjectURL(old);
      }
    } catch { break; } // the socket says so
    await new Promise((done) => setTimeout(done, 100));
  }
  pictureBusy = false;
}

async function list() {
  const answer = await fetch("parameters");
  if (!answer.ok) return;
  rows.clear();
  const made = [];
  let pass = "", group = "";
  for (const one of /** @type {Told[]} */ (await answer.json())) {
    if (one.pass !== pass) made.push(make("h2", {}, labelOf(one.pass)));
    if (one.group && (one.group !== group || one.pass !== pass)) made.push(make("h3", {}, one.group));
    [pass, group] = [one.pass, one.group];
    const row = rowOf(one);
    rows.set(one.path, row);
    made.push(row.element);
  }
  part("parameters").replaceChildren(...made);
  search();
  picture();
}

/** @param {Told} one @returns {Row} */
function rowOf(one) {
  const inFile = shownValue(one, one.file), locked = one.locked ? "Locked in the window." : "";
  let quiet = 0, late = 0;
  const show = (/** @type {any} */ value) => row.show(value, !isSame(value, inFile));
  const row = makeRow({ ...one, locked }, one.label, {
    words: PAGE_WORDS.en,
    changed(value) {
      quiet = performance.now() + ECHO;
      show(value);
      set(one.path, toldValue(one, value));
    },
    reset() {
      quiet = 0;
      pending.delete(one.path);
      send({ reset: one.path });
    },
    press(down) { if (down) set(one.path, true); },
  });
  show(shownValue(one, one.value));
  const told = (/** @type {any} */ value) => {
    const left = quiet - performance.now();
    clearTimeout(late);
    if (left > 0) late = window.setTimeout(() => told(value), left); // a change meanwhile makes it longer
    else show(shownValue(one, value));
  };
  return { one, label: one.label, element: row.element, told };
}

function search() {
  const words = sought.value.toLowerCase().split(/\s+/).filter(Boolean);
  for (const { one, label, element } of rows.values()) {
    element.hidden = !isLike(/** @type {any} */ (one), label, words);
  }
}

part("play").onclick = () => send({ playing: !state.playing });
time.onchange = () => send({ time: Math.max(+time.value, 0) });
part("undo").onclick = () => send({ undo: true });
part("redo").onclick = () => send({ redo: true });
presets.onchange = () => {
  if (presets.value) send({ preset: presets.value });
  presets.value = "";
};
sought.oninput = search;
setInterval(clock, 250);
connect();
