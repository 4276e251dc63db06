// with_french.js -- the add-on of pages in French.

import { addOns } from "./addons.js";
import { FRENCH } from "./french_words.js";

addOns.french = FRENCH;
