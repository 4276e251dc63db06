// sketch_page.js -- a page about one sketch: the picture, its tools and time, the panel, the code, its address.

import { asToml, fragmentOf, readFragment } from "./address.js";
import { copy, make } from "./dom.js";
import { createFigure } from "./figure.js";
import { iconButton } from "./icons.js";
import { followKeys, keysDialog } from "./keys.js";
import { createPanel } from "./panel.js";
import { createSession, terrainRows } from "./session.js";
import { createTimeline, hasTime, stepped } from "./timeline.js";
import { ENGLISH, fill } from "./words.js";

/** @typedef {import("./schema.js").Page} Page */
/** @typedef {import("./figure.js").Engine} Engine */
/** @typedef {import("./figure.js").Player} Player */
/** What makes the tab of the code; `close` where it has to end.
 *  @typedef {(host: HTMLElement, player: any, options: {words: Object<string, string>}) => ({close?: () => void} | void)} CreateEditor */

const STAYS = 4000; // [ms] of a notice
const SETTLED = 400; // [ms] without a change until the address says it

/** Fill a page's main element. @param {HTMLElement} main @param {Page} page @param {Engine} engine
 *  @param {{words?: Object<string, string>, createEditor?: CreateEditor, poster?: HTMLImageElement | null}} [options] */
