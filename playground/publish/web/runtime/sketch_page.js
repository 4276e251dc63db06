// sketch_page.js -- a page about one sketch: the picture, its tools and time, the panel, the code.

import { asToml } from "./address.js";
import { copy, make, save as saveFile } from "./dom.js";
import { createFigure } from "./figure.js";
import { iconButton } from "./icons.js";
import { followKeys, keysDialog } from "./keys.js";
import { followAddress } from "./page_address.js";
import { createFullScreen, recallTheme, switchTheme } from "./page_room.js";
import { createPanel } from "./panel.js";
import { createSession } from "./session.js";
import { createTabs } from "./tabs.js";
import { createTimeline, hasTime, stepped } from "./timeline.js";
import { fill } from "./words.js";

/** @typedef {import("./schema.js").Page} Page */
/** @typedef {import("./figure.js").Engine} Engine */
/** @typedef {import("./figure.js").Figure} Figure */
/** @typedef {import("./figure.js").Player} Player */

/** @typedef {object} PageOptions
 *  @property {Object<string, string>} words
 *  @property {HTMLImageElement | null} [poster]
 *  @property {(player: Player) => unknown} [prepare]            what a player needs before its first picture
 *  @property {(player: Player) => Map<string, number>} repeats  iterations in all, by path
 *  @property {(host: HTMLElement, player: Player, figure: Figure) => void} [openCode]
 *                                                     fills the code's tab, once for each player */

const STAYS = 4000; // [ms] of a notice
const OFTEN = 250; // [ms] between two reports of a picture that moves

/** Fill a page's main element. @param {HTMLElement} main @param {Page} page @param {Engine} engine
 *  @param {PageOptions} options */
export function createPage(main, page, engine, options) {
  const { words, poster = null, prepare, repeats, openCode } = options;
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

  const help = keysDialog(words);
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
  const header = make("header", {}, title);
  const tabs = openCode && createTabs([[words.parameters, panel.element], [words.code, code]], (at) => {
    main.classList.toggle("coding", at === 1);
    fillCode();
  });
  if (tabs) header.append(tabs.element);
  const side = make("section", { className: "side", "aria-label": words.parameters });
  side.append(header, panel.element, code, info);
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
  return { figure, panel, session, timeline, showCode: () => tabs?.select(1) };
}
