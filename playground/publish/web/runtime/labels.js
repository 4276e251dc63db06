// labels.js -- how parameters are named, sorted and found in a panel, as studio/panel/parameter_list.py does.

/** @import { Shown } from "./schema.js" */

/** A name as a panel writes it: rock_from as "Rock from"; one in mixed case as it is.
 *  @param {string} name */
export const labelOf = (name) =>
  name === name.toLowerCase() ? name.charAt(0).toUpperCase() + name.slice(1).replaceAll("_", " ") : name;

/** @param {string} heading @param {string} title */
const under = (heading, title) => `${heading}: ${title.charAt(0).toLowerCase()}${title.slice(1)}`;

/** What a sketch is about, in its own order.
 *  @param {Shown[]} rows */
export const mainRows = (rows) => rows.filter((row) => row.main).sort((a, b) => a.main - b.main);

/** Labels of main parameters, by path: group or pass named where a label alone would not say what is meant.
 *  @param {Shown[]} rows @returns {Map<string, string>} */
export function mainLabels(rows) {
  const titles = rows.map(({ label, group, path }) => {
    const own = label !== labelOf(path.slice(path.lastIndexOf(".") + 1));
    return own && group && !(group + label).includes(" ") && label !== group ? under(group, label) : label;
  });
  return new Map(rows.map((row, at) => {
    const twice = titles.filter((title) => title === titles[at]).length > 1;
    return [row.path, twice ? under(labelOf(row.pass), titles[at]) : titles[at]];
  }));
}

/** Sort a list by a key of its items, in the order of the first of each.
 *  @template Item @param {Item[]} items @param {(item: Item) => string} key @returns {Map<string, Item[]>} */
export function grouped(items, key) {
  /** @type {Map<string, Item[]>} */
  const found = new Map();
  for (const item of items) found.set(key(item), [...(found.get(key(item)) ?? []), item]);
  return found;
}

/** Whether every word is found in a row's label, path, group or description.
 *  @param {Shown} row @param {string} label as it is shown @param {string[]} words in lower case */
export function isLike(row, label, words) {
  const { path, group, description } = row;
  const text = [row.label, label, path, path.replaceAll("_", " "), group, description].join(" ");
  return words.every((word) => text.toLowerCase().includes(word));
}
