// tabs.js -- tabs over elements of which one is shown.

import { make } from "./dom.js";

/** Make the tabs; each element has an id. @param {[string, HTMLElement][]} pages
 *  @param {(chosen: number) => void} changed */
export function createTabs(pages, changed) {
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
