"""Quote a shader by a named anchor: the lines between ``// anchor: name`` and ``// end: name``.

And the lines around a deliberate bug.
"""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass

from playground.course.model import Break
from playground.course.scenes import with_bug
from playground.errors import SketchError, nearest
from playground.paths import GLSL
from playground.shader.source import read_text

_MARK = re.compile(r"^\s*//\s*(anchor|end):\s*(\S+)\s*$")


@dataclass(frozen=True, slots=True)
class Excerpt:
    """Lines of a shader."""

    file: str  # in glsl/
    line: int  # of the first of them, from 1
    text: str  # without the indentation that all have


def excerpt(file: str, anchor: str, text: str | None = None) -> Excerpt:
    """Return what an anchor marks in a file of ``glsl/``; the marks of other anchors are left out.

    ``text`` replaces what is in the file. Raises ``SketchError`` where there is no such
    anchor, or where it has no end.
    """
    excerpts = anchors(file, read_text(GLSL / file) if text is None else text)
    if anchor not in excerpts:
        hint = nearest(anchor, excerpts) or "; it has none"
        raise SketchError(f"no anchor '{anchor}'{hint}", file=GLSL / file)
    return excerpts[anchor]


def anchors(file: str, text: str) -> dict[str, Excerpt]:
    """Return what each anchor of a text marks, by name."""
    open_at: dict[str, int] = {}
    excerpts: dict[str, Excerpt] = {}
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        mark = _MARK.match(line)
        if mark is None:
            continue
        word, name = mark.groups()
        if word == "anchor":
            if name in open_at or name in excerpts:
                raise SketchError(f"a second anchor '{name}'", file=GLSL / file, line=number)
            open_at[name] = number
        elif name not in open_at:
            raise SketchError(f"anchor '{name}' ends before it begins", file=GLSL / file, line=number)
        else:
            first = open_at.pop(name)
            inside = [each for each in lines[first : number - 1] if not _MARK.match(each)]
            marked = textwrap.dedent("\n".join(each.rstrip() for each in inside))
            excerpts[name] = Excerpt(file, first + 1, marked.strip("\n"))
    for name, number in open_at.items():
        raise SketchError(f"anchor '{name}' has no end", file=GLSL / file, line=number)
    return excerpts


CONTEXT = 4
"""Lines that are shown before and after those that differ."""

_MARKS = ("// anchor:", "// end:")


@dataclass(frozen=True, slots=True)
class BugRegion:
    """The lines around a bug, without the indentation that all have and the marks of anchors."""

    correct: str  # without the bug
    broken: str  # with the bug
    before: str  # the file's text above them
    after: str  # and below
    indent: str

    def with_lines(self, lines: str) -> str:
        """Return the file's text with other lines in place of these."""
        moved = [f"{self.indent}{line}" if line.strip() else "" for line in lines.strip("\n").split("\n")]
        return "\n".join(part for part in (self.before, *moved, self.after))


def bug_region(block: Break) -> BugRegion:
    """Return the lines around a bug; raise as ``with_bug``."""
    text = read_text(GLSL / block.file)
    broken = with_bug(block, text)
    lines, broken_lines = text.split("\n"), broken.split("\n")
    start = text[: text.index(block.find)].count("\n")
    first = max(start - CONTEXT, 0)
    last = min(start + block.find.count("\n") + CONTEXT, len(lines) - 1) + 1
    while first < start and not lines[first].strip():
        first += 1
    shown = lines[first:last]
    shown_broken = broken_lines[first : len(broken_lines) - (len(lines) - last)]
    common = min((len(x) - len(x.lstrip()) for x in (*shown, *shown_broken) if x.strip()), default=0)
    return BugRegion(
        correct=_dedented(shown, common),
        broken=_dedented(shown_broken, common),
        before="\n".join(lines[:first]),
        after="\n".join(lines[last:]),
        indent=" " * common,
    )


def _dedented(lines: list[str], by: int) -> str:
    text = "\n".join(line[by:] for line in lines if not line.strip().startswith(_MARKS))
    return text.rstrip()
