"""The conditions of a text, judged by what a tool or a browser defines: which of its lines there are.

Where every condition of a group can be judged, its directives and the branches that are left out become
blank; lines stay. What depends on the driver (``GL_…``, ``__VERSION__``) stays as it is, and so does a text
whose conditions do not close. ``syntax.preprocessor`` judges, and expands macros.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from playground.shader.source import SourceText
from playground.shader.syntax.preprocessor import judge
from playground.shader.syntax.tokens import Token, tokenize, without_comments

WEBGL = {
    "GL_ES": "1",
    "__VERSION__": "100",
    "GL_FRAGMENT_PRECISION_HIGH": "1",
    "GL_OES_standard_derivatives": "1",
    "GL_EXT_shader_texture_lod": "1",
    "GL_EXT_frag_depth": "1",
}
"""What WebGL 1 defines, with its extensions that every browser has."""

WEBGL_2 = {"GL_ES": "1", "__VERSION__": "300", "GL_FRAGMENT_PRECISION_HIGH": "1"}
"""What WebGL 2 defines."""

_OF_TOOLS = frozenset({"GL_ES", "SHADER_TOY", "GLSLVIEWER", "PASSINDEX", "HW_PERFORMANCE"})
"""What one tool defines and another does not."""


class Conditions:
    """The lines of a text, comments blanked, and the conditions among them."""

    def __init__(self, codes: Sequence[str]) -> None:
        self.codes = tuple(codes)
        lines = [(number, code.strip()) for number, code in enumerate(codes) if "#" in code]
        # Tokens whose places are lines.
        self._directives = [
            Token(text, "directive", number, number, number) for number, text in lines if text.startswith("#")
        ]

    @property
    def names(self) -> frozenset[str]:
        """Every name of a condition."""
        texts = [token.text[1:].lstrip() for token in self._directives]
        conditions = [text for text in texts if text.startswith(("if", "elif"))]
        return frozenset(
            token.text for text in conditions for token in tokenize(text)[0][1:] if token.kind == "word"
        )

    def live(
        self, defined: Mapping[str, str], *, unsure: Collection[str] = (), unknown: bool | None = None
    ) -> tuple[str, ...]:
        """Return the lines with what is left out blank, where these macros are defined before them.

        The conditions of those that are ``unsure`` stay. ``unknown``: whether what depends on the driver is
        defined; None: its conditions stay too.
        """
        if not self._directives:
            return self.codes
        result = judge(self._directives, defined, unsure=unsure, unknown=unknown)
        lines = list(self.codes)
        blank = [directive.start for directive in result.judged]
        for number in (
            *blank,
            *(number for span in result.inactive for number in range(span[0] + 1, span[1])),
        ):
            lines[number] = ""
        return tuple(lines)


def macros_of(lines: Iterable[str]) -> dict[str, str]:
    """Return the macros that some lines define, of those that take no arguments."""
    words = [line.split(maxsplit=2) for line in lines if line.startswith("#define")]
    return {name: " ".join(meaning) for _, name, *meaning in words}


def live_source(
    source: SourceText,
    defined: Mapping[str, str],
    *,
    unsure: Collection[str] = (),
    unknown: bool | None = False,
) -> SourceText:
    """Return a text without the branches that are off; see ``Conditions.live``."""
    conditions = Conditions([line.code for line in source.lines])
    return source.with_codes(conditions.live(defined, unsure=unsure, unknown=unknown))


def code_of(text: str) -> str:
    """Return a text without comments, its continued lines joined."""
    return without_comments(text).replace("\\\n", " ")


def live_code(text: str, defined: Mapping[str, str]) -> str:
    """Return the code of a text whose tool is not known yet, without the branches that are off.

    What one tool defines and another does not is unknown but for what is ``defined``.
    """
    unsure = _OF_TOOLS.difference(defined)
    return "\n".join(Conditions(code_of(text).split("\n")).live(defined, unsure=unsure))


def without_guards(lines: Sequence[str]) -> list[int]:
    """Return the indices of the lines that are neither a guard's nor there a second time.

    ``lines`` have no comments. A guard is ``#ifndef`` with a ``#define`` of its name in the next line.
    """
    numbers: list[int] = []
    guards: set[str] = set()
    stack: list[str] = []  # of each open condition: "guard", "twice" or "other"
    directives = [line.replace("#", "# ", 1).split() if "#" in line else [] for line in lines]
    skip = -1  # the line of a guard's macro
    for index, words in enumerate(directives):
        if index == skip:
            continue
        word, names = (words[1], words[2:]) if len(words) > 1 and words[0] == "#" else ("", [])
        if word.startswith("if"):
            name = names[0] if word == "ifndef" and len(names) == 1 else ""
            if name and name in guards:
                stack.append("twice")
                continue
            if name and directives[index + 1 : index + 2] == [["#", "define", name]]:
                stack.append("guard")
                guards.add(name)
                skip = index + 1
                continue
            stack.append("other")
        elif word == "endif" and stack and stack.pop() != "other":
            continue
        if "twice" not in stack:
            numbers.append(index)
    return numbers
