"""Show the lines around a deliberate fault, without it and with it, and put others in their place."""

from __future__ import annotations

from dataclasses import dataclass

from playground.lessons.figure_renders import faulty
from playground.lessons.model import Break
from playground.paths import GLSL
from playground.sketch.source import read_text

BESIDE = 4
"""Lines that are shown before and after those that differ."""

_MARKS = ("// anchor:", "// end:")


@dataclass(frozen=True, slots=True)
class Region:
    """The lines around a fault, without the indentation that all have and the marks of anchors."""

    whole: str  # as they should be
    broken: str  # with the fault
    before: str  # the file's text above them
    after: str  # and below
    indent: str

    def with_lines(self, lines: str) -> str:
        """Return the file's text with other lines in place of these."""
        moved = [f"{self.indent}{line}" if line.strip() else "" for line in lines.strip("\n").split("\n")]
        return "\n".join(part for part in (self.before, *moved, self.after))


def around(block: Break) -> tuple[str, str]:
    """Return the lines around a fault as they should be, and as they are with it; raise as ``faulty``."""
    found = region(block)
    return found.whole, found.broken


def region(block: Break) -> Region:
    """Return the lines around a fault; raise as ``faulty``."""
    whole = read_text(GLSL / block.file)
    broken = faulty(block, whole)
    lines, faults = whole.split("\n"), broken.split("\n")
    start = whole[: whole.index(block.find)].count("\n")
    first = max(start - BESIDE, 0)
    last = min(start + block.find.count("\n") + BESIDE, len(lines) - 1) + 1
    while first < start and not lines[first].strip():
        first += 1
    rest = len(lines) - last
    shown, faulty_ones = lines[first:last], faults[first : len(faults) - rest]
    common = min((len(x) - len(x.lstrip()) for x in (*shown, *faulty_ones) if x.strip()), default=0)
    return Region(
        _dedented(shown, common),
        _dedented(faulty_ones, common),
        "\n".join(lines[:first]),
        "\n".join(lines[last:]),
        " " * common,
    )


def _dedented(lines: list[str], by: int) -> str:
    kept = [line for line in lines if not line.strip().startswith(_MARKS)]
    while kept and not kept[-1].strip():
        kept = kept[:-1]
    return "\n".join(line[by:] for line in kept)
