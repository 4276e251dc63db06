// with_all.js -- every add-on, for bundles that cannot know what their sketches will need.

import "./with_editing.js";
import "./with_keyframes.js";
import "./with_plain.js";


