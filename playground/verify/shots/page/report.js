// report.js -- one failure at a time: the list, its filters, the keys, copying a command.
//
// The page is whole without it: every failure below the other, with its pictures.
"use strict";

const PASSING = 60; // [ms] how long one looks at a shot at least
const KEPT = 3; // shots whose decoded pictures are kept, for going back and forth

const byId = (id) => document.getElementById(id);
const articles = [...document.querySelectorAll("article.shot")];
const rows = new Map([...document.querySelectorAll("#rows > li")].map((li) => [li.dataset.name, li]));
const decoded = new Map(); // article → promise of its pictures, the latest last
let current = null;
let viewer = null;

/** Tell what review.js, if it is there, is to know: "shown" with the article. */
const listeners = [];

// Pictures

async function bytesOf(source) {
  if (!source.startsWith("data:")) {
    const answer = await fetch(source);
    if (!answer.ok) throw new Error(await answer.text());
    return new Uint8Array(await answer.arrayBuffer());
  }
  return Uint8Array.from(atob(source.slice(source.indexOf(",") + 1)), (c) => c.charCodeAt(0));
}

async function readAll(article) {
  const found = {};
  for (const figure of article.querySelectorAll("figure[data-kind]")) {
    const image = figure.querySelector("img");
    if (!image) continue;
    const { kind } = figure.dataset;
    const bytes = await bytesOf(image.getAttribute("src"));
    found[kind] = kind === "expected" || kind === "actual" ? await exactly(bytes) : await asItLooks(bytes);
  }
  return found;
}

/** A picture whose values are requested. */
async function exactly(bytes) {
  const { width, height, data } = await readPicture(bytes);
  const canvas = make("canvas", { width, height });
  canvas.getContext("2d").putImageData(new ImageData(data, width, height), 0, 0);
  let opaque = true;
  for (let i = 3; opaque && i < data.length; i += 4) opaque = data[i] === 255;
  return { width, height, data, opaque, canvas };
}

/** A picture that is only looked at; it is opaque. */
async function asItLooks(bytes) {
  const canvas = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  return { width: canvas.width, height: canvas.height, opaque: true, canvas };
}

function picturesOf(article) {
  const found = decoded.get(article) ?? readAll(article);
  decoded.delete(article);
  decoded.set(article, found);
  if (decoded.size > KEPT) decoded.delete(decoded.keys().next().value);
  return found;
}

function drawThumbnail(canvas, article) {
  const source = article.querySelector('figure[data-kind="actual"] img')?.getAttribute("src");
  if (!source) {
    const context = canvas.getContext("2d");
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.fillStyle = getComputedStyle(canvas).color;
    context.fillText("no picture", canvas.width / 2, canvas.height / 2 + 4);
    return;
  }
  const image = new Image();
  image.onload = () => {
    const context = canvas.getContext("2d");
    const scale = Math.max(canvas.width / image.width, canvas.height / image.height);
    const [width, height] = [image.width * scale, image.height * scale];
    context.imageSmoothingQuality = "high";
    context.drawImage(image, (canvas.width - width) / 2, (canvas.height - height) / 2, width, height);
  };
  image.src = source;
}

// One failure at a time

async function show(article, { focus = false, remember = true } = {}) {
  if (!article || article === current) return;
  current?.classList.remove("current");
  viewer?.close();
  viewer = null;
  current = article;
  article.classList.add("current");
  for (const [name, row] of rows) {
    const link = row.querySelector("a");
    if (name === article.dataset.name) {
      link.setAttribute("aria-current", "true");
      showInList(row);
    } else link.removeAttribute("aria-current");
  }
  if (remember) history.replaceState(null, "", `#${article.id}`);
  if (focus) article.querySelector("h2").focus();
  sayPosition();
  for (const listener of listeners) listener(article);
  const host = article.querySelector(".viewer");
  if (!article.querySelector("figure[data-kind] img")) return;
  // Who only passes by on the way to another need not wait for these.
  if (!decoded.has(article)) await new Promise((done) => setTimeout(done, PASSING));
  if (current !== article) return;
  try {
    const pictures = await picturesOf(article);
    if (current !== article) return;
    const place = article.dataset.place?.split(",").map(Number) ?? null;
    viewer = new Viewer(host, pictures, place, article.dataset.name);
    article.classList.add("looked-at");
    const next = neighbour(1);
    const ahead = () => current === article && picturesOf(next).catch(() => {}); // shown, it says so itself
    if (next) setTimeout(ahead, 4 * PASSING);
  } catch (error) {
    if (current !== article) return;
    decoded.delete(article);
    host.hidden = false;
    host.replaceChildren(make("p", { className: "note", textContent: `A picture cannot be shown: ${error.message}` }));
  }
}

/** Scroll the list, and nothing else, so that a row of it can be seen. */
function showInList(row) {
  const list = getComputedStyle(byId("rows")).overflowY === "auto" ? byId("rows") : document.querySelector(".list");
  const [inner, outer] = [row.getBoundingClientRect(), list.getBoundingClientRect()];
  const head = list.contains(document.querySelector(".position")) ? document.querySelector(".position").offsetHeight : 0;
  if (inner.top < outer.top + head) list.scrollTop -= outer.top + head - inner.top;
  else if (inner.bottom > Math.min(outer.bottom, innerHeight)) list.scrollTop += inner.bottom - Math.min(outer.bottom, innerHeight);
}

const shownArticles = () => articles.filter((article) => !rows.get(article.dataset.name).hidden);

function neighbour(step) {
  const shown = shownArticles();
  const at = shown.indexOf(current);
  return at < 0 ? shown[0] : shown[at + step];
}

function go(step) {
  const article = neighbour(step);
  if (article) show(article, { focus: true });
}

