// book_words.js -- what live figures of a book say besides the words of every page.

import { EDITOR_WORDS } from "./editor_words.js";
import { PAGE_WORDS } from "./page_words.js";
import { wordsOf } from "./words.js";

/** @type {import("./words.js").Table} */
export const BOOK_WORDS = {
  en: {
    iteration: "Iteration {now} of {all}",
    backward: "One step back",
    forward: "One step on",
    swipe: "Swipe from one picture to the other",
    lines: "The lines with the bug",
    lineKeys: "Tab inserts spaces; press Esc, then Tab, to leave the field.",
    restore: "The lines as they were",
    wrong: "This does not compile; the picture is the last that did.",
    linePlace: "Line {line}: {message}",
    fixed: "Fixed: this is the correct picture again.",
    notYet: "Not the correct picture yet.",
    reached: "This is the picture of the solution.",
    notReached: "Not the picture of the solution yet.",
    missing: "A file of the book is missing: {reason}",
  },
  fr: {
    iteration: "Itération {now} sur {all}",
    backward: "Une étape en arrière",
    forward: "Une étape en avant",
    swipe: "Balayer d’une image à l’autre",
    lines: "Les lignes avec l’erreur",
    lineKeys: "Tab insère des espaces ; Échap puis Tab quitte le champ.",
    restore: "Les lignes comme elles étaient",
    wrong: "Cela ne se compile pas ; l’image est la dernière qui l’a fait.",
    linePlace: "Ligne {line} : {message}",
    fixed: "Corrigé : c’est de nouveau la bonne image.",
    notYet: "Ce n’est pas encore la bonne image.",
    reached: "C’est l’image de la solution.",
    notReached: "Ce n’est pas encore l’image de la solution.",
    missing: "Un fichier du livre manque : {reason}",
  },
};

/** The words of figures in a text. @param {string} language */
export const bookWords = (language) => wordsOf(language, PAGE_WORDS, EDITOR_WORDS, BOOK_WORDS);
