// page_room.js -- the room of a page: the whole screen or the window, with the panel or alone, light or dark.

const KEY = "playground-theme";

/** Fill the screen with an element, or no longer. Where a browser fills it with films only, as on some
 *  phones, the element fills the window.
 *  @param {HTMLElement} main @param {(full: boolean) => void} changed */
export function createFullScreen(main, changed) {
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
export function switchTheme() {
  const { dataset } = document.documentElement;
  const usual = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  dataset.theme = (dataset.theme || usual) === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(KEY, dataset.theme);
  } catch { /* it is not remembered */ }
}

/** As it was switched before. */
export function recallTheme() {
  try {
    const known = localStorage.getItem(KEY);
    if (known === "light" || known === "dark") document.documentElement.dataset.theme = known;
  } catch { /* none is remembered */ }
}
