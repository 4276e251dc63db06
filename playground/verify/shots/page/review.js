// review.js -- accept pictures, and undo it, through the server that gave this page.
//
// What the server holds counts: each page asks it every two seconds, so that several tabs
// agree. A request names the result it means by its stamp; where the tests have run again
// since, the server refuses and this page says so.
"use strict";

const EVERY = 2000; // [ms]
let ended = false; // whether this page reported that it is done
let states = {}; // name → {stamp, state, message}, as the server last gave them

async function ask(path, body) {
  const options = body && {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Shots-Token": location.pathname.split("/")[1] },
    body: JSON.stringify(body),
  };
  const answer = await fetch(path, { cache: "no-store", ...options });
  const text = await answer.text();
  if (!answer.ok) throw new Error(text.trim() || `the server answered ${answer.status}`);
  return JSON.parse(text);
}

function banner(text) {
  byId("banner").textContent = text;
  byId("banner").hidden = !text;
}

const ACCEPTED = { accepted: "accepted", further: "accepted as further" };

function paint() {
  for (const article of articles) {
    const { name, stamp } = article.dataset;
    const found = states[name];
    const now = !found || found.stamp !== stamp ? "outdated" : found.state;
    const row = rows.get(name);
    article.dataset.state = row.dataset.state = now;
    row.querySelector(".state")?.remove();
    const text = now === "outdated" ? "run again" : ACCEPTED[now];
    if (text) row.querySelector("a").append(make("span", { className: "state", textContent: text }));
    for (const button of article.querySelectorAll("[data-do]")) {
      button.disabled = now === "outdated" || (button.dataset.do === "undo") !== (now in ACCEPTED);
    }
    const message = article.querySelector(".message");
    if (!message) continue;
    if (now === "outdated") message.textContent = "The tests have run again since this page was loaded: load it again.";
    else if (found.message !== message.dataset.from) message.textContent = found.message;
    message.dataset.from = found?.message ?? "";
  }
  if (!byId("accept-shown")) return;
  byId("accept-shown").disabled = !toAccept().length;
  byId("undo-shown").disabled = !toUndo().length;
}

const toAccept = () =>
  shownArticles().filter((a) => a.dataset.state === "open" && a.querySelector('[data-do="accept"]'));
const toUndo = () => shownArticles().filter((a) => a.dataset.state in ACCEPTED);

/** Nothing can be accepted any more: say why. */
function close(text) {
  banner(text);
  for (const button of document.querySelectorAll("[data-do], #accept-shown, #undo-shown, #done"))
    button.disabled = true;
}

async function refresh() {
  if (document.hidden || ended) return;
  try {
    states = await ask("state");
    banner("");
    paint();
  } catch {
    if (!ended) close("The server of this page has ended. Start playground shots review again to accept anything.");
  }
}

async function act(action, some) {
  const shots = some.map((article) => ({ name: article.dataset.name, stamp: article.dataset.stamp }));
  if (some.length > 1) banner(`Working on ${some.length} pictures …`);
  try {
    const results = await ask("act", { action, shots });
    const refused = results.filter((result) => !result.ok);
    for (const { name, ok, message } of results) {
      const place = articles.find((article) => article.dataset.name === name).querySelector(".message");
      place.textContent = message;
      place.classList.toggle("refused", !ok);
    }
    if (some.length > 1 && refused.length)
      showDialog("Some were refused", "Nothing has changed for these:", refused.map((r) => `${r.name}: ${r.message}`));
  } catch (error) {
    banner(error.message);
    return;
  }
  await refresh();
}

// Asking first

function showDialog(title, text, lines, action, label) {
  byId("ask-title").textContent = title;
  byId("ask-text").textContent = text;
  byId("ask-list").replaceChildren(...lines.map((line) => make("li", { textContent: line })));
  byId("ask-also").closest("p").hidden = true;
  byId("ask-yes").hidden = !action;
  byId("ask-yes").textContent = label ?? "";
  byId("ask-no").textContent = action ? "Cancel" : "Close";
  byId("ask-yes").onclick = () => {
    byId("ask").close();
    action();
  };
  byId("ask").showModal();
}

byId("ask-no").addEventListener("click", () => byId("ask").close());

const many = (some) => `${some.length} picture${some.length === 1 ? "" : "s"}`;
const namesOf = (some) => some.map((article) => article.dataset.name);

byId("accept-shown")?.addEventListener("click", () => {
  const some = toAccept();
  const text =
    "Each takes the place of its reference, and of the further ones accepted for it. It can be undone, one by one or all.";
  const accept = () => act(byId("ask-also").checked ? "also" : "accept", some);
  showDialog(`Accept ${many(some)}?`, text, namesOf(some), accept, `Accept ${many(some)}`);
  byId("ask-also").checked = false;
  byId("ask-also").closest("p").hidden = false;
});

byId("undo-shown")?.addEventListener("click", () => {
  const some = toUndo();
  const text = "Their references are put back as they were.";
  showDialog(`Undo ${many(some)}?`, text, namesOf(some), () => act("undo", some), `Undo ${many(some)}`);
});

byId("done").addEventListener("click", async () => {
  ended = true;
  try {
    await ask("done", {});
  } catch {
    // it has ended already
  }
  clearInterval(asking);
  close("Done: the server has ended, and this page can be closed.");
});

for (const article of articles) {
  for (const button of article.querySelectorAll("[data-do]")) {
    button.addEventListener("click", () => act(button.dataset.do, [article]));
  }
}

function press(action) {
  const button = current?.querySelector(`[data-do="${action}"]`);
  if (button && !button.disabled) button.click();
}
keys.y = () => press("accept");
keys.u = () => press("undo");

listeners.push(() => paint());
document.addEventListener("visibilitychange", refresh);
const asking = setInterval(refresh, EVERY);
refresh();
