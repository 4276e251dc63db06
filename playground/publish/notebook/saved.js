// Makes the saved figures of a page live as they come into view, each in the place of its picture.
//
// A figure names its runtime by a hash. One element of the page holds that (gzip in base64), in this figure
// or in another; it is unpacked once.
(() => {
  const runtimes = (globalThis.terrainRuntimes ??= {});
  const unpacked = async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return JSON.parse(await new Response(stream).text());
  };
  const opened = async (key) => {
    const { esm, css } = await unpacked(document.querySelector(`[data-terrain-runtime="${key}"]`).textContent);
    const style = document.createElement("style");
    style.textContent = css;
    document.head.append(style);
    const url = URL.createObjectURL(new Blob([esm], { type: "text/javascript" }));
    try {
      return await import(url);
    } finally {
      URL.revokeObjectURL(url);
    }
  };
  const start = async (root) => {
    const place = root.firstElementChild, key = root.dataset.terrainSaved;
    try {
      const { revive } = await (runtimes[key] ??= opened(key));
      await revive(place, await unpacked(root.querySelector("[data-terrain-state]").textContent));
    } catch (error) {
      const sentence = document.createElement("p");
      sentence.textContent = root.dataset.still.replace("{reason}", () => error.message);
      place.append(sentence);
    }
  };
  const seen = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      start(target);
    }
  }, { rootMargin: "50%" });
  for (const root of document.querySelectorAll("[data-terrain-saved]:not([data-watched])")) {
    root.dataset.watched = "";
    seen.observe(root);
  }
})();
