// library_copies.js -- which files of the library come into a sketch's folder when one of them is edited.

/** @typedef {import("./schema.js").Pack} Pack */
/** @typedef {Pick<import("./schema.js").Shared, "includes">} Includes */

/** The files that come along with edited ones: what includes or uses them, and what those include by a name
 *  that leads elsewhere from the sketch's folder.
 *  @param {string[]} edited @param {Pack} pack @param {Includes} shared
 *  @returns {Set<string>} */
export function copiesOf(edited, pack, shared) {
  const found = new Set(edited), own = ownFiles(pack);
  for (const file of found) {
    for (const user of usersOf(file, pack, shared)) if (!own.has(user)) found.add(user);
    const includes = Object.entries(shared.includes[file] ?? {});
    for (const [name, target] of includes) if (name !== target && !own.has(target)) found.add(target);
  }
  return found;
}

/** Whether an edited file of the library reaches the sketch: what uses it is named in the sketch's files.
 *  @param {string} file @param {Pack} pack @param {Includes} shared
 *  @returns {boolean} */
export function isReached(file, pack, shared) {
  if (file.includes(":")) return false; // a part of another tool's file, as the playground rewrote it
  const own = ownFiles(pack), named = new Set(usesIn(pack.toml ?? [])), found = new Set([file]);
  for (const one of found) {
    if (own.has(one) || named.has(one)) return true;
    for (const user of usersOf(one, pack, shared)) found.add(user);
  }
  return false;
}

/** The files that include or use one.
 *  @param {string} file @param {Pack} pack @param {Includes} shared @returns {string[]} */
function usersOf(file, pack, shared) {
  const all = Object.entries(shared.includes);
  const including = all.filter(([, names]) => Object.values(names).includes(file));
  const using = Object.entries(pack.techniques).filter(([, pieces]) => usesIn(pieces).includes(file));
  return [...including, ...using].map(([user]) => user);
}

/** The files of the techniques that a TOML names.
 *  @param {import("./schema.js").Piece[]} pieces @returns {string[]} */
function usesIn(pieces) {
  return pieces.flatMap((piece) => (typeof piece !== "string" && "use" in piece ? [piece.of] : []));
}

/** @param {Pack} pack @returns {Set<string>} the page's names of files that are in the zip anyway */
function ownFiles(pack) {
  const all = Object.values(pack.files).filter(([kind]) => kind === "file" || kind === "pieces");
  return new Set(all.map(([, name]) => name));
}
