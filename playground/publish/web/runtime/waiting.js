// waiting.js -- waits for other events, and for the graphics card, without holding the page up.

/** Wait until other events had their turn. @param {number} [milliseconds] */
const pause = (milliseconds) => new Promise((resume) => {
  if (milliseconds) {
    setTimeout(resume, milliseconds);
    return;
  }
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    port1.close();
    resume(undefined);
  };
  port2.postMessage(0);
});

/** Wait until everything drawn so far is done. @param {WebGL2RenderingContext} gl @returns {Promise<void>} */
export const finished = async (gl) => {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  if (!fence) return;
  for (let polls = 0; !gl.isContextLost(); polls++) {
    await pause(polls > 4 ? 2 : 0);
    if (gl.clientWaitSync(fence, 0, 0) !== gl.TIMEOUT_EXPIRED) break;
  }
  gl.deleteSync(fence);
};
