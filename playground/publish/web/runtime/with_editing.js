// with_editing.js -- the add-on of pages whose texts may be edited.

import { addOns } from "./addons.js";
import * as edits from "./edits.js";

addOns.edits = edits;
