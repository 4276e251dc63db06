// with_editing.js -- the add-on of pages whose texts may be edited, or come from other tools.

import { addOns } from "./addons.js";
import { withConversions } from "./conversions.js";
import { withoutDesktopForms } from "./desktop_glsl.js";
import * as edits from "./edits.js";

addOns.edits = edits;
addOns.fromDesktop = (text) => withConversions(withoutDesktopForms(text));
