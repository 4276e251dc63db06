// sketch_page.js -- a page about one sketch: the picture, its tools and time, the panel, the code.

import { asToml, followAddress } from "./address.js";
import { button, copy, isTyping, make, save as saveFile, svg } from "./dom.js";
import { createFigure } from "./figure.js";
import { createPanel } from "./panel.js";
import { createSession } from "./session.js";
import { createTimeline, hasTime, stepped } from "./timeline.js";
import { fill } from "./words.js";

/** @import { Engine, Figure, Player } from "./figure.js"
 *  @import { Page } from "./schema.js" */

// ── The pictures on buttons, drawn as lines.

/** Lines in a square of 16 by 16. */
const LINES = {
  full: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4",
  save: "M8 2v8M4.5 7 8 10.500 11.500 7M2.500 13.500h11",
  view: "M3 7.500 8 3l5 4.500M4.500 7v6h7V7",
  keys: "M5.500 6a2.500 2.500 0 1 1 3.700 2.200C8.300 8.700 8 9.200 8 10M8 12.800v.4",
  theme: "M8 2a6 6 0 1 0 0 12V2ZM8 2a6 6 0 0 1 0 12",
  panel: "M2 3h12v10H2ZM10 3v10",
  trace: "M3 2.500h10M3 6h4M9.500 6H13M3 9.500h4M9.500 9.500H13M3 13h10",
};

/** A button with a picture; its label is for those who do not see it, and a tooltip.
 *  @param {keyof typeof LINES} name @param {string} label @param {() => void} act */
