"""Draw every mutant of a shot, and judge each in every tier.

What a mutant is compared with is the unbroken shot, drawn just before by the same engine:
so the suite needs no reference, and any renderer, sketch and size will do. The reference
is then treated as one of the same build, of another build, of another renderer: three
judgements of one picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.errors import ContextError, SketchError, nearest
from playground.sketch.model import Shot, Sketch
from playground.verify.shots.compare import Comparison, compare
from playground.verify.shots.judge import (
    OTHER_BUILD,
    OTHER_RENDERER,
    SAME_BUILD,
    Judgement,
    Perceived,
    Rule,
    judge,
)
from playground.verify.shots.mutants.finished import FINISHED
from playground.verify.shots.mutants.rendering import (
    DoesNotApply,
    Mutant,
    Picture,
    SketchMutant,
    broken,
    rendering_mutants,
)
from playground.verify.shots.references import Reference, fingerprint_of
from playground.verify.shots.suite import RenderedShot, ShotCase, render_shot, rule_of

# ── a picture in every tier ──────────────────────────────────────────────────


TIERS = (SAME_BUILD, OTHER_BUILD, OTHER_RENDERER)
"""The tiers, the strictest first."""


def judged(
    actual: RenderedShot, expected: RenderedShot, renderer: ContextInfo, rule: Rule | None = None
) -> tuple[Judgement, ...]:
    """Return the judgement of each of `TIERS` of a picture and the one that it should be.

    The same ``renderer`` drew both. The pixels are the same in all three tiers: what other
    builds and renderers would draw differently by themselves comes on top. ``rule`` is what the shot
    says of its comparison.
    """
    judgements = []
    fingerprint = fingerprint_of(renderer, actual.size, actual.drawn)
    wrong = {"not_finite": actual.not_finite, "gl_error": actual.gl_error}
    for tier in TIERS:
        origin = fingerprint_of(renderer, expected.size, expected.drawn)
        if tier != SAME_BUILD:
            origin = replace(origin, version=f"{origin.version}, {tier}")
        reference = Reference(Path(), expected.array, origin.texts())
        own, others = ((), (reference,)) if tier == OTHER_RENDERER else ((reference,), ())
        judgements.append(judge(actual.array, fingerprint, own, others, **wrong, rule=rule)[0])
    return tuple(judgements)


# ── mutants ──────────────────────────────────────────────────────────────────


ROUNDING = 1
"""[levels of 255] What rounding the other way may change; a defect of that size cannot be detected."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MutantResult:
    """What came of one mutant."""

    mutant: Mutant
    shot: str
    comparison: Comparison | None = None  # with the unbroken picture; None: the mutant does not apply
    tiers: tuple[Judgement, ...] = ()  # of each of `TIERS`; none if it does not apply
    why_not: str = ""  # why it does not apply
    picture: Picture | None = None

    @property
    def applies(self) -> bool:
        """Whether the sketch has what the mutant breaks."""
        return not self.why_not

    @property
    def unseen(self) -> bool:
        """Whether the shot does not show the defect: no level differs by more than rounding may change it."""
        comparison = self.comparison
        faint = comparison is not None and comparison.ok and comparison.most <= ROUNDING
        return faint and not self.mutant.exempt and not self.caught()

    @property
    def counts(self) -> bool:
        """Whether the mutant is a defect that this shot shows."""
        return self.applies and not self.unseen and not self.mutant.exempt

    def caught(self, tier: int = 0) -> bool:
        """Return whether a tier does not let it pass."""
        return not self.tiers[tier].ok

    @property
    def fraction(self) -> float:
        """Fraction of the pixels that differ by more than one level."""
        assert self.comparison is not None
        return self.comparison.over / (self.comparison.size[0] * self.comparison.size[1])

    @property
    def perceived(self) -> Perceived | None:
        """FLIP's numbers; None where there is nothing to see, or no picture to compare."""
        return next((judgement.perceived for judgement in self.tiers if judgement.perceived), None)

    @property
    def well(self) -> bool:
        """Whether the same build catches the defect, or lets pass what is none."""
        return not self.applies or self.unseen or self.caught() is not self.mutant.exempt

    def as_json(self) -> dict[str, object]:
        """Return it as JSON takes it."""
        comparison = self.comparison
        return {
            "name": self.mutant.name,
            "broke": self.mutant.broke,
            "kind": self.mutant.kind,
            "exempt": self.mutant.exempt,
            "shot": self.shot,
            "why_not": self.why_not,
            "unseen": self.unseen,
            "most": None if comparison is None else comparison.most,
            "fraction_over_1": None if comparison is None else self.fraction,
            "flip_mean": None if self.perceived is None else self.perceived.mean,
            "flip_tile": None if self.perceived is None else self.perceived.tile,
            "tiers": {
                tier: {"caught": not judgement.ok, "word": judgement.word, "message": judgement.message}
                for tier, judgement in zip(TIERS, self.tiers, strict=False)
            },
        }


