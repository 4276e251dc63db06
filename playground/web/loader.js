// Unpacks the runtime and runs it: the page's policy names the hash of its text.
(async () => {
  const packed = document.getElementById("playground-runtime").textContent;
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const script = document.createElement("script");
  script.textContent = await new Response(stream).text();
  document.body.append(script);
})().catch(() => {
  document.getElementById("playground-old").hidden = false;
});
