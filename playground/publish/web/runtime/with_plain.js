// with_plain.js -- the add-on of pages with plain shaders, other tools' among them.

import { addOns } from "./addons.js";
import { createPlain } from "./plain.js";
import { usualOf } from "./usual.js";

addOns.plain = { createPlain, usualOf };
