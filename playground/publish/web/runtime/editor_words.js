// editor_words.js -- what the editor says, and what is said when a picture fails.

/** @type {import("./words.js").Table} */
export const EDITOR_WORDS = {
  en: {
    // the editor
    file: "File",
    ownFiles: "Of this sketch",
    kernelFiles: "Passes",
    libraryFiles: "Included files",
    edited: "{name} (edited)",
    broken: "{name} (with an error)",
    field: "Text of {name}",
    fieldKeys: "Tab inserts spaces; press Esc, then Tab, to leave the field. Ctrl+/ makes lines comments.",
    resetFile: "Reset this file",
    copyFile: "Copy",
    saveFile: "Download",
    fileCopied: "The text of {name} is copied",
    fileNotCopied: "This browser lets no page copy: select the text, and copy it by hand",
    fileSaved: "{name} is saved",
    unedited: "As in the sketch. What you type is compiled at once.",
    compilingText: "Compiling",
    compiled: "Compiled and drawn in {time} ms",
    unused: "Compiled: no pass of the picture uses it",
    problem: "1 error: the picture is the last that worked",
    problems: "{count} errors: the picture is the last that worked",
    filePlace: "{file}:{line}: {message}",
    placeless: "{file}: {message}",
    // what an edit does not do in a page
    header: "What a #pragma says is read by Python: changed, it has no effect in this page, but it has in "
      + "the file that you save.",
    annotation: "What a //! says is read by Python: changed, it has no effect in this page, but it has in "
      + "the file that you save.",
    initial: "{names}: the control holds the value; the new initial value is in the file that you save.",
    added: "{names}: has its initial value and no control in this page; the playground has one.",
    removed: "{names}: the control has no effect any more.",
    // when there is no picture
    noWebGL: "This browser offers no WebGL2, so the picture stands still. Update the browser, or allow "
      + "hardware acceleration in its settings.",
    noFloat: "This device cannot draw into floating-point textures, which the picture needs, so the picture "
      + "stands still.",
    lacks: "This device cannot make the picture, so it stands still: {reason}",
    lost: "The graphics device was lost; the picture is made again as soon as it is back.",
    lostByEdit: "The graphics device gave up while {name} was tried: the last text that worked is back. "
      + "Your text is in the editor; look for a loop that does not end.",
    gone: "The graphics device was lost {count} times, so the picture stands still now. Reload the page to "
      + "try again.",
    notBack: "The graphics device was lost and has not come back: reload the page. Texts that worked are "
      + "kept.",
    slow: "At {size} this takes about {time} s a picture, and the browser may stop it.",
    smaller: "Draw it at {size}",
    anyway: "Draw it all the same",
    hung: "The text of {name} was being tried when this page was closed: it may loop without end. The last "
      + "text that worked is shown.",
    tryAgain: "Open the text that was tried",
    forget: "Forget it",
  },
  fr: {
    file: "Fichier",
    ownFiles: "De cette esquisse",
    kernelFiles: "Passes",
    libraryFiles: "Fichiers inclus",
    edited: "{name} (modifié)",
    broken: "{name} (avec une erreur)",
    field: "Texte de {name}",
    fieldKeys: "Tab insère des espaces ; Échap puis Tab quitte le champ. Ctrl+/ met des lignes en "
      + "commentaire.",
    resetFile: "Rétablir ce fichier",
    copyFile: "Copier",
    saveFile: "Télécharger",
    fileCopied: "Le texte de {name} est copié",
    fileNotCopied: "Ce navigateur ne laisse aucune page copier : sélectionnez le texte, et copiez-le à la "
      + "main",
    fileSaved: "{name} est enregistré",
    unedited: "Comme dans l’esquisse. Ce que vous tapez est compilé aussitôt.",
    compilingText: "Compilation",
    compiled: "Compilé et dessiné en {time} ms",
    unused: "Compilé : aucune passe de l’image ne s’en sert",
    problem: "1 erreur : l’image est la dernière qui marchait",
    problems: "{count} erreurs : l’image est la dernière qui marchait",
    filePlace: "{file}:{line} : {message}",
    placeless: "{file} : {message}",
    header: "Ce que dit un #pragma est lu par Python : changé, il reste sans effet dans cette page, mais il "
      + "en a dans le fichier que vous enregistrez.",
    annotation: "Ce que dit un //! est lu par Python : changé, il reste sans effet dans cette page, mais il "
      + "en a dans le fichier que vous enregistrez.",
    initial: "{names} : la valeur est celle du réglage ; la nouvelle valeur initiale est dans le fichier "
      + "que vous enregistrez.",
    added: "{names} : a sa valeur initiale et pas de réglage dans cette page ; le playground en a un.",
    removed: "{names} : le réglage n’a plus d’effet.",
    noWebGL: "Ce navigateur n’offre pas WebGL2 : l’image reste fixe. Mettez-le à jour, ou permettez "
      + "l’accélération matérielle dans ses réglages.",
    noFloat: "Cet appareil ne peut pas dessiner dans des textures à virgule flottante, qu’il faut pour "
      + "l’image : l’image reste fixe.",
    lacks: "Cet appareil ne peut pas faire l’image, qui reste fixe : {reason}",
    lost: "Le processeur graphique s’est interrompu ; l’image sera refaite dès qu’il sera revenu.",
    lostByEdit: "Le processeur graphique a abandonné pendant l’essai de {name} : le dernier texte qui "
      + "marchait est repris. Votre texte est dans l’éditeur ; cherchez une boucle sans fin.",
    gone: "Le processeur graphique s’est interrompu {count} fois : l’image reste fixe. Rechargez la page "
      + "pour réessayer.",
    notBack: "Le processeur graphique s’est interrompu et n’est pas revenu : rechargez la page. Les textes "
      + "qui marchaient sont gardés.",
    slow: "En {size}, une image demande environ {time} s, et le navigateur peut l’interrompre.",
    smaller: "Dessiner en {size}",
    anyway: "Dessiner quand même",
    hung: "Le texte de {name} était à l’essai quand la page a été fermée : il contient peut-être une boucle "
      + "sans fin. Le dernier texte qui marchait est repris.",
    tryAgain: "Ouvrir le texte à l’essai",
    forget: "L’oublier",
  },
};

/** What CodeMirror says in its own way: its English, and what stands for that.
 *  @type {import("./words.js").Table} */
export const SEARCH_PHRASES = {
  en: {},
  fr: {
    Find: "Chercher", Replace: "Remplacer par", next: "suivant", previous: "précédent", all: "tous",
    "match case": "casse", regexp: "expression régulière", "by word": "mot entier", replace: "remplacer",
    "replace all": "tout remplacer", close: "fermer", "current match": "occurrence", "on line": "à la ligne",
    "replaced match on line $": "remplacé à la ligne $", "replaced $ matches": "$ occurrences remplacées",
    "Go to line": "Aller à la ligne", go: "aller", Diagnostics: "Erreurs", "No diagnostics": "Aucune erreur",
  },
};
