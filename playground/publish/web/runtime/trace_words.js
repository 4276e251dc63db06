// trace_words.js -- what a page says beside the values of a texel.

/** @type {import("./words.js").Table} */
export const TRACE_WORDS = {
  en: {
    trace: "Trace",
    traceTool: "Trace a texel: click on the picture or a map",
    tracePoint: "Click on the picture, or on a map, to see the values of every line for that texel.",
    traceTitle: "{path}, texel {x}, {y}",
    traceExact: "The traced run gives this very texel, bit for bit.",
    traceInexact: "The traced run gives another texel in its last bits: this device computes some sums "
      + "otherwise where their parts are recorded.",
    traceCut: "It has more events than are shown.",
    traceCall: "Call",
    traceNth: "{name}, {number} of {count}",
    traceOf: "{number} of {count}",
    traceLoop: "Iteration of the loop in line {line}",
    traceIteration: "Iteration",
    traceBad: "First NaN or infinity",
    traceNotFinite: "NaN or infinity",
    traceEdited: "{file} was edited here, and an edited text has no trace: reset the file, or trace it in "
      + "the playground.",
    traceLost: "The graphics device gave up on the traced text of {file}: it is not tried again.",
    traceNone: "No trace: {reason}",
    keyTrace: "trace a texel by a click, or no longer",
  },
  fr: {
    trace: "Trace",
    traceTool: "Tracer un texel : cliquer sur l’image ou sur une carte",
    tracePoint: "Cliquez sur l’image ou sur une carte pour voir les valeurs de chaque ligne pour ce texel.",
    traceTitle: "{path}, texel {x}, {y}",
    traceExact: "L’exécution tracée donne exactement ce texel, bit pour bit.",
    traceInexact: "L’exécution tracée donne un texel dont les derniers bits diffèrent : cet appareil calcule "
      + "certaines sommes autrement quand leurs parties sont enregistrées.",
    traceCut: "Il y a plus d’événements que ceux qui sont montrés.",
    traceCall: "Appel",
    traceNth: "{name}, {number} sur {count}",
    traceOf: "{number} sur {count}",
    traceLoop: "Itération de la boucle de la ligne {line}",
    traceIteration: "Itération",
    traceBad: "Premier NaN ou infini",
    traceNotFinite: "NaN ou infini",
    traceEdited: "{file} a été modifié ici, et un texte modifié n’a pas de trace : rétablissez le fichier, "
      + "ou tracez-le dans le playground.",
    traceLost: "Le processeur graphique a abandonné le texte tracé de {file} : il n’est plus essayé.",
    traceNone: "Pas de trace : {reason}",
    keyTrace: "tracer un texel par un clic, ou ne plus le faire",
  },
};
