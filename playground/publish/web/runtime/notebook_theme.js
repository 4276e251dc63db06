// notebook_theme.js -- a figure as light or dark as the notebook around it, whichever program shows that.
//
// Programs say their theme in different ways; what they have in common is that text can be read on it.

const JUPYTER = "data-jp-theme-light"; // the attribute by which JupyterLab says its theme
const MIDDLE = 128; // of 255: a text that is lighter stands on something dark

/** Whether a colour, as a browser computes it, is light. @param {string} colour */
function isLight(colour) {
  const [red = 0, green = 0, blue = 0] = (colour.match(/[\d.]+/g) ?? []).map(Number);
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > MIDDLE;
}

/** Follow the theme of what is around an element; returns what ends that. @param {HTMLElement} host */
export function followTheme(host) {
  const show = () => {
    const { parentElement } = host;
    if (parentElement) host.classList.toggle("dark", isLight(getComputedStyle(parentElement).color));
  };
  const changes = new MutationObserver(() => requestAnimationFrame(show));
  for (const of of [document.documentElement, document.body])
    changes.observe(of, { attributes: true, attributeFilter: ["class", "style", "theme", JUPYTER] });
  const scheme = matchMedia("(prefers-color-scheme: dark)");
  scheme.addEventListener("change", show);
  show();
  return () => {
    changes.disconnect();
    scheme.removeEventListener("change", show);
  };
}
