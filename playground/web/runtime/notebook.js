// notebook.js -- the entry of a notebook's widget: a live figure, or pictures that the kernel draws.
//
// Traits: those of notebook_live.js; `live` says to the kernel that nobody waits for its pictures. Without
// widgets, as in HTML that was made of a notebook, `revive` makes a saved figure live.

import "./with_all.js";
import { renderLive } from "./notebook_live.js";
import { renderPicture } from "./notebook_picture.js";

export { revive } from "./notebook_saved.js";

/** @param {{model: import("./notebook_live.js").Model, el: HTMLElement}} cell */
async function render(cell) {
  const { model, el } = cell, bytes = model.get("picture");
  const url = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
  if (model.get("page")) {
    try {
      const close = await renderLive(cell, url);
      model.set("live", true);
      model.save_changes();
      return () => {
        close();
        URL.revokeObjectURL(url);
      };
    } catch {
      el.replaceChildren(); // no WebGL2, or too little of it: the kernel draws
    }
  }
  URL.revokeObjectURL(url);
  return renderPicture(cell);
}

export default { render };
