// Unpacks the runtime and runs it: the page's policy names the hashes of its style and its script.
(async () => {
  for (const name of ["style", "runtime"]) {
    const packed = document.getElementById(`playground-${name}`).textContent;
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const element = document.createElement(name === "style" ? "style" : "script");
    element.textContent = await new Response(stream).text();
    document.head.append(element);
  }
})().catch(() => {
  document.getElementById("playground-old").hidden = false;
});
