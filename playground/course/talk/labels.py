"""The words around beats, in each language."""

from __future__ import annotations

from collections.abc import Mapping

_ENGLISH = {
    "lesson": "Lesson",
    "question": "Question",
    "choices": "Choose",
    "answer": "Answer",
    "broken": "A bug to find",
    "hint": "Hint",
    "fix": "Fixed",
    "exercise": "Exercise {}",
    "challenge": "Match this picture",
    "step": "Step {} of {}",
    "part": "{} of {}",
    "measured": "Measured",
    "solution": "Solution",
    "notes": "Notes",
    "next": "Next",
    "back": "Back",
    "following": "Next",
    "over": "End of the lesson",
    "pause": "Pause",
    "go_on": "Go on",
    "reset": "Reset",
    "black": "Black screen",
    "lost": "The window does not answer: is the presentation closed?",
    "present": "Present",
    "present_note": "In front of a class: full screen, large type (F5)",
    "no_notes": "without notes: {}",
    "notes_at": "notes: {}",
    "no_beat": "there is no beat {}: 1 to {}",
    "prepares": "measuring this lesson's numbers…",
    "pen_on": "pen: draw with the mouse; E erases, D puts it down",
    "laser_on": "spot: P puts it out",
}
_FRENCH = {
    "lesson": "Leçon",
    "question": "Question",
    "choices": "Choisissez",
    "answer": "Réponse",
    "broken": "Un bogue à trouver",
    "hint": "Indice",
    "fix": "Corrigé",
    "exercise": "Exercice {}",
    "challenge": "Retrouvez cette image",
    "step": "Étape {} sur {}",
    "part": "{} sur {}",
    "measured": "Mesuré",
    "solution": "Solution",
    "notes": "Notes",
    "next": "Suivant",
    "back": "Précédent",
    "following": "Ensuite",
    "over": "Fin de la leçon",
    "pause": "Pause",
    "go_on": "Reprendre",
    "reset": "Remettre à zéro",
    "black": "Écran noir",
    "lost": "La fenêtre ne répond pas\u00a0: la présentation est-elle fermée\u00a0?",
    "present": "Présenter",
    "present_note": "Devant une classe\u00a0: plein écran, grands caractères (F5)",
    "no_notes": "sans notes\u00a0: {}",
    "notes_at": "notes\u00a0: {}",
    "no_beat": "il n’y a pas de temps {}\u00a0: de 1 à {}",
    "prepares": "mesure des nombres de la leçon…",
    "pen_on": "crayon\u00a0: dessinez à la souris\u00a0; E efface, D le repose",
    "laser_on": "point lumineux\u00a0: P l’éteint",
}
LABELS: Mapping[str, Mapping[str, str]] = {"en": _ENGLISH, "fr": _FRENCH}
"""Labels by language and key."""


def labels_of(language: str) -> Mapping[str, str]:
    """Return the labels of a language by key; those of English where it has none."""
    return LABELS.get(language, _ENGLISH)
