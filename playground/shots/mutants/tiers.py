"""Judge a picture in every tier, as if its reference came from there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from playground.shots.fingerprint import Fingerprint
from playground.shots.judge import OTHER_BUILD, OTHER_RENDERER, SAME_BUILD, Judgement, judge
from playground.shots.mutants.model import Picture
from playground.shots.references import Reference

TIERS = (SAME_BUILD, OTHER_BUILD, OTHER_RENDERER)
"""The tiers, the strictest first."""


def judged(
    actual: Picture,
    expected: Picture,
    fingerprint: Fingerprint,
    *,
    not_finite: str = "",
    gl_error: str = "",
) -> tuple[Judgement, ...]:
    """Return the judgement of each of `TIERS`.

    ``fingerprint`` is the actual picture's; ``not_finite`` and ``gl_error`` say what was wrong
    when it was drawn. The pixels are the same in all three: what the other builds and renderers
    would draw differently by themselves comes on top.
    """
    found = []
    for tier in TIERS:
        origin = fingerprint
        if tier != SAME_BUILD:
            origin = replace(fingerprint, version=f"{fingerprint.version}, {tier}")
        reference = Reference(Path(), expected, origin.texts())
        own, others = ((), (reference,)) if tier == OTHER_RENDERER else ((reference,), ())
        judgement, _ = judge(actual, fingerprint, own, others, not_finite=not_finite, gl_error=gl_error)
        found.append(judgement)
    return tuple(found)
