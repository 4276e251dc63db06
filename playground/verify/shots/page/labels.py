"""Explain each word of a result: a label, and a message or two on what to make of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a word of a result means."""

    label: str  # a few words, for a list
    sentence: str  # what it is, and what to do
    broken: bool = False  # whether there is no picture to trust


MEANINGS = {
    "same": Meaning("passed", "The picture is the one expected."),
    "differs": Meaning(
        "differs",
        "The picture is not the reference, by more than the tier allows. If the change was meant,"
        " accept the picture; if not, the difference shows where to look.",
    ),
    "crowded": Meaning(
        "differs in one place",
        "Few pixels differ, but they lie close together, as when a small thing was moved, lost or added."
        " Rounding scatters its differences over the picture; this is something else.",
    ),
    "structure": Meaning(
        "differs in structure",
        "Another renderer drew the reference, so single levels mean nothing; but an eye would see this"
        " difference. The FLIP map shows where.",
    ),
    "size": Meaning(
        "another size",
        "The picture has another size than the reference, so they cannot be compared pixel by pixel."
        " Here their top left corners lie on each other.",
    ),
    "missing": Meaning(
        "no reference",
        "There is no reference yet, so nothing says whether this picture is right."
        " Look at it closely, then accept it: later runs are compared with it.",
    ),
    "unreadable": Meaning(
        "reference damaged",
        "The reference is there but cannot be read. Take it from the history of the repository again,"
        " or accept the new picture in its place.",
    ),
    "blank": Meaning(
        "blank",
        "Every pixel has the same colour, which is what most broken renders look like."
        " A blank picture fails even if its reference is blank, unless the shot says allow_blank.",
        broken=True,
    ),
    "nan": Meaning(
        "not a number",
        "Values that are no numbers, or infinite, were drawn. What a screen shows for them is undefined,"
        " so the picture cannot be accepted, however it looks.",
        broken=True,
    ),
    "gl-error": Meaning(
        "OpenGL error",
        "Drawing left an OpenGL error behind. Whatever the picture looks like, it is not to be trusted,"
        " and cannot be accepted.",
        broken=True,
    ),
    "error": Meaning(
        "error",
        "The shot could not be drawn or compared: something is wrong with it, or with a shader or a file.",
        broken=True,
    ),
    "crash": Meaning(
        "crash",
        "The process that draws died before it gave a picture: the driver or its shader compiler crashed,"
        " or memory ran out. The other shots were drawn by a new process.",
        broken=True,
    ),
    "hang": Meaning(
        "hang",
        "Drawing took longer than its limit and was stopped: a loop without an end, or a shader that is"
        " far too slow here. The other shots were drawn by a new process.",
        broken=True,
    ),
}


def meaning(word: str) -> Meaning:
    """Return what a word means; of one that is not known, itself."""
    return MEANINGS.get(word) or Meaning(word, "")