def all_mutants() -> tuple[Mutant, ...]:
    """Return every mutant that there is, those of rendering first."""
    return (*rendering_mutants(), *FINISHED)


def named(names: Sequence[str]) -> tuple[Mutant, ...]:
    """Return mutants by name, all of them if none is named; raise ``SketchError`` with the nearest name."""
    mutants = {mutant.name: mutant for mutant in all_mutants()}
    for name in names:
        if name not in mutants:
            raise SketchError(f"no mutant '{name}'{nearest(name, mutants)}")
    return tuple(mutants[name] for name in names) or tuple(mutants.values())


def shot_of(sketch: Sketch, name: str = "", size: tuple[int, int] | None = None) -> Shot:
    """Return the shot of that name, else the sketch's first, else its picture as it is.

    Raises ``SketchError`` where the name is none of the sketch's shots.
    """
    shot = sketch.shot(name) if name else next(iter(sketch.shots), Shot("picture"))
    return replace(shot, size=size or shot.size)


class MutantRunner:
    """A sketch, an engine, and the unbroken pictures that mutants are compared with."""

    def __init__(
        self, engine: Engine, sketch: Sketch, shot: str = "", size: tuple[int, int] | None = None
    ) -> None:
        self.engine = engine
        self.sketch = sketch
        self.shot = shot  # which is drawn for every mutant; "": for each mutant the one that shows it
        self.size = size  # [pixels] None: the shot's
        self.expected: dict[str, RenderedShot] = {}  # unbroken, by the shot's name

    def run(self, mutants: Sequence[Mutant]) -> Iterator[MutantResult]:
        """Yield what came of each mutant.

        Raises ``PlaygroundError`` where the sketch itself cannot be drawn.
        """
        for mutant in mutants:
            has = any(shot.name == mutant.shot for shot in self.sketch.shots)
            shot = shot_of(self.sketch, self.shot or (mutant.shot if has else ""), self.size)
            yield self._result(mutant, shot)

    def unbroken(self, shot: Shot) -> RenderedShot:
        """Return the picture that a shot should be; raise ``ContextError`` for one that is not sound."""
        if shot.name not in self.expected:
            rendered = self._take(self.sketch.for_shot(shot), shot, shot.time)
            if wrong := rendered.gl_error or rendered.not_finite:
                raise ContextError(f"drawing {self.sketch.name}/{shot.name}, with nothing broken: {wrong}")
            self.expected[shot.name] = rendered
        return self.expected[shot.name]

    def _take(self, shown: Sketch, shot: Shot, time: float) -> RenderedShot:
        # What the shot sets is set already: it must not be set over what a mutant breaks.
        target = Shot(shot.name, shot.size, time, steps=shot.steps, mask=shot.mask)
        return render_shot(self.engine, ShotCase(shown, target))

    def _result(self, mutant: Mutant, shot: Shot) -> MutantResult:
        expected = self.unbroken(shot)
        if isinstance(mutant, SketchMutant):
            try:
                sketch = broken(mutant, self.sketch.for_shot(shot))
            except DoesNotApply as reason:
                return MutantResult(mutant=mutant, shot=shot.name, why_not=str(reason))
            forms = self.engine.plain_forms
            notice, forms.notice = forms.notice, silent  # what has a broken text has no fast variant
            try:
                rendered = self._take(sketch, shot, shot.time + mutant.later)
            finally:
                forms.notice = notice
        else:
            rendered = replace(expected, array=mutant.change(expected.array))
        tiers = judged(rendered, expected, self.engine.info, rule_of(ShotCase(self.sketch, shot), expected))
        comparison = compare(rendered.array, expected.array)
        return MutantResult(
            mutant=mutant, shot=shot.name, comparison=comparison, tiers=tiers, picture=rendered.array
        )


def survivors(results: Sequence[MutantResult], tier: int) -> list[str]:
    """Return the names of the defects that a tier lets pass."""
    return [result.mutant.name for result in results if result.counts and not result.caught(tier)]


def kill_rate(results: Sequence[MutantResult], tier: int) -> tuple[int, int]:
    """Return how many defects a tier catches, and of how many."""
    counted = [result for result in results if result.counts]
    return sum(result.caught(tier) for result in counted), len(counted)
