"""Judge a picture in every tier, as if its reference came from there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from playground.engine.context import ContextInfo
from playground.verify.shots.fingerprint import fingerprint_of
from playground.verify.shots.judge import OTHER_BUILD, OTHER_RENDERER, SAME_BUILD, Judgement, Rule, judge
from playground.verify.shots.references import Reference
from playground.verify.shots.suite import RenderedShot

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
