// work_words.js -- what is said of a work that was checked, as playground/course/tasks.py does.
//
// The words are those of [tasks] in course/labels, which a book's scripts hold.

import { general } from "./numbers.js";
import { fill } from "./words.js";

/** @typedef {import("./work_check.js").Outcome} Outcome */
/** @typedef {import("./work_check.js").PageCheck} PageCheck */

const NARROW = "\u202f"; // the space before a sign of percent

/** A number in a language. @param {string} text @param {boolean} comma */
const local = (text, comma) => (comma ? text.replace(".", ",") : text);

/** A share in percent, to two digits, never as a power of ten. @param {number} share */
function percent(share) {
  const value = 100 * share, rounded = Number(value.toExponential(1));
  const power = rounded ? Math.floor(Math.log10(Math.abs(rounded))) : 0;
  return `${rounded.toFixed(Number.isInteger(value) ? 0 : Math.max(1 - power, 0))}${NARROW}%`;
}

/** @param {number[]} size  width, height, channels of a texture @param {Object<string, string>} say */
function sized([width, height, channels], say) {
  return fill(say.channels, { width, height, channels });
}

/** What comes of one check, as a sentence. @param {Outcome} found @param {PageCheck} check
 *  @param {Object<string, string>} say  of [tasks] in course/labels @param {boolean} comma */
export function sentence(found, check, say, comma) {
  const at = check.said.map(([path, value]) => `${path} = ${local(value, comma)}`).join(", ");
  const where = check.hidden ? say.hidden : at ? fill(say.at, { at }) : "";
  const what = whatOf(found, check, say, comma);
  const isName = check.of && what.startsWith(check.of.name);
  return where || isName ? where + what : what[0].toUpperCase() + what.slice(1);
}

/** @param {Outcome} found @param {PageCheck} check @param {Object<string, string>} say
 *  @param {boolean} comma */
function whatOf(found, check, say, comma) {
  const kind = check.of ? "texture" : "picture", of = check.of?.name ?? "";
  if (found.mistake) return fill(say.mistake, { mistake: found.mistake.replace(/\.+$/, "") });
  if (found.passed) return fill(say[`right_${kind}`], { of });
  if (found.sizes) {
    const [mine, wanted] = found.sizes.map((size) => sized(size, say));
    return fill(say.size, { of, mine, wanted });
  }
  if (found.notFinite) {
    const key = found.notFinite > 1 ? "not_finite" : "not_finite_one";
    return fill(say[key], { of, count: found.notFinite });
  }
  const place = found.place ? say[`${check.of ? "map" : "place"}_${found.place}`] : "";
  const bias = found.bias ? say[`bias_${kind}_${found.bias > 0 ? "more" : "less"}`] : "";
  const [by, tolerance] = [found.difference, check.tolerance].map((value) => local(general(value, 3), comma));
  const share = local(percent(found.difference), comma);
  return fill(say[`wrong_${kind}`], { of, share, by, tolerance, place, bias });
}
