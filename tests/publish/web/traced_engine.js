// traced_engine.js -- the runtime's engine, and what traces a texel in it.

export { createEngine } from "../../../playground/publish/web/runtime/engine.js";
export { traced } from "../../../playground/publish/web/runtime/trace_run.js";
