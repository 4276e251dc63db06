"""Show the lines around a deliberate fault, without it and with it."""

from __future__ import annotations

from playground.lessons.model import Break
from playground.lessons.pictures import faulty
from playground.paths import GLSL
from playground.sketch.source import read_text

BESIDE = 4
"""Lines that are shown before and after those that differ."""


def around(block: Break) -> tuple[str, str]:
    """Return the lines around a fault as they should be, and as they are with it; raise as ``faulty``."""
    whole = read_text(GLSL / block.file)
    broken = faulty(block, whole)
    start = whole[: whole.index(block.find)].count("\n")
    first = max(start - BESIDE, 0)
    return (
        _lines(whole, first, start + block.find.count("\n") + BESIDE),
        _lines(broken, first, start + block.put.count("\n") + BESIDE),
    )


def _lines(text: str, first: int, last: int) -> str:
    found = text.split("\n")[first : last + 1]
    found = [line for line in found if not line.strip().startswith(("// anchor:", "// end:"))]
    while found and not found[0].strip():
        found.pop(0)
    while found and not found[-1].strip():
        found.pop()
    common = min((len(line) - len(line.lstrip()) for line in found if line.strip()), default=0)
    return "\n".join(line[common:] for line in found)