// Filters

const chosen = new Set(); // words; none: all of them

function filter() {
  const wanted = (byId("search").value ?? "").toLowerCase().split(/\s+/).filter(Boolean);
  const sketch = byId("only-sketch")?.value;
  const renderer = byId("only-renderer")?.value;
  for (const article of articles) {
    const { name, word } = article.dataset;
    const text = `${name} ${article.querySelector(".verdict").textContent} ${word}`.toLowerCase();
    rows.get(name).hidden =
      (chosen.size > 0 && !chosen.has(word)) ||
      (sketch && article.dataset.sketch !== sketch) ||
      (renderer && article.dataset.renderer !== renderer) ||
      !wanted.every((part) => text.includes(part));
  }
  const shown = shownArticles();
  if (!shown.includes(current) && shown.length) show(shown[0]);
  sayPosition();
  for (const listener of listeners) listener(current);
}

function sayPosition() {
  const shown = shownArticles();
  const at = shown.indexOf(current) + 1;
  const all = shown.length === articles.length ? "" : ` (${articles.length} in all)`;
  const many = `${shown.length} failure${shown.length === 1 ? "" : "s"}`;
  byId("shown").textContent = shown.length ? `${at ? `${at} of ` : ""}${many}${all}` : `nothing is left${all}`;
  for (const button of document.querySelectorAll(".step")) {
    const step = Number(button.dataset.step);
    button.disabled = !shown[at - 1 + step] || (at === 0 && step < 0);
  }
}

function setUpFilters() {
  document.querySelector(".filters").hidden = false;
  byId("search").addEventListener("input", filter);
  byId("only-sketch")?.addEventListener("change", filter);
  byId("only-renderer")?.addEventListener("change", filter);
  for (const button of document.querySelectorAll(".words button")) {
    button.addEventListener("click", () => {
      const { word } = button.dataset;
      if (!chosen.delete(word)) chosen.add(word);
      button.setAttribute("aria-pressed", String(chosen.has(word)));
      filter();
    });
  }
}

// Copying

function setUpCopying() {
  for (const button of document.querySelectorAll(".copy")) {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const code = button.previousElementSibling;
      try {
        await navigator.clipboard.writeText(code.textContent);
        button.textContent = "Copied";
      } catch {
        getSelection().selectAllChildren(code); // no clipboard here: at least it is marked
        button.textContent = "Marked";
      }
      setTimeout(() => (button.textContent = "Copy"), 1500);
    });
  }
}

// Keys

const keys = {
  j: () => go(1),
  k: () => go(-1),
  w: () => viewer?.goToWorst(),
  m: () => ((looks.mark = !looks.mark), viewer?.draw()),
  b: () => (viewer?.mode === "blink" ? viewer.toggleBlink() : viewer?.show("blink")),
  e: () => viewer?.only("expected"),
  a: () => viewer?.only("actual"),
  "[": () => viewer?.nudge(-1),
  "]": () => viewer?.nudge(1),
  "+": () => viewer?.zoomBy(2),
  "=": () => viewer?.zoomBy(2),
  "-": () => viewer?.zoomBy(0.5),
  0: () => viewer?.fit(),
  f: () => viewer?.zoomTo(1),
  "/": () => byId("search")?.focus(),
  "?": () => byId("help").showModal(),
};
MODES.forEach((mode, index) => (keys[index + 1] = () => viewer?.show(mode.name)));

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const typing = event.target.closest?.("input:not([type=range], [type=checkbox]), select, textarea");
  if (typing && event.key === "Escape") typing.blur();
  if (typing || document.querySelector("dialog[open]") || !byId("keys-on").checked) return;
  const action = keys[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

// What a person prefers is kept where the browser lets a page keep things.

function remembered(name, value) {
  try {
    if (value !== undefined) localStorage.setItem(name, value);
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

function setUpHelp() {
  const button = byId("help-open");
  button.hidden = false;
  button.addEventListener("click", () => byId("help").showModal());
  byId("help-close").addEventListener("click", () => byId("help").close());
  const box = byId("keys-on");
  box.checked = remembered("shots-keys") !== "off";
  box.addEventListener("change", () => remembered("shots-keys", box.checked ? "on" : "off"));
}

// Beginning

function named(hash) {
  return articles.find((article) => `#${article.id}` === hash);
}

function begin() {
  setUpHelp();
  setUpCopying();
  document.addEventListener("keydown", onKey);
  if (!articles.length) return;
  document.body.classList.add("one-at-a-time");
  setUpFilters();
  const steps = make("div", { className: "steps" });
  for (const [step, text] of [[-1, "Previous"], [1, "Next"]]) {
    const button = make("button", { type: "button", className: "step", textContent: text, dataset: { step } });
    button.addEventListener("click", () => go(step));
    steps.append(button);
  }
  byId("shown").after(steps);
  // On a phone the list would fill the first screen: there it is opened when it is wanted.
  const narrow = matchMedia("(max-width: 52rem)");
  const fold = () => (document.querySelector(".list details").open = !narrow.matches);
  narrow.addEventListener("change", fold);
  fold();
  const thumbnails = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      thumbnails.unobserve(target);
      const name = target.closest("li").dataset.name;
      drawThumbnail(target, articles.find((article) => article.dataset.name === name));
    }
  });
  for (const [name, row] of rows) {
    row.querySelector("a").addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      show(articles.find((article) => article.dataset.name === name), { focus: true });
    });
    thumbnails.observe(row.querySelector("canvas"));
  }
  history.scrollRestoration = "manual";
  addEventListener("hashchange", () => show(named(location.hash), { remember: false }));
  show(named(location.hash) ?? articles[0], { remember: false });
}

begin();
