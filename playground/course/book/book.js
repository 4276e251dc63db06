// book.js -- what moves in the book: series that are dragged, comparisons that are swiped, choices, what
// terms mean, where one is on a page, the theme; the search comes when it is asked for.
"use strict";
(() => {
  const words = document.body.dataset;
  const make = (name, properties = {}, ...inside) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...inside);
    return element;
  };

  // A series: one picture at a time, chosen by a slider, two buttons, or played.
  for (const figure of document.querySelectorAll("figure.series")) {
    const list = figure.querySelector(".frames");
    const frames = [...list.children];
    const labels = frames.map((frame) => frame.querySelector("b").textContent);
    const range = make("input", { type: "range", min: 0, max: frames.length - 1, step: 1 });
    const output = make("output");
    const back = make("button", { type: "button", textContent: "‹", title: words.backward });
    const on = make("button", { type: "button", textContent: "›", title: words.forward });
    const run = make("button", { type: "button", textContent: words.run });
    back.setAttribute("aria-label", words.backward);
    on.setAttribute("aria-label", words.forward);
    range.setAttribute("aria-label", list.dataset.name);
    let timer = 0;
    const show = (index) => {
      frames.forEach((frame, i) => frame.classList.toggle("now", i === index));
      // The neighbours come before they are needed, so that dragging does not stutter.
      for (const i of [index - 1, index, index + 1]) {
        const image = frames[i] && frames[i].querySelector("img");
        if (image) image.loading = "eager";
      }
      range.value = index;
      range.setAttribute("aria-valuetext", labels[index]);
      output.textContent = labels[index];
      // Not disabled: a button that is loses the keys of one who has just pressed it.
      back.setAttribute("aria-disabled", index === 0);
      on.setAttribute("aria-disabled", index === frames.length - 1);
    };
    const halt = () => { clearInterval(timer); timer = 0; run.textContent = words.run; };
    range.addEventListener("input", () => { halt(); show(Number(range.value)); });
    back.addEventListener("click", () => { halt(); show(Math.max(Number(range.value) - 1, 0)); });
    on.addEventListener("click", () => { halt(); show(Math.min(Number(range.value) + 1, frames.length - 1)); });
    run.addEventListener("click", () => {
      if (timer) { halt(); return; }
      if (Number(range.value) === frames.length - 1) show(0);
      run.textContent = words.stop;
      timer = setInterval(() => {
        const next = Number(range.value) + 1;
        if (next >= frames.length) halt(); else show(next);
      }, figure.dataset.kind === "step" ? 900 : 350);
    });
    list.removeAttribute("tabindex");
    figure.classList.add("dragged");
    list.after(make("div", { className: "controls" }, back, range, on, output, run));
    show(Number(figure.dataset.opens));
  }

  // A comparison of two: the second lies over the first, as far as the slider says.
  for (const figure of document.querySelectorAll("figure.compare")) {
    const list = figure.querySelector(".variants");
    if (list.children.length !== 2) continue;
    const range = make("input", { type: "range", min: 0, max: 100, value: 50, step: 1 });
    range.setAttribute("aria-label", list.dataset.swipe);
    const button = make("button", { type: "button" });
    const controls = make("div", { className: "controls" }, range, button);
    const at = (share) => { range.value = share; list.style.setProperty("--at", `${range.value}%`); };
    const overlay = (over) => {
      figure.classList.toggle("swiped", over);
      range.disabled = !over;
      button.textContent = over ? words.side : words.over;
    };
    range.addEventListener("input", () => at(range.value));
    button.addEventListener("click", () => overlay(!figure.classList.contains("swiped")));
    const drag = (event) => {
      if (!figure.classList.contains("swiped") || !(event.buttons & 1)) return;
      const box = list.getBoundingClientRect();
      at(Math.round((100 * (event.clientX - box.left)) / box.width));
    };
    list.addEventListener("pointerdown", (event) => {
      if (!figure.classList.contains("swiped")) return;
      event.preventDefault();
      list.setPointerCapture(event.pointerId);
      drag(event);
    });
    list.addEventListener("pointermove", drag);
    list.style.touchAction = "pan-y";
    list.after(controls);
    at(50);
    overlay(true);
  }

  // A trace: the values of one step beside the code, chosen by a slider; its row of the table is marked.
  for (const figure of document.querySelectorAll("figure.traced")) {
    if (!figure.dataset.steps) continue;
    const labels = JSON.parse(figure.dataset.steps), rows = [...figure.querySelectorAll("tr[data-step]")];
    const beside = [...figure.querySelectorAll("[data-at]")], onPaper = beside.map((each) => each.textContent);
    const range = make("input", { type: "range", min: 0, max: labels.length - 1, step: 1 });
    const output = make("output");
    const back = make("button", { type: "button", textContent: "‹", title: words.backward });
    const on = make("button", { type: "button", textContent: "›", title: words.forward });
    back.setAttribute("aria-label", words.backward);
    on.setAttribute("aria-label", words.forward);
    range.setAttribute("aria-label", figure.dataset.name);
    const show = (index) => {
      for (const each of beside) each.textContent = JSON.parse(each.dataset.at)[index];
      const row = rows.find((each) => Number(each.dataset.step) === index);
      for (const each of rows) {
        if (each === row) each.setAttribute("aria-current", "step"); else each.removeAttribute("aria-current");
      }
      range.value = index;
      const values = beside.map((each) => each.textContent).filter((text) => text && text !== labels[index]);
      range.setAttribute("aria-valuetext", `${labels[index]}: ${values.join("; ")}`);
      output.textContent = labels[index];
      back.setAttribute("aria-disabled", index === 0);
      on.setAttribute("aria-disabled", index === labels.length - 1);
    };
    const at = () => Number(range.value);
    range.addEventListener("input", () => show(at()));
    back.addEventListener("click", () => show(Math.max(at() - 1, 0)));
    on.addEventListener("click", () => show(Math.min(at() + 1, labels.length - 1)));
    for (const row of rows) row.addEventListener("click", () => show(Number(row.dataset.step)));
    figure.querySelector(".beside").after(make("div", { className: "controls" }, back, range, on, output));
    figure.addEventListener("reveal", () => show(at()));
    addEventListener("beforeprint", () => beside.forEach((each, i) => { each.textContent = onPaper[i]; }));
    addEventListener("afterprint", () => show(at()));
    show(0);
  }

  // A question for a number of a trace: right within its tolerance; then, or where its answer is unfolded,
  // the figure shows what it left out.
  const answered = new Set();
  const reveal = (name) => {
    answered.add(name);
    for (const each of document.querySelectorAll("[data-asked][data-full]")) {
      if (!each.dataset.asked.split(" ").every((one) => answered.has(one))) continue;
      if (each.dataset.at) each.dataset.at = each.dataset.full;
      else each.textContent = each.matches("td") ? each.dataset.full : JSON.parse(each.dataset.full)[0];
      each.removeAttribute("data-asked");
      each.closest("figure").dispatchEvent(new Event("reveal"));
    }
  };
  for (const field of document.querySelectorAll(".number")) {
    const input = field.querySelector("input"), verdict = field.querySelector(".verdict");
    const section = field.closest("section");
    const check = () => {
      const text = input.value.replace(/[\s_]/g, "").replace("−", "-").replace(",", ".");
      const is = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? Number(text) : NaN;
      const { value, tolerance } = input.dataset;
      const right = Math.abs(is - Number(value)) <= Number(tolerance) * (1 + 1e-9);
      verdict.textContent = Number.isNaN(is) ? field.dataset.unread : right ? field.dataset.right : field.dataset.wrong;
      verdict.className = `verdict ${right ? "right" : "wrong"}`;
      if (right) reveal(section.id);
    };
    field.hidden = false;
    field.querySelector("button").addEventListener("click", check);
    input.addEventListener("keydown", (event) => { if (event.key === "Enter") check(); });
    // Not by "toggle": printing unfolds all answers as well.
    section.querySelector("details.answer > summary")?.addEventListener("click", () => reveal(section.id));
  }

  // A live figure: its scripts come when one is started, and then serve all figures of the page.
  let runtime = null;
  const added = (element) => new Promise((resolve, reject) => {
    Object.assign(element, { onload: resolve, onerror: reject });
    document.head.append(element);
  });
  const loadRuntime = () => Promise.all([
    added(make("link", { rel: "stylesheet", href: "../live.css" })),
    added(make("script", { src: "../live.js" })),
  ]);
  for (const root of document.querySelectorAll("[data-block]")) {
    const still = root.querySelector(".still");
    const button = make("button", { type: "button", className: "start", textContent: `▶ ${words.live}`, title: words.liveGoal });
    button.addEventListener("click", async () => {
      button.disabled = true;
      button.setAttribute("aria-busy", "true");
      try {
        runtime = runtime || loadRuntime();
        await runtime;
        await playground.start(root, "..", words.lesson);
      } catch (error) {
        runtime = null;
        throw error;
      } finally {
        button.disabled = false;
        button.removeAttribute("aria-busy");
      }
    });
    // A picture itself starts as well, but where pressing it swipes.
    if (root.matches("figure:not(.compare)")) {
      still.classList.add("starts");
      still.addEventListener("click", (event) => { if (event.target.matches("img")) button.click(); });
    }
    still.append(button);
  }

  for (const field of document.querySelectorAll("fieldset")) {
    field.addEventListener("change", (event) => {
      const right = event.target.dataset.right === "yes";
      const verdict = field.querySelector(".verdict");
      verdict.textContent = right ? field.dataset.right : field.dataset.wrong;
      verdict.className = `verdict ${right ? "right" : "wrong"}`;
    });
  }

  // What a term means, under the mouse, with the keys' focus, and at the first tap of a finger.
  const meaning = make("div", { id: "meaning", className: "meaning", hidden: true });
  meaning.setAttribute("role", "tooltip");
  document.body.append(meaning);
  let asked = null, leaving = 0;
  const place = (term) => {
    const [box] = term.getClientRects(), { width, height } = meaning.getBoundingClientRect();
    const left = Math.min(Math.max(box.left, 8), document.documentElement.clientWidth - width - 8);
    const above = box.bottom + height + 14 > innerHeight;
    meaning.style.left = `${left + scrollX}px`;
    meaning.style.top = `${(above ? box.top - height - 6 : box.bottom + 6) + scrollY}px`;
  };
  const forget = () => {
    clearTimeout(leaving);
    asked?.removeAttribute("aria-describedby");
    asked = null;
    meaning.hidden = true;
  };
  const explain = (term) => {
    clearTimeout(leaving);
    if (asked === term) return;
    forget();
    asked = term;
    meaning.textContent = term.dataset.means;
    term.setAttribute("aria-describedby", "meaning");
    meaning.hidden = false;
    place(term);
  };
  const leave = () => { leaving = setTimeout(forget, 200); };
  for (const term of document.querySelectorAll("a.term")) {
    let touched = false;
    term.addEventListener("pointerdown", (event) => { touched = event.pointerType === "touch" && asked !== term; });
    term.addEventListener("click", (event) => {
      if (touched) event.preventDefault();  // a second tap goes to the glossary
      explain(term);
    });
    term.addEventListener("pointerenter", (event) => { if (event.pointerType === "mouse") explain(term); });
    term.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") leave(); });
    term.addEventListener("focus", () => { if (term.matches(":focus-visible")) explain(term); });
    term.addEventListener("blur", forget);
  }
  meaning.addEventListener("pointerenter", () => clearTimeout(leaving));
  meaning.addEventListener("pointerleave", leave);
  addEventListener("keydown", (event) => { if (event.key === "Escape") forget(); });
  addEventListener("pointerdown", (event) => {
    if (asked && event.target !== asked && event.target !== meaning) forget();
  });

  // The contents of the page: open where there is room at the side, with the section that is being read marked.
  const contents = document.querySelector(".toc details");
  if (contents) {
    const room = matchMedia("(min-width: 75rem)");
    const unfold = () => { contents.open = room.matches; };
    room.addEventListener("change", unfold);
    unfold();
    const links = [...contents.querySelectorAll("a")];
    const headings = links.map((link) => document.getElementById(link.hash.slice(1)));
    let waits = false;
    const mark = () => {
      waits = false;
      const ends = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;
      const passed = headings.filter((heading) => heading.getBoundingClientRect().top < innerHeight * 0.3).length;
      const now = ends ? links.length - 1 : passed - 1;
      links.forEach((link, i) => {
        if (i === now) link.setAttribute("aria-current", "true"); else link.removeAttribute("aria-current");
      });
    };
    addEventListener("scroll", () => { if (!waits) { waits = true; requestAnimationFrame(mark); } }, { passive: true });
    mark();
  }

  // The search: its words and what looks through them come the first time.
  const finder = document.getElementById("search");
  if (finder) {
    let found = null;
    const search = async () => {
      // One after the other: find.js reads what words.js has.
      found = found || added(make("script", { src: "words.js" })).then(() => added(make("script", { src: "../find.js" })));
      try { await found; } catch { found = null; return; }
      bookFind();
    };
    finder.hidden = false;
    finder.append(" ", make("kbd", { textContent: "/" }));
    finder.setAttribute("aria-keyshortcuts", "/");
    finder.addEventListener("click", search);
    addEventListener("keydown", (event) => {
      const typing = event.target.closest?.("input:not([type=range]):not([type=radio]):not([type=checkbox]), textarea, select, [contenteditable]");
      if (event.key !== "/" || event.ctrlKey || event.altKey || event.metaKey || typing) return;
      event.preventDefault();
      search();
    });
  }

  if (navigator.clipboard) {
    for (const block of document.querySelectorAll("pre.command")) {
      const button = make("button", { type: "button", textContent: words.copy });
      button.addEventListener("click", async () => {
        try { await navigator.clipboard.writeText(block.textContent); } catch { return; }
        button.textContent = words.copied;
        setTimeout(() => { button.textContent = words.copy; }, 1500);
      });
      const around = make("div", { className: "copied" });
      block.replaceWith(around);
      around.append(block, button);
    }
  }

  // On paper answers are at the end, not under their questions; what else is folded lies open in its place.
  let opened = [];
  let moved = [];
  const atEnd = make("section", { className: "answers on-paper" });
  addEventListener("beforeprint", () => {
    moved = [...document.querySelectorAll("details.answer")].map((answer) => {
      const place = document.createComment("answer");
      answer.replaceWith(place);
      return [answer, place];
    });
    if (moved.length) {
      atEnd.append(make("h2", { textContent: document.body.dataset.answers }));
      for (const [answer] of moved) atEnd.append(make("h3", { textContent: answer.dataset.title }), answer);
      document.querySelector("main").append(atEnd);
    }
    opened = [...document.querySelectorAll("details:not([open])")];
    for (const each of opened) each.open = true;
  });
  addEventListener("afterprint", () => {
    for (const each of opened) each.open = false;
    opened = [];
    for (const [answer, place] of moved) place.replaceWith(answer);
    moved = [];
    atEnd.replaceChildren();
    atEnd.remove();
  });

  // Light or dark: as the system has it, until one chooses. A page opened from a disk may have no memory.
  const root = document.documentElement;
  const recall = () => { try { return localStorage.getItem("theme"); } catch { return null; } };
  const remember = (theme) => { try { localStorage.setItem("theme", theme); } catch { /* this page only */ } };
  const chosen = recall();
  if (chosen === "dark" || chosen === "light") root.dataset.theme = chosen;
  const button = document.getElementById("theme");
  if (button) {
    button.hidden = false;
    button.addEventListener("click", () => {
      const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
      root.dataset.theme = dark ? "light" : "dark";
      remember(root.dataset.theme);
    });
  }
})();