function iconButton(name, label, act) {
  const drawn = svg(
    "svg",
    { viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" },
    svg("path", { d: LINES[name] }),
  );
  return make(
    "button",
    { type: "button", className: `tool tool-${name}`, title: label, "aria-label": label, onclick: act },
    drawn,
  );
}

// ── Tabs over elements of which one is shown.

/** Make the tabs; each element has an id. @param {[string, HTMLElement][]} pages
 *  @param {(chosen: number) => void} changed */
function createTabs(pages, changed) {
  const tabs = pages.map(([label, page], at) => {
    const tab = make("button", { type: "button", role: "tab", "aria-controls": page.id }, label);
    page.setAttribute("role", "tabpanel");
    page.setAttribute("aria-label", label);
    tab.onclick = () => select(at);
    tab.onkeydown = (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (by) select((at + by + pages.length) % pages.length).focus();
    };
    return tab;
  });

  function select(/** @type {number} */ chosen) {
    pages.forEach(([, page], at) => {
      page.hidden = at !== chosen;
      tabs[at].setAttribute("aria-selected", String(at === chosen));
      tabs[at].tabIndex = at === chosen ? 0 : -1;
    });
    changed(chosen);
    return tabs[chosen];
  }
  select(0);
  return { element: make("div", { role: "tablist", className: "tabs" }, ...tabs), select };
}

// ── What each key does in a page: one table, which the list of keys shows as well.

/** @typedef {Object<string, string>} Words */
/** What the keys do.
 *  @typedef {object} Acts
 *  @property {(across: number, down: number) => void} turn  shares of the picture's height
 *  @property {(across: number, down: number) => void} move
 *  @property {(notches: number) => void} zoom
 *  @property {Object<string, () => void>} by                by the names of the table */

const STEP = 1 / 36; // of the picture's height an arrow turns: 5 degrees
/** @type {Object<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] };

/** Key → what it does, and the name of its meaning in the words. @type {[string, string, string][]} */
const KEYS = [
  ["r", "resetView", "keyResetView"],
  [" ", "play", "keyPlay"],
  [",", "back", "keyFrame"],
  [".", "on", "keyFrame"],
  ["0", "start", "keyStart"],
  ["m", "map", "keyMap"],
  ["s", "save", "keySave"],
  ["p", "panel", "keyPanel"],
  ["t", "trace", "keyTrace"],
  ["/", "search", "keySearch"],
  ["f", "full", "keyFull"],
  ["?", "help", "keyHelp"],
];

/** Act on keys, unless they are typed into a field. @param {Document} document @param {Acts} acts
 *  @param {HTMLElement} canvas */
function followKeys(document, acts, canvas) {
  document.addEventListener("keydown", (event) => {
    const { target, key } = event,
      ctrl = event.ctrlKey || event.metaKey;
    if (event.defaultPrevented || event.altKey || document.querySelector("dialog[open]")) return;
    if (isTyping(target)) {
      if (key === "Escape" && target instanceof HTMLElement) target.blur();
      return;
    }
    const act = () => {
      if (ctrl)
        return { z: event.shiftKey ? acts.by.redo : acts.by.undo, y: acts.by.redo }[key.toLowerCase()];
      const free = target === canvas || target === document.body,
        arrow = ARROWS[key];
      if (arrow)
        return free
          ? () => (event.shiftKey ? acts.move(-arrow[0], -arrow[1]) : acts.turn(...arrow))
          : undefined;
      if (key === "+" || key === "=") return () => acts.zoom(1);
      if (key === "-") return () => acts.zoom(-1);
      if (key === " " && !free) return undefined;
      const found = KEYS.find(([name]) => name === key.toLowerCase());
      return found && acts.by[found[1]];
    };
    const done = act();
    if (!done) return;
    event.preventDefault();
    done();
  });
}

/** Make the list of keys, a dialog: those that have words, for not every page has all.
 *  @param {Words} words */
function keysDialog(words) {
  const keys = KEYS.filter(([, , meaning]) => words[meaning]);
  const line = (/** @type {string} */ keys, /** @type {string} */ meaning) => [
    make("dt", {}, ...keys.split(" | ").map((key) => make("kbd", {}, key))),
    make("dd", {}, meaning),
  ];
  const named = new Map(
    keys.map(([, , meaning]) => [
      meaning,
      keys.filter((key) => key[2] === meaning)
        .map(([key]) => (key === " " ? words.space : key.toUpperCase()))
        .join(" | "),
    ]),
  );
  const dialog = make("dialog", { className: "keys", "aria-label": words.keys });
  dialog.append(
    make("h2", {}, words.keys),
    make(
      "dl",
      {},
      ...line(words.arrows, words.keyOrbit),
      ...line(words.shiftArrows, words.keyPan),
      ...line("+ | −", words.keyZoom),
      ...[...named].flatMap(([meaning, keys]) => line(keys, words[meaning])),
      ...line("Ctrl+Z | Ctrl+Shift+Z", words.keyUndo),
      ...line("Esc", words.keyClose),
    ),
    make("p", {}, words.mouse),
    make("p", {}, words.touch),
    make("p", {}, words.rows),
    button(words.close, () => dialog.close()),
  );
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
  return dialog;
}

// ── The room of a page: the whole screen or the window, with the panel or alone, light or dark.

const KEY = "playground-theme";

/** Fill the screen with an element, or no longer. Where a browser fills it with films only, as on some
 *  phones, the element fills the window.
 *  @param {HTMLElement} main @param {(full: boolean) => void} changed */
function createFullScreen(main, changed) {
  const isFull = () => document.fullscreenElement === main || main.classList.contains("filled");
  const show = () => {
    main.classList.toggle("alone", isFull());
    changed(isFull());
  };
  document.addEventListener("fullscreenchange", show);
  return async () => {
    if (document.fullscreenElement) return document.exitFullscreen();
    if (main.classList.contains("filled")) main.classList.remove("filled");
    else {
      try {
        return await main.requestFullscreen();
      } catch {
        main.classList.add("filled");
      }
    }
    return show();
  };
}

/** Light if it is dark, and the other way round; the browser remembers it, where it may. */
function switchTheme() {
  const { dataset } = document.documentElement;
  const usual = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  dataset.theme = (dataset.theme || usual) === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(KEY, dataset.theme);
  } catch { /* it is not remembered */ }
}

