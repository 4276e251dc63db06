// notebook_words.js -- what a widget of sketches says besides the words of a book's figures.

import { bookWords } from "./book_words.js";
import { wordsOf } from "./words.js";

/** @type {import("./words.js").Table} */
export const NOTEBOOK_WORDS = {
  en: {
    allParameters: "All parameters",
    byBrowser: "Drawn by this browser.",
    byKernel: "Drawn by the kernel: {reason}.",
    dragHere: "Drag to orbit; wheel after a click to zoom.",
  },
  fr: {
    allParameters: "Tous les paramètres",
    byBrowser: "Dessiné par ce navigateur.",
    byKernel: "Dessiné par le noyau : {reason}.",
    dragHere: "Glisser pour tourner ; molette après un clic pour zoomer.",
  },
};

/** All words of a widget. @param {string} language */
export const notebookWords = (language) => ({ ...bookWords(language), ...wordsOf(language, NOTEBOOK_WORDS) });
