// find.js -- the search of the book: words.js has the texts, nothing leaves the page. Accents do not count.
"use strict";
globalThis.bookFind = (() => {
  const words = document.body.dataset, MAX_HITS = 30, AROUND = 70;
  const make = (name, properties = {}, ...inside) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...inside);
    return element;
  };

  // As it is compared: small letters without accents, as many for each letter as `fold` gives of it alone.
  const fold = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase()
    .replaceAll("\u0153", "oe").replaceAll("\u00e6", "ae").replaceAll("\u2019", "'");
  const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
  const start = (word) => new RegExp(`(?<![\\p{L}\\p{N}])${escaped(word)}`, "gu");

  // Each: an address, the title of its page, of its section, its text.
  const entries = globalThis.bookWords.map(([address, page, section, text]) => (
    { address, page, section, text, folded: [page, section, text].map(fold) }));

  function find(query) {
    const asked = fold(query).split(/[\s,;]+/).filter(Boolean).map(start);
    if (!asked.length) return [];
    const found = [];
    for (const entry of entries) {
      let score = 0, all = true;
      for (const word of asked) {
        const [page, section, text] = entry.folded.map((each) => (each.match(word) ?? []).length);
        all &&= page + section + text > 0;
        score += 6 * Math.min(page, 1) + 10 * Math.min(section, 1) + Math.min(text, 4);
      }
      if (all) found.push({ entry, score });
    }
    return found.sort((one, other) => other.score - one.score).map(({ entry }) => entry);
  }

  // Where words stand in a text, in its own letters.
  function places(text, query) {
    let folded = "";
    const of = [];
    for (let at = 0; at < text.length; at++) {
      const letters = fold(text[at]);
      for (let i = 0; i < letters.length; i++) of.push(at);
      folded += letters;
    }
    of.push(text.length);
    const asked = fold(query).split(/[\s,;]+/).filter(Boolean);
    return asked.flatMap((word) => [...folded.matchAll(start(word))].map(({ index }) => [of[index], of[index + word.length]]))
      .sort(([one], [other]) => one - other);
  }

  function marked(text, query, from = 0, to = text.length) {
    const parts = [];
    let at = from;
    for (const [first, last] of places(text, query)) {
      if (first < at || last > to) continue;
      parts.push(text.slice(at, first), make("mark", {}, text.slice(first, last)));
      at = last;
    }
    return [...parts, text.slice(at, to)];
  }

  function context(text, query) {
    const [first = 0] = places(text, query)[0] ?? [];
    let from = Math.max(first - AROUND, 0), to = Math.min(first + 2 * AROUND, text.length);
    if (from) from = text.indexOf(" ", from) + 1 || from;
    if (to < text.length) to = Math.max(text.lastIndexOf(" ", to), first + 1);
    return [from ? "… " : "", ...marked(text, query, from, to), to < text.length ? " …" : ""];
  }

  const field = make("input", { type: "search", autocomplete: "off", spellcheck: false, placeholder: words.searchHint });
  const list = make("div", { id: "found" });
  const said = make("p", { className: "said" });
  const close = make("button", { type: "button", textContent: words.close });
  const dialog = make("dialog", { className: "find" }, make("div", { className: "asked" }, field, close), said, list);
  dialog.setAttribute("aria-label", words.search);
  field.setAttribute("aria-label", words.searchHint);
  field.setAttribute("role", "combobox");
  field.setAttribute("aria-controls", "found");
  field.setAttribute("aria-autocomplete", "list");
  list.setAttribute("role", "listbox");
  list.setAttribute("aria-label", words.search);
  said.setAttribute("role", "status");
  document.body.append(dialog);

  let now = -1;
  const rows = () => [...list.children];
  function choose(index) {
    now = index;
    rows().forEach((row, i) => row.setAttribute("aria-selected", String(i === now)));
    if (rows()[now]) {
      field.setAttribute("aria-activedescendant", rows()[now].id);
      rows()[now].scrollIntoView({ block: "nearest" });
    } else field.removeAttribute("aria-activedescendant");
  }

  function show() {
    const query = field.value, found = find(query);
    list.replaceChildren(...found.slice(0, MAX_HITS).map(({ address, page, section, text }, index) => {
      const title = make("span", { className: "title" }, ...marked(section || page, query));
      if (section && section !== page) title.append(make("small", {}, " ", page));
      const row = make("a", { href: address, id: `found-${index}`, tabIndex: -1 }, title,
        make("span", { className: "around" }, ...context(text, query)));
      row.setAttribute("role", "option");
      row.addEventListener("click", () => dialog.close());
      return row;
    }));
    field.setAttribute("aria-expanded", String(found.length > 0));
    said.textContent = !query.trim() ? "" : found.length ? words.found.replace("{n}", found.length) : words.foundNone;
    choose(found.length ? 0 : -1);
  }

  field.addEventListener("input", show);
  field.addEventListener("keydown", (event) => {
    const count = list.children.length;
    if (event.key === "ArrowDown" && count) choose((now + 1) % count);
    else if (event.key === "ArrowUp" && count) choose((now - 1 + count) % count);
    else if (event.key === "Enter" && rows()[now]) rows()[now].click();
    else if (event.key === "Escape") dialog.close();  // a search field would clear itself first
    else return;
    event.preventDefault();
  });
  close.addEventListener("click", () => dialog.close());
  dialog.addEventListener("click", (event) => { if (event.target === dialog) dialog.close(); });
  field.setAttribute("aria-expanded", "false");
  return () => {
    if (!dialog.open) dialog.showModal();
    field.select();
    field.focus();
  };
})();
