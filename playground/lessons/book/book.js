// book.js -- what moves in the book: series that are dragged, comparisons that are swiped, choices, the theme.
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
    // A sweep opens in its middle, where there is something to drag towards on both sides.
    show(figure.dataset.kind === "step" ? 0 : frames.length >> 1);
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
    still.prepend(button);
  }

  for (const field of document.querySelectorAll("fieldset")) {
    field.addEventListener("change", (event) => {
      const right = event.target.dataset.right === "yes";
      const verdict = field.querySelector(".verdict");
      verdict.textContent = right ? field.dataset.right : field.dataset.wrong;
      verdict.className = `verdict ${right ? "right" : "wrong"}`;
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

  // Answers lie open on paper, also in a browser whose style sheets cannot open them.
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    for (const each of opened) each.open = true;
  });
  addEventListener("afterprint", () => {
    for (const each of opened) each.open = false;
    opened = [];
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
