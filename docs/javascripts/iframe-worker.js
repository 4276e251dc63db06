// The search runs in a worker, and browsers start none for a page that was opened from a folder.
// There, and only there, the worker's script runs in a hidden frame. The search's own script
// knows a page's IFrameWorker by that name, and then awaits importScripts.
if (location.protocol === "file:") {
  const load = (frame, url) =>
    new Promise((loaded, failed) => {
      const script = frame.contentDocument.createElement("script");
      script.onload = loaded;
      script.onerror = failed;
      script.src = url;
      frame.contentDocument.body.append(script);
    });

  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      const inner = frame.contentWindow;
      inner.importScripts = async (...urls) => {
        for (const each of urls) await load(frame, each);
      };
      inner.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      this.frame = frame;
      this.ready = load(frame, new URL(url, location.href).href);
    }

    postMessage(data) {
      const pass = () =>
        this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
      this.ready.then(pass);
    }

    terminate() {
      this.frame.remove();
    }
  };
  window.Worker = window.IFrameWorker;
}
