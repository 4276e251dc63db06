"""The verdicts on a shot: every word by which a check can end, and all that depends on the word."""

from __future__ import annotations

from dataclasses import dataclass

from playground.errors import OpenGLFault, PlaygroundError, SandboxCrash, SandboxTimeout

PASSED = "same"
"""The word of a shot that passes; all others fail."""

_REFUSED = "No reference can be made of it: fix the sketch or the shader, then run the tests again."


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What a word of a result means, and what may follow from it."""

    label: str  # a few words, for a list
    meaning: str  # what it is, and what to do
    chip: str = "bad"  # class of its mark in report.css
    passes: bool = False
    refusal: str = ""  # why no reference may be made: the picture is broken, or there is none; "": one may
    measured: bool = False  # whether pixels were compared one with another
    tolerable: bool = False  # whether a tolerance that the shot declares may let it pass
    of_frame: bool = True  # whether the frame of a film that it is of is named
    error: type[PlaygroundError] | None = None  # that ends a check so; any other is an "error"

    @property
    def acceptable(self) -> bool:
        """Whether a reference may be made of the picture."""
        return not self.refusal


VERDICTS = {
    PASSED: Verdict(
        label="passed",
        meaning="The picture is the one expected.",
        chip="good",
        passes=True,
        measured=True,
    ),
    "differs": Verdict(
        label="differs",
        meaning="The picture is not the reference, by more than the tier allows. If the change was meant,"
        " accept the picture; if not, the difference shows where to look.",
        measured=True,
        tolerable=True,
    ),
    "crowded": Verdict(
        label="differs in one place",
        meaning="Few pixels differ, but they lie close together, as when a small thing was moved, lost or"
        " added. Rounding scatters its differences over the picture; this is something else.",
        measured=True,
        tolerable=True,
    ),
    "structure": Verdict(
        label="differs in structure",
        meaning="Another renderer drew the reference, so single levels mean nothing; but an eye would see"
        " this difference. The FLIP map shows where.",
        measured=True,
    ),
    "size": Verdict(
        label="another size",
        meaning="The picture has another size than the reference, so they cannot be compared pixel by pixel."
        " Here their top left corners lie on each other.",
    ),
    "missing": Verdict(
        label="no reference",
        meaning="There is no reference yet, so nothing says whether this picture is right."
        " Look at it closely, then accept it: later runs are compared with it.",
        chip="new",
        of_frame=False,
    ),
    "unreadable": Verdict(
        label="reference damaged",
        meaning="The reference is there but cannot be read. Take it from the history of the repository again,"
        " or accept the new picture in its place.",
    ),
    "blank": Verdict(
        label="blank",
        meaning="Every pixel has the same colour, which is what most broken renders look like."
        " A blank picture fails even if its reference is blank, unless the shot says allow_blank.",
        chip="broken",
        refusal="No reference can be made of it, unless the shot says allow_blank.",
    ),
    "nan": Verdict(
        label="not a number",
        meaning="Values that are no numbers, or infinite, were drawn. What a screen shows for them is"
        " undefined, so the picture cannot be accepted, however it looks.",
        chip="broken",
        refusal=_REFUSED,
        of_frame=False,
    ),
    "gl-error": Verdict(
        label="OpenGL error",
        meaning="Drawing left an OpenGL error behind. Whatever the picture looks like, it is not to be"
        " trusted, and cannot be accepted.",
        chip="broken",
        refusal=_REFUSED,
        of_frame=False,
        error=OpenGLFault,
    ),
    "error": Verdict(
        label="error",
        meaning="The shot could not be drawn or compared: something is wrong with it, or with a shader or a"
        " file.",
        refusal="Nothing to accept: fix the reported error, then run the tests again.",
    ),
    "crash": Verdict(
        label="crash",
        meaning="The process that draws died before it gave a picture: the driver or its shader compiler"
        " crashed, or memory ran out. The other shots were drawn by a new process.",
        chip="broken",
        refusal=_REFUSED,
        error=SandboxCrash,
    ),
    "hang": Verdict(
        label="hang",
        meaning="Drawing took longer than its limit and was stopped: a loop without an end, or a shader that"
        " is far too slow here. The other shots were drawn by a new process.",
        chip="broken",
        refusal=_REFUSED,
        error=SandboxTimeout,
    ),
}
"""By word, in the order in which a report counts them."""


def verdict_on(word: str) -> Verdict:
    """Return what a word means; a word that this version does not know fails, and may be accepted."""
    return VERDICTS.get(word) or Verdict(label=word, meaning="")


def word_of(error: PlaygroundError) -> str:
    """Return the word for what gave no picture: "crash", "hang", "gl-error" or "error"."""
    words = (word for word, each in VERDICTS.items() if each.error and isinstance(error, each.error))
    return next(words, "error")
