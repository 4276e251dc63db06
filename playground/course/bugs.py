"""Show the lines around a deliberate bug, without it and with it, and put others in their place."""

from __future__ import annotations

from dataclasses import dataclass

from playground.course.figure_renders import with_bug
from playground.course.model import Break
from playground.paths import GLSL
from playground.shader.source import read_text

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
