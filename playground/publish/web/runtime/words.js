// words.js -- every word of the interface comes from here: tables by language, one for each part of it.
//
// A page takes the tables of the parts that it has. No two tables share a name, so that they can be one.

/** @typedef {Object<string, string>} Words */
/** @typedef {{en: Words, fr: Words}} Table */

/** The words of some tables in a language, by its tag; in English where there are none in it.
 *  @param {string} language @param {...Table} tables @returns {Words} */
export const wordsOf = (language, ...tables) =>
  Object.assign({}, ...tables.map((table) => (/^fr\b/i.test(language) ? table.fr : table.en)));

/** Put values in the places of a text: fill("{time} s", {time: 2}).
 *  @param {string} text @param {Object<string, string | number>} values */
export const fill = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? ""));

/** A number of metres, or another number that is read, in as many digits as it needs.
 *  @param {number} number */
export const measured = (number) =>
  Math.abs(number) >= 1000
    ? number.toFixed(0)
    : Math.abs(number) >= 10
      ? number.toFixed(1)
      : number.toFixed(2);
