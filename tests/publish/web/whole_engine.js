// whole_engine.js -- the engine with every add-on, as tests of pictures use it.

import "../../../playground/publish/web/runtime/with_all.js";

export * from "../../../playground/publish/web/runtime/engine.js";
