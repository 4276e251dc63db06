// book_words.js -- what live figures of a book say besides the words of every page, in each language.

import "./with_french.js";
import { wordsOf } from "./words.js";

/** @type {Object<string, string>} */
const ENGLISH = {
  reset: "Reset",
  iteration: "Iteration {now} of {all}",
  iterations: "Iterations",
  backward: "One step back",
  forward: "One step on",
  swipe: "Swipe from one picture to the other",
  lines: "The lines with the bug",
  keys: "Tab inserts spaces; press Esc, then Tab, to leave the field.",
  restore: "The lines as they were",
  compiling: "Compiling",
  wrong: "This does not compile; the picture is the last that did.",
  place: "Line {line}: {message}",
  fixed: "Fixed: this is the correct picture again.",
  notYet: "Not the correct picture yet.",
  reached: "This is the picture of the solution.",
  notReached: "Not the picture of the solution yet.",
  noWebGL: "This browser offers no WebGL2, so the picture stands still.",
  lacks: "This device cannot run the figure, so the picture stands still: {reason}",
  missing: "A file of the book is missing: {reason}",
};

/** @type {Object<string, string>} */
const FRENCH = {
  reset: "Rétablir",
  iteration: "Itération {now} sur {all}",
  iterations: "Itérations",
  backward: "Une étape en arrière",
  forward: "Une étape en avant",
  swipe: "Balayer d’une image à l’autre",
  lines: "Les lignes avec l’erreur",
  keys: "Tab insère des espaces ; Échap puis Tab quitte le champ.",
  restore: "Les lignes comme elles étaient",
  compiling: "Compilation",
  wrong: "Cela ne se compile pas ; l’image est la dernière qui l’a fait.",
  place: "Ligne {line} : {message}",
  fixed: "Corrigé : c’est de nouveau la bonne image.",
  notYet: "Ce n’est pas encore la bonne image.",
  reached: "C’est l’image de la solution.",
  notReached: "Ce n’est pas encore l’image de la solution.",
  noWebGL: "Ce navigateur n’offre pas WebGL2 : l’image reste fixe.",
  lacks: "Cet appareil ne peut pas faire tourner la figure, l’image reste fixe : {reason}",
  missing: "Un fichier du livre manque : {reason}",
  noFloat: "Cet appareil ne peut pas dessiner dans des textures à virgule flottante : l’image reste fixe.",
  lost: "Le processeur graphique s’est interrompu ; l’image sera refaite dès qu’il sera revenu.",
  lostByEdit: "Le processeur graphique a abandonné pendant l’essai de {name} : le dernier texte qui "
    + "marchait est repris. Votre texte est dans le champ ; cherchez une boucle sans fin.",
  gone: "Le processeur graphique s’est interrompu {count} fois : l’image reste fixe. "
    + "Rechargez la page pour réessayer.",
  notBack: "Le processeur graphique s’est interrompu et n’est pas revenu : rechargez la page. Les textes qui "
    + "marchaient sont gardés.",
  hung: "Le texte de {name} était à l’essai quand la page a été fermée : il contient peut-être une "
    + "boucle sans fin. Le dernier texte qui marchait est repris.",
  tryAgain: "Ouvrir le texte à l’essai",
  forget: "L’oublier",
};

/** The words of a page's figures. @param {string} language */
export const bookWords = (language) =>
  ({ ...wordsOf(language), ...(/^fr\b/i.test(language) ? FRENCH : ENGLISH) });
