// book_words.js -- what live figures of a book say besides the words of every page.

import { EDITOR_WORDS } from "./editor_words.js";
import { PAGE_WORDS } from "./page_words.js";
import { wordsOf } from "./words.js";

/** @type {import("./words.js").Table} */
export const BOOK_WORDS = {
  en: {
    iteration: "Iteration {now} of {all}",
    backward: "One step back",
    forward: "One step forward",
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
    elsewhere: "Checks that no page can do: {count}. "
      + "They are done in the window, in a notebook and when work is graded.",
    mine: "Yours",
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
    check: "Vérifier",
    restart: "Recommencer",
    allRight: "Juste : tout est comme demandé.",
    someRight: "{count} vérifications sur {all} sont justes.",
    notCompiled: "Cela ne se compile pas ; voyez les lignes ci-dessus.",
    elsewhere: "Vérifications qu’aucune page ne peut faire : {count}. "
      + "Elles se font dans la fenêtre, dans un carnet et à la correction.",
    mine: "La vôtre",
    target: "À retrouver",
    score: "Score",
    scored: "Score {now} sur 100 ; réussi à partir de {goal}. Le meilleur : {best}.",
    solved: "Réussi, avec un score de {now}. Le meilleur : {best}.",
  },
};

/** The words of figures in a text. @param {string} language */
export const bookWords = (language) => wordsOf(language, PAGE_WORDS, EDITOR_WORDS, BOOK_WORDS);
