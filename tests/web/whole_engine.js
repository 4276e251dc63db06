// whole_engine.js -- the engine with every add-on, as tests of pictures use it.

import "../../playground/web/runtime/with_all.js";

export * from "../../playground/web/runtime/engine.js";
