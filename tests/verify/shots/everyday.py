"""``python tests/verify/shots/everyday.py [SKETCH …]``: which everyday shots earn their place, by mutants.

The shots are taken from the cheapest to the most expensive. Each draws the mutants that no
shot before it has killed, as far as its sketch uses what they break, and keeps its place when
it kills one of them. So those that stay kill all that all kill; a shot that is named at the end
kills no mutant that another everyday shot misses, and belongs to the slow run:
``marks = ["slow"]``. A sketch that would lose its last everyday shot keeps its cheapest.

The mutants are the named ones of `playground.verify.shots.mutants`, on every sketch that they apply to,
and small changes of every shader file: ``EACH`` of its numbers, signs, minima and maxima, spread
over the file. A mutant is killed where a level differs by more than one, or a number is not finite.
What does not compile is no mutant. Terrains have a quarter of their side, pictures half of it.
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from playground.api import headless
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.errors import PlaygroundError
from playground.shader.source import read_text
from playground.sketch.find import shipped_sketches
from playground.sketch.model import Shot, Sketch, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.verify.shots.compare import compare
from playground.verify.shots.mutants.rendering import DoesNotApply, SketchMutant, broken, rendering_mutants
from playground.verify.shots.mutants.suite import ROUNDING
from playground.verify.shots.suite import RenderedShot, ShotCase, render_shot, shots_of

EACH = 2
"""Changes of one shader file."""

_COMMENTS = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
_DECLARED = re.compile(r"^[ \t]*(?:#|uniform\b|(?:for|while)\b|.*\b(?:for|while) *\()[^\n]*", re.M)
_CHANGES: tuple[tuple[str, Callable[[str], str]], ...] = (
    (r"(?<=[\w)\]]) [+-] (?=[\w(])", lambda sign: " - " if "+" in sign else " + "),
    (r"\bm(?:in|ax)(?=\()", lambda name: "max" if name == "min" else "min"),
    (r"(?<![\w.])\d+\.\d*[1-9]\d*(?![\w.])|(?<![\w.])[1-9]\d*\.0(?![\w.])", lambda n: f"({n} * 1.25)"),
)


@dataclass(frozen=True)
class Change:
    """A shader file of which one token is another."""

    file: str
    start: int
    end: int
    put: str

    @property
    def name(self) -> str:
        """The file and the line."""
        text = read_text(Path(self.file))
        line = text.count("\n", 0, self.start) + 1
        return f"{'/'.join(Path(self.file).parts[-3:])}:{line} {text[self.start : self.end]} → {self.put}"

    def text(self) -> str:
        """Return the changed text."""
        text = read_text(Path(self.file))
        return text[: self.start] + self.put + text[self.end :]


Defect = Change | SketchMutant


@cache
def changes_of(file: str) -> tuple[Change, ...]:
    """Return the changes of a shader file, spread evenly over it; comments and declarations stay."""
    text = read_text(Path(file))
    code = _COMMENTS.sub(lambda result: re.sub(r"[^\n]", " ", result[0]), text)
    code = _DECLARED.sub(lambda result: " " * len(result[0]), code)
    changes = [
        Change(file, match.start(), match.end(), put(match[0]))
        for pattern, put in _CHANGES
        for match in re.finditer(pattern, code)
    ]
    changes.sort(key=lambda change: change.start)
    chosen = np.linspace(0, len(changes) - 1, min(EACH, len(changes))).round().astype(int)
    return tuple(changes[i] for i in chosen)


def applied(defect: Defect, sketch: Sketch) -> Sketch:
    """Return the sketch with a defect; raise ``DoesNotApply`` where it has not what is broken."""
    if isinstance(defect, SketchMutant):
        return broken(defect, sketch)
    if defect.file not in files_of(sketch):
        raise DoesNotApply(f"the sketch does not use {defect.file}")
    return with_texts(sketch, {defect.file: defect.text()})


def files_of(sketch: Sketch) -> set[str]:
    """Return the shader files that a sketch uses, the variants' left out."""
    return {file for _, kernel in kernels_of(sketch.graph) for file in kernel.files}


