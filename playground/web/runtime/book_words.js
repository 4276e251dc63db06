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
    check: "Check",
    restart: "Begin again",
    allRight: "Right: all checks hold.",
    someRight: "{count} of {all} checks hold.",
    notCompiled: "This does not compile; see the lines above.",
    elsewhere: "Checks that no page can do: {count}. They are done in the window, in a notebook and when work is graded.",
    at: "At {at}: ",
    atHidden: "At other values, which are not shown: ",
    rightPicture: "the picture is right.",
    rightTexture: "{of} is right.",
    wrongPicture: "{share} % of the picture differs{bias}.",
    wrongTexture: "{of} differs by up to {by}, where {tolerance} is allowed{bias}.",
    morePicture: "; yours is brighter",
    lessPicture: "; yours is darker",
    moreTexture: "; yours is higher in the mean",
    lessTexture: "; yours is lower in the mean",
    otherSize: "{of} is {mine}, where {wanted} is asked for.",
    notFinite: "{of} has {count} texels without a number (NaN or infinity).",
    mistake: "this cannot be drawn: {mistake}",
    mine: "Yours",
    wanted: "Asked for",
    differs: "What differs",
    target: "To match",
    score: "Score",
    scored: "Score {now} of 100; solved from {goal}. Best so far: {best}.",
    solved: "Solved, with a score of {now}. Best so far: {best}.",
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
