// Sliders for one session: each row is made from what /parameters says of it, and follows the events.
"use strict";

const $ = (id) => document.getElementById(id);
const rows = new Map(); // path → { show(value) }
const pending = new Map(); // path → the value that is to be sent with the next frame of the browser
let socket, state = {}, stamp = 0, mark = 0, pictureWanted = false, pictureBusy = false;

// ── to the window ────────────────────────────────────────────────────────────

function send(wishes) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ id: ++mark, ...wishes }));
}

function set(path, value) {
  if (!pending.size) requestAnimationFrame(flush);
  pending.set(path, value);
}

function flush() {
  send({ set: Object.fromEntries(pending) });
  pending.clear();
}

// ── from the window ──────────────────────────────────────────────────────────

function connect() {
  const here = new URL("events", location.href);
  here.protocol = "ws:";
  socket = new WebSocket(here);
  socket.onopen = () => { say(""); list(); };
  socket.onmessage = (message) => take(JSON.parse(message.data));
  socket.onclose = () => { say("The window is closed, or does not answer."); setTimeout(connect, 2000); };
}

function take(news) {
  if (news.error) return say(news.error);
  if (news.ok) return say(problems());
  if (news.event === "state") showState(news);
  if (news.event === "time") showTime({ ...state, ...news });
  if (news.event === "sketch") list();
  if (news.event === "errors") { state.errors = news.errors; say(problems()); }
  if (news.event === "values")
    for (const [path, value] of Object.entries(news.values)) if (rows.has(path)) rows.get(path).show(value);
  picture();
}

function problems() {
  return (state.errors || []).map((e) => `${e.file}${e.line ? ":" + e.line : ""}: ${e.message}`).join("\n");
}

function say(text) {
  $("message").textContent = text;
  $("message").hidden = !text;
}

function showState(news) {
  $("title").textContent = news.title || news.sketch;
  $("preset").hidden = !news.presets.length;
  $("preset").replaceChildren(new Option("Preset", ""), ...news.presets.map((name) => new Option(name, name)));
  showTime(news);
  say(problems());
}

function showTime(news) {
  state = news;
  stamp = performance.now();
  $("play").textContent = state.playing ? "Pause" : "Play";
}

function clock() {
  const moved = state.playing ? ((performance.now() - stamp) / 1000) * state.speed : 0;
  if (state.moves && document.activeElement !== $("time")) $("time").value = (state.time + moved).toFixed(1);
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
        const old = $("picture").src;
        $("picture").src = URL.createObjectURL(await answer.blob());
        if (old) URL.revokeObjectURL(old);
      }
    } catch { break; } // the socket says so
    await new Promise((done) => setTimeout(done, 100));
  }
  pictureBusy = false;
}

// ── rows ─────────────────────────────────────────────────────────────────────

// "base_height" is headed "Base height", and "iChannel0" as the shader has it.
function heading(pass) {
  const words = pass.replaceAll("_", " ");
  return /^[^A-Z]*( |$)/.test(words) ? words[0].toUpperCase() + words.slice(1) : words;
}

async function list() {
  const answer = await fetch("parameters");
  if (!answer.ok) return;
  rows.clear();
  const made = [];
  let pass = "", group = "";
  for (const one of await answer.json()) {
    if (one.pass !== pass) made.push(element("h2", heading(one.pass)));
    if (one.group && (one.group !== group || one.pass !== pass)) made.push(element("h3", one.group));
    [pass, group] = [one.pass, one.group];
    made.push(row(one));
  }
  $("parameters").replaceChildren(...made);
  search();
  picture();
}

function element(kind, text, name) {
  const made = document.createElement(kind);
  if (text) made.textContent = text;
  if (name) made.className = name;
  return made;
}