export function createPage(main, page, engine, { words = ENGLISH, createEditor, poster = null } = {}) {
  const session = createSession(page.sketches);
  const root = document.documentElement;
  const still = matchMedia("(prefers-reduced-motion: reduce)");

  // ── the picture ────────────────────────────────────────────────────────────

  const view = make("section", { className: "view", "aria-label": words.ownPicture });
  const textures = make("select", { className: "textures", "aria-label": words.map, title: words.map });
  const info = make("p", { className: "info" });
  let began = false, shown = 0;
  const figure = createFigure(view, engine, page, {
    session, words, poster,
    opened: (player) => { openCode(player); },
    drawn() {
      if (!began && hasTime(session.sketch) && !still.matches) timeline.play(true);
      began = true;
      if (performance.now() - shown < 250 && figure.playing) return;
      shown = performance.now();
      info.textContent = fill(words.frameTook, { size: `${figure.canvas.width} × ${figure.canvas.height}`, time: figure.took.toFixed(0) });
      panel.refresh();
    },
  });
  const timeline = createTimeline(figure, words);
  let notice = 0;
  const say = (/** @type {string} */ text) => {
    figure.say(text);
    clearTimeout(notice);
    notice = setTimeout(() => figure.say(""), STAYS);
  };

  function listTextures() {
    const { sketch } = session, now = session.map;
    textures.replaceChildren(make("option", { value: "" }, words.ownPicture), ...sketch.textures.map((one, at) =>
      make("option", { value: String(at), selected: one.path === now?.path && one.output === now.output }, one.label)));
    textures.hidden = !sketch.textures.length;
  }
  const chooseMap = (/** @type {number} */ at) => figure.showMap(session.sketch.textures[at] ?? null);
  textures.onchange = () => chooseMap(textures.value === "" ? -1 : +textures.value);

  function save() {
    figure.canvas.toBlob((blob) => {
      if (!blob) return;
      const name = `${session.sketch.name.replace(/[^\w.-]+/g, "_") || "picture"}.png`, url = URL.createObjectURL(blob);
      make("a", { href: url, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(url), STAYS);
      say(fill(words.saved, { name }));
    });
  }

  // ── the room ───────────────────────────────────────────────────────────────

  const isFull = () => Boolean(document.fullscreenElement) || main.classList.contains("filled");
  async function full() {
    if (isFull()) {
      main.classList.remove("filled");
      if (document.fullscreenElement) await document.exitFullscreen();
    } else if (main.requestFullscreen) await main.requestFullscreen().catch(() => main.classList.add("filled"));
    else main.classList.add("filled"); // a phone that fills the screen with films only
    filled();
  }
  function filled() {
    main.classList.toggle("alone", isFull());
    const tool = /** @type {HTMLElement} */ (tools.querySelector(".tool-full"));
    tool.title = isFull() ? words.leaveFull : words.full;
    tool.setAttribute("aria-label", tool.title);
  }
  document.addEventListener("fullscreenchange", filled);

  function theme() {
    const dark = (root.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
    root.dataset.theme = dark ? "light" : "dark";
    try { localStorage.setItem("playground-theme", root.dataset.theme); } catch { /* it is not remembered */ }
  }
  try {
    const known = localStorage.getItem("playground-theme");
    if (known === "light" || known === "dark") root.dataset.theme = known;
  } catch { /* none is remembered */ }

  const help = keysDialog(words);
  const toggleHelp = () => (help.open ? help.close() : help.showModal());
  const togglePanel = () => main.classList.toggle("alone");
  const tools = make("div", { className: "tools", role: "toolbar", "aria-label": words.map },
    textures, iconButton("view", `${words.resetView} (R)`, figure.resetView), iconButton("save", `${words.save} (S)`, save),
    iconButton("full", words.full, full), iconButton("theme", words.theme, theme), iconButton("keys", `${words.keys} (?)`, toggleHelp),
    iconButton("panel", `${words.panel} (P)`, togglePanel));
  view.append(tools, timeline.element);

  // ── the panel and the code ─────────────────────────────────────────────────

  const panel = createPanel(figure, {
    words, labels: page.labels, say,
    link: () => (session.anyChanged() || session.camera ? `${location.href.split("#")[0]}#${fragment()}` : location.href.split("#")[0]),
    copied: async (text) => say((await copy(text)) ? words.copied : words.notCopied),
  });
  const code = make("div", { className: "code", id: "playground-code", role: "tabpanel", hidden: true, "aria-label": words.code });
  panel.element.id = "playground-panel";
  const tabs = createEditor ? tabsOf([[words.parameters, panel.element], [words.code, code]], () => openCode(figure.player)) : null;
  if (tabs) panel.element.setAttribute("role", "tabpanel");
  const title = make("h1", {}), side = make("section", { className: "side", "aria-label": words.parameters },
    make("header", {}, title, ...(tabs ? [tabs] : [])), panel.element, code, info);
  const values = make("pre", { className: "on-paper" });
  main.append(view, side, help, values);

  /** @type {{close?: () => void} | void} */
  let editor;
  /** @type {Player | null} */
  let edited = null;
  /** Fill the code's tab, once it is looked at; of another player anew. @param {Player | null} player */
  function openCode(player) {
    if (!createEditor || code.hidden || !player || player === edited) return;
    editor?.close?.();
    code.replaceChildren();
    edited = player;
    editor = createEditor(code, player, { words });
  }

  // ── the address ────────────────────────────────────────────────────────────

  let settling = 0;
  const fragment = () => fragmentOf(session, { time: !figure.playing && hasTime(session.sketch) });
  function address() {
    const text = fragment();
    try {
      history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
    } catch { /* the browser keeps the address of this page as it is */ }
  }
  function readAddress() {
    const link = readFragment(location.hash, page.sketches, (sketch) => [...sketch.shown, ...terrainRows(sketch)]);
    session.begin(link);
    if (link.refused.length) say(fill(words.refused, { names: link.refused.slice(0, 5).join(", ") }));
  }
  const settle = () => {
    clearTimeout(settling);
    settling = setTimeout(address, SETTLED);
  };

  session.follow((news) => {
    if (news === "sketch") {
      document.title = title.textContent = session.sketch.title || session.sketch.name;
      main.style.setProperty("--aspect", String(session.sketch.frame[0] / session.sketch.frame[1]));
    }
    if (news === "sketch" || news === "map") listTextures();
    if (news !== "time" || !figure.playing) settle();
  });
  addEventListener("hashchange", () => { if (location.hash.slice(1) !== fragment()) readAddress(); });
  addEventListener("beforeprint", () => { values.textContent = session.anyChanged() ? `${words.changedValues}\n\n${asToml(session, session.sketch.name)}` : ""; });

  const step = (/** @type {number} */ frames) => { timeline.play(false); session.setTime(stepped(session.time, frames)); };
  followKeys(document, {
    turn: figure.turn, move: figure.move, zoom: figure.zoom,
    by: {
      resetView: figure.resetView, save, full, theme, panel: togglePanel, help: toggleHelp,
      play: () => { if (hasTime(session.sketch)) timeline.toggle(); },
      back: () => step(-1), on: () => step(1), start: () => session.setTime(0),
      map: () => chooseMap(session.sketch.textures.findIndex((one) => one.path === session.map?.path && one.output === session.map.output) + 1),
      search: () => { main.classList.remove("alone"); panel.search.focus(); },
      undo: () => { if (session.undo()) say(words.undone); },
      redo: () => { if (session.redo()) say(words.redone); },
    },
  }, figure.canvas);
  readAddress();
  return { figure, panel, session };
}

/** Tabs over elements of which one is shown. @param {[string, HTMLElement][]} pages @param {() => void} changed */
function tabsOf(pages, changed) {
  const tabs = pages.map(([label, page], at) => {
    const tab = make("button", { type: "button", role: "tab", "aria-controls": page.id, "aria-selected": at === 0, tabIndex: at ? -1 : 0, onclick: () => select(at) }, label);
    tab.onkeydown = (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (by) select((at + by + pages.length) % pages.length).focus();
    };
    return tab;
  });
  const select = (/** @type {number} */ chosen) => {
    pages.forEach(([, page], at) => {
      page.hidden = at !== chosen;
      tabs[at].setAttribute("aria-selected", String(at === chosen));
      tabs[at].tabIndex = at === chosen ? 0 : -1;
    });
    changed();
    return tabs[chosen];
  };
  return make("div", { role: "tablist", className: "tabs" }, ...tabs);
}