/** As it was switched before. */
function recallTheme() {
  try {
    const known = localStorage.getItem(KEY);
    if (known === "light" || known === "dark") document.documentElement.dataset.theme = known;
  } catch { /* none is remembered */ }
}

// ── A page about one sketch

/** @typedef {object} PageOptions
 *  @property {Object<string, string>} words
 *  @property {HTMLImageElement | null} [poster]
 *  @property {(player: Player) => unknown} [prepare]            what a player needs before its first picture
 *  @property {(player: Player) => Map<string, number>} repeats  iterations in all, by path
 *  @property {(host: HTMLElement, player: Player, figure: Figure) => void} [openCode]
 *                                                     fills the code's tab, once for each player
 *  @property {(engine: Engine, figure: Figure, open: () => void) => TraceTab} [trace]
 *                                                     in a page with traced texts: trace.js */
/** @typedef {{label: string, tool: string, keyTrace: string, element: HTMLElement,
 *             toggle: () => boolean}} TraceTab */

const STAYS = 4000; // [ms] of a notice
const OFTEN = 250; // [ms] between two reports of a picture that moves

/** Fill a page's main element. @param {HTMLElement} main @param {Page} page @param {Engine} engine
 *  @param {PageOptions} options */
export function createPage(main, page, engine, options) {
  const { words, poster = null, prepare, repeats, openCode, trace } = options;
  const session = createSession(page.sketches);
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const view = make("section", { className: "view", "aria-label": words.ownPicture });
  const textures = make("select", { className: "textures", "aria-label": words.map, title: words.map });
  const info = make("p", { className: "info" }), title = make("h1");
  let began = false, reported = 0, noticed = 0;

  // ── the picture ────────────────────────────────────────────────────────────

  const hooks = { prepare, opened: fillCode, drawn };
  const figure = createFigure(view, engine, page, { session, words, poster, ...hooks });
  const timeline = createTimeline(figure, words);

  function drawn() {
    if (!began && hasTime(session.sketch) && !still.matches) timeline.play(true);
    began = true;
    const now = performance.now();
    if (now - reported < OFTEN && figure.playing) return;
    reported = now;
    const size = `${figure.canvas.width} × ${figure.canvas.height}`;
    info.textContent = fill(words.frameTook, { size, time: figure.took.toFixed(0) });
    panel.refresh();
  }

  function say(/** @type {string} */ text) {
    figure.say(text);
    clearTimeout(noticed);
    noticed = setTimeout(() => figure.say(""), STAYS);
  }

  function shownTexture() {
    const { map, sketch } = session;
    return sketch.textures.findIndex(({ path, output }) => path === map?.path && output === map.output);
  }
  const showTexture = (/** @type {number} */ at) => figure.showMap(session.sketch.textures[at] ?? null);

  function listTextures() {
    const offered = session.sketch.textures.map(({ label }, at) =>
      make("option", { value: String(at) }, label));
    textures.replaceChildren(make("option", { value: "-1" }, words.ownPicture), ...offered);
    textures.value = String(shownTexture());
    textures.hidden = !offered.length;
  }
  textures.onchange = () => showTexture(+textures.value);

  function save() {
    figure.canvas.toBlob((blob) => {
      if (!blob) return;
      const name = `${session.sketch.name.replace(/[^\w.-]+/g, "_") || "picture"}.png`;
      saveFile(blob, name);
      say(fill(words.saved, { name }));
    });
  }

  // ── its tools ──────────────────────────────────────────────────────────────

  const full = createFullScreen(main, (isFull) => {
    fullTool.title = isFull ? words.leaveFull : words.full;
    fullTool.setAttribute("aria-label", fullTool.title);
  });
  const toggleHelp = () => (help.open ? help.close() : help.showModal());
  const togglePanel = () => main.classList.toggle("alone");
  const fullTool = iconButton("full", words.full, full);
  const tools = make("div", { className: "tools", role: "toolbar", "aria-label": words.tools },
    textures, iconButton("view", `${words.resetView} (R)`, figure.resetView),
    iconButton("save", `${words.save} (S)`, save), fullTool, iconButton("theme", words.theme, switchTheme),
    iconButton("keys", `${words.keys} (?)`, toggleHelp),
    iconButton("panel", `${words.panel} (P)`, togglePanel));
  view.append(tools, timeline.element);

  // ── the panel, the code, the address ───────────────────────────────────────

  const address = followAddress(session, () => !figure.playing && hasTime(session.sketch),
    (names) => say(fill(words.refused, { names: names.slice(0, 5).join(", ") })));
  const panel = createPanel(session, {
    words, say, link: address.link, fitMap: figure.fitMap,
    copied: async (text) => say((await copy(text)) ? words.copied : words.notCopied),
    repeats: () => (figure.player ? repeats(figure.player) : new Map()),
  });
  const code = make("div", { className: "code", id: "playground-code", hidden: true });
  panel.element.id = "playground-panel";
  /** @type {Player | null} */
  let opened = null;
  /** Once it is looked at; of another player anew. */
  function fillCode() {
    const { player } = figure;
    if (!openCode || code.hidden || !player || player === opened) return;
    opened = player;
    code.replaceChildren();
    openCode(code, player, figure);
  }
  const traced = trace?.(engine, figure, () => {
    main.classList.remove("alone");
    tabs?.select(2);
  });
  const traceTool = traced && iconButton("trace", `${traced.tool} (T)`, toggleTrace);
  function toggleTrace() {
    const isOn = traced?.toggle();
    traceTool?.setAttribute("aria-pressed", String(isOn));
  }
  if (traceTool) {
    traceTool.setAttribute("aria-pressed", "false");
    tools.insertBefore(traceTool, tools.children[1]);
  }
  const help = keysDialog({ ...words, ...(traced && { keyTrace: traced.keyTrace }) });
  const header = make("header", {}, title);
  /** @type {[string, HTMLElement][]} */
  const pages = [[words.parameters, panel.element], [words.code, code]];
  if (traced) pages.push([traced.label, Object.assign(traced.element, { id: "playground-trace" })]);
  const tabs = openCode && createTabs(pages, (at) => {
    main.classList.toggle("coding", at > 0);
    fillCode();
  });
  if (tabs) header.append(tabs.element);
  const side = make("section", { className: "side", "aria-label": words.parameters });
  side.append(header, ...pages.map(([, page]) => page), info);
  const onPaper = make("pre", { className: "on-paper" });
  main.append(view, side, help, onPaper);
  addEventListener("beforeprint", () => {
    const text = session.edits.size ? asToml(session, session.sketch.name) : "";
    onPaper.textContent = text && `${words.changedValues}\n\n${text}`;
  });

  session.follow((news) => {
    const { sketch } = session;
    if (news === "sketch") {
      document.title = title.textContent = sketch.title || sketch.name;
      main.style.setProperty("--aspect", String(sketch.frame[0] / sketch.frame[1]));
    }
    if (news === "sketch" || news === "map") listTextures();
  });

  // ── the keys ───────────────────────────────────────────────────────────────

  function step(/** @type {number} */ frames) {
    if (!hasTime(session.sketch)) return;
    timeline.play(false);
    session.setTime(stepped(session.time, frames));
  }
  followKeys(document, {
    turn: figure.turn, move: figure.move, zoom: figure.zoom,
    by: {
      resetView: figure.resetView, save, full, panel: togglePanel, help: toggleHelp,
      play: () => { if (hasTime(session.sketch)) timeline.toggle(); },
      back: () => step(-1),
      on: () => step(1),
      start: () => session.setTime(0),
      map: () => showTexture(shownTexture() + 1),
      ...(traced ? { trace: toggleTrace } : {}),
      search() {
        main.classList.remove("alone");
        tabs?.select(0);
        panel.search.focus();
      },
      undo: () => { if (session.undo()) say(words.undone); },
      redo: () => { if (session.redo()) say(words.redone); },
    },
  }, figure.canvas);
  recallTheme();
  address.read();
  return { figure, panel, session, timeline, traced, showCode: () => tabs?.select(1) };
}
