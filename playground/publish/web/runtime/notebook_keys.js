// notebook_keys.js -- keys that a figure takes, such as arrows on a slider, from the notebook.

/** Keep keys pressed in an element from the notebook around it, but those held with Ctrl, Alt or Meta, Enter
 *  with Shift, and Escape. @param {HTMLElement} host */
export function keepKeys(host) {
  host.addEventListener("keydown", (event) => {
    const { key, ctrlKey, altKey, metaKey, shiftKey } = event;
    if (!ctrlKey && !altKey && !metaKey && key !== "Escape" && !(shiftKey && key === "Enter"))
      event.stopPropagation();
  });
}
