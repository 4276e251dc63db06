"use strict";
// The teacher's notes: asks the window what is on, and tells it Next and Back.
const at = (name) => document.getElementById(name);
let known = -1;
let state = null;
let since = 0; // when the state came [ms], by this page's own clock

function text(seconds) {
  const whole = Math.max(Math.floor(seconds), 0);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const two = (number) => String(number).padStart(2, "0");
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

function tick() {
  at("wall").textContent = new Date().toLocaleTimeString(document.documentElement.lang, { hour: "2-digit", minute: "2-digit" });
  if (state) {
    const more = state.running ? (performance.now() - since) / 1000 : 0;
    at("elapsed").textContent = text(state.elapsed + more);
  }
}

function show() {
  const labels = state.labels;
  document.documentElement.lang = state.language;
  document.title = `${labels.notes}: ${state.lesson}`;
  at("place").textContent = state.on ? `${state.at} / ${state.count}` : "";
  at("heading").textContent = state.heading;
  at("label").textContent = state.label;
  at("notes").innerHTML = state.notes; // made by the playground from its own lessons
  at("aside").innerHTML = state.aside;
  at("following").textContent = state.coming ? labels.following : labels.over;
  at("coming").innerHTML = state.coming;
  at("pause").textContent = state.running ? labels.pause : labels.go_on;
  at("reset").textContent = labels.reset;
  at("back").textContent = labels.back;
  at("next").textContent = labels.next;
  at("black").textContent = labels.black;
  at("black").setAttribute("aria-pressed", String(state.blank === "black"));
  at("complaint").textContent = state.on ? "" : labels.lost;
  tick();
}

async function follow() {
  for (;;) {
    try {
      const answer = await fetch(`state?since=${known}`);
      if (!answer.ok) throw new Error(await answer.text());
      const found = await answer.json();
      if (found.number !== known && "labels" in found.state) {
        known = found.number;
        state = found.state;
        since = performance.now();
        show();
      }
    } catch {
      if (state) at("complaint").textContent = state.labels.lost;
      await new Promise((done) => setTimeout(done, 1000));
    }
  }
}

async function ask(wishes) {
  try {
    const answer = await fetch("do", { method: "POST", body: JSON.stringify(wishes) });
    if (!answer.ok) at("complaint").textContent = (await answer.text()).trim();
  } catch {
    if (state) at("complaint").textContent = state.labels.lost;
  }
}

at("next").addEventListener("click", () => ask({ go: "next" }));
at("back").addEventListener("click", () => ask({ go: "back" }));
at("black").addEventListener("click", () => ask({ cover: "black" }));
at("pause").addEventListener("click", () => ask({ clock: "pause" }));
at("reset").addEventListener("click", () => ask({ clock: "reset" }));
const keys = { ArrowRight: "next", PageDown: "next", ArrowLeft: "back", PageUp: "back", Home: "first", End: "last" };
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const space = event.key === " " && event.target === document.body;
  const go = space ? "next" : keys[event.key];
  if (go) {
    event.preventDefault();
    ask({ go });
  } else if (event.key === "." || event.key === "b") {
    ask({ cover: "black" });
  }
});
setInterval(tick, 250);
follow();