def shown_by(case: ShotCase) -> Sketch:
    """Return the sketch as a shot shows it, its terrain with a quarter of the side where it takes that."""
    shown = case.sketch.for_shot(case.shot)
    side = shown.size[0] if shown.size else 0
    if side > 256:
        smaller = (side - 1) // 4 + 1 if side % 2 else side // 4
        with suppress(PlaygroundError):
            return shown.with_values({"size": smaller})
    return shown


class Judge:
    """Draws everyday shots, whole and broken."""

    def __init__(self, engine: Engine, cases: Sequence[ShotCase]) -> None:
        self.engine = engine
        self.cost: dict[ShotCase, float] = {}
        self.whole: dict[ShotCase, RenderedShot] = {}
        for case in cases:
            start = time.process_time()
            self.whole[case] = self.draw(case, shown_by(case))
            self.cost[case] = time.process_time() - start

    def draw(self, case: ShotCase, shown: Sketch) -> RenderedShot:
        """Draw a sketch that has what a shot sets, at half the shot's side."""
        shot = case.shot
        size = max(shot.size[0] // 2, 1), max(shot.size[1] // 2, 1)
        return render_shot(self.engine, ShotCase(shown, Shot(shot.name, size, shot.time, steps=shot.steps)))

    def kills(self, case: ShotCase, defect: Defect) -> bool:
        """Say whether a shot shows a defect; raise ``DoesNotApply`` where it has nothing of it."""
        shown = shown_by(case)
        later = defect.later if isinstance(defect, SketchMutant) else 0.0
        try:
            there = replace(case, shot=replace(case.shot, time=case.shot.time + later))
            draw = self.draw(there, applied(defect, shown))
        except PlaygroundError as error:
            raise DoesNotApply(str(error)) from error
        comparison = compare(draw.array, self.whole[case].array)
        return bool(comparison.most > ROUNDING or draw.not_finite or draw.gl_error)


def earn(judge: Judge, say: Callable[[str], None]) -> tuple[dict[ShotCase, list[Defect]], list[Defect]]:
    """Return what each shot kills that none before it does, the cheapest first, and what none kills."""
    cases = sorted(judge.cost, key=lambda case: judge.cost[case])
    files = set().union(*(files_of(case.sketch) for case in cases))
    alive: list[Defect] = [*rendering_mutants()]
    alive += [change for file in sorted(files) for change in changes_of(file)]
    killed: dict[ShotCase, list[Defect]] = {}
    tried: set[int] = set()  # identities: a named one holds lists
    for number, case in enumerate(cases):
        killed[case] = []
        for defect in alive:
            try:
                if judge.kills(case, defect):
                    killed[case].append(defect)
                tried.add(id(defect))
            except DoesNotApply:
                continue
        gone = {id(defect) for defect in killed[case]}
        alive = [defect for defect in alive if id(defect) not in gone]
        say(f"{number + 1} of {len(cases)} {judge.cost[case]:.2f} s {case}: {len(killed[case])} more killed")
    return killed, [defect for defect in alive if id(defect) in tried]


def without_a_place(killed: dict[ShotCase, list[Defect]]) -> Iterator[ShotCase]:
    """Yield the shots that kill nothing more, but for the cheapest of a sketch that keeps none."""
    seen = {case.sketch.name for case, defects in killed.items() if defects}
    for case, defects in killed.items():
        if not defects and case.sketch.name in seen:
            yield case
        seen.add(case.sketch.name)


def main() -> None:
    """Print which shots earn their place."""
    cases = [c for c in shots_of(sys.argv[1:] or shipped_sketches()) if "slow" not in c.shot.marks]

    def say(text: str) -> None:
        print(text, flush=True)

    with headless(software=True, notice=silent) as engine:
        judge = Judge(engine, cases)
        say(f"{len(cases)} everyday shots, {sum(judge.cost.values()):.1f} s of processor time")
        killed, survived = earn(judge, say)
    count = sum(map(len, killed.values()))
    leave = list(without_a_place(killed))
    say(f"killed: {count} of {count + len(survived)} mutants, by {sum(map(bool, killed.values()))} shots")
    for defect in survived:
        say(f"survives: {defect.name}")
    say(f"not needed: {len(leave)} shots, {sum(judge.cost[c] for c in leave):.1f} s of processor time")
    for case in leave:
        say(f"  {case}")


if __name__ == "__main__":
    main()
