// with_keyframes.js -- the add-on of pages with a sketch that has keyframes.

import { addOns } from "./addons.js";
import { valueAt } from "./keyframes.js";

addOns.keyframes = { valueAt };