function row(one) {
  const made = element("div", "", "row"), head = element("div", "", "head"), shown = element("output");
  made.title = [one.description, one.path].filter(Boolean).join("\n");
  made.dataset.words = `${one.label} ${one.path} ${one.group}`.toLowerCase();
  head.append(element("span", one.label, "name"), shown);
  made.append(head);
  const control = (controls[one.widget] || numbers)(one, (value) => { write(value); set(one.path, value); });
  made.append(control.element);
  for (const input of made.querySelectorAll("input, select")) {
    input.disabled = one.locked;
    input.setAttribute("aria-label", [one.label, input.dataset.part].filter(Boolean).join(", "));
  }
  const write = (value) => {
    const text = Array.isArray(value) ? value.map(short).join(", ") : typeof value === "number" ? short(value) : "";
    shown.textContent = text && one.unit ? `${text} ${one.unit}` : text;
    made.classList.toggle("changed", JSON.stringify(value) !== JSON.stringify(one.file));
  };
  const show = (value) => { if (!made.contains(document.activeElement) || one.widget === "checkbox") control.show(value); write(value); };
  show(one.value);
  rows.set(one.path, { show });
  return made;
}

const short = (number) => String(+number.toPrecision(5));

const controls = {
  checkbox(one, changed) {
    const input = element("input");
    input.type = "checkbox";
    input.onchange = () => changed(input.checked);
    return { element: input, show: (value) => { input.checked = value; } };
  },
  button(one) {
    const input = element("button", one.label);
    input.type = "button";
    input.onclick = () => set(one.path, true);
    return { element: input, show: () => {} };
  },
  menu(one, changed) {
    const input = element("select");
    input.append(...one.choices.map((name) => new Option(name, name)));
    input.onchange = () => changed(input.value);
    return { element: input, show: (value) => { input.value = value; } };
  },
  colour(one, changed) {
    const input = element("input");
    input.type = "color";
    input.oninput = () => changed(input.value);
    return { element: input, show: (value) => { if (typeof value === "string") input.value = value; } };
  },
  file(one, changed) {
    const input = element("input");
    input.type = "text";
    input.onchange = () => changed(input.value);
    return { element: input, show: (value) => { input.value = value; } };
  },
};

const STEPS = 1000; // of a slider without a step of its own

function numbers(one, changed) {
  const made = element("div"), parts = one.parts.length ? one.parts : [""];
  let now = [];
  const inputs = parts.map((name, at) => {
    const line = element("label", "", "part"), input = element("input");
    if (name) line.append(element("span", name));
    input.dataset.part = name;
    const scale = scaleOf(one, at);
    input.type = scale ? "range" : "number";
    if (scale) [input.min, input.max, input.step] = [0, 1, 1 / STEPS];
    else input.step = "any";
    input.oninput = () => {
      const number = scale ? scale.value(+input.value) : +input.value;
      if (!Number.isFinite(number)) return;
      now = now.map((old, part) => (part === at ? number : old));
      changed(one.parts.length ? now : now[0]);
    };
    line.append(input);
    made.append(line);
    return { show: (number) => { input.value = scale ? scale.share(number) : number; } };
  });
  const show = (value) => {
    now = Array.isArray(value) ? [...value] : [value];
    inputs.forEach((input, at) => input.show(now[at]));
  };
  return { element: made, show };
}

function scaleOf(one, at) {
  if (!one.ranges[at]) return null;
  const [low, high] = one.ranges[at];
  if (!(high > low)) return null;
  const whole = /^(u?int|[iu]vec)/.test(one.type), step = one.step || (whole ? 1 : 0);
  const log = one.widget === "log_slider";
  const snapped = (number) => {
    const near = step ? low + Math.round((number - low) / step) * step : +number.toPrecision(6);
    return Math.min(Math.max(whole ? Math.round(near) : near, low), high);
  };
  return {
    value: (share) => snapped(log ? low * (high / low) ** share : low + share * (high - low)),
    share: (number) => (log ? Math.log(number / low) / Math.log(high / low) : (number - low) / (high - low)),
  };
}

function search() {
  const words = $("search").value.toLowerCase().split(/\s+/).filter(Boolean);
  for (const made of document.querySelectorAll(".row"))
    made.hidden = !words.every((word) => made.dataset.words.includes(word));
}

$("play").onclick = () => send({ playing: !state.playing });
$("time").onchange = () => send({ time: Math.max(+$("time").value, 0) });
$("undo").onclick = () => send({ undo: true });
$("redo").onclick = () => send({ redo: true });
$("preset").onchange = () => { if ($("preset").value) send({ preset: $("preset").value }); $("preset").value = ""; };
$("search").oninput = search;
setInterval(clock, 250);
connect();
