"""Say what differs in a work, in the reader's language, without the answer."""

from __future__ import annotations

import math

from playground.course.language import Labels, in_language, labels
from playground.course.measuring import spelled
from playground.course.tasks.judge import Match
from playground.course.tasks.verdict import CheckResult, Verdict
from playground.shader.parameter import spell

_BRIGHTER = 1.0  # level of 255, in the mean, from which a picture is called brighter or darker


def sentences(verdict: Verdict, language: str) -> list[str]:
    """Return a sentence for each check, or for each mistake that kept the work from being drawn."""
    if verdict.diagnostics:
        return [str(diagnostic) for diagnostic in verdict.diagnostics]
    return [sentence_of(result, language) for result in verdict.results]


def points_of(verdict: Verdict, language: str) -> str:
    """Return the points as "1.5 of 2 points"; in French as "1,5 point sur 2": its plural begins at two."""
    several = verdict.points >= 2 if language == "fr" else verdict.of > 1
    key = "points" if several else "point"
    return labels("tasks", language)(key, got=_number(verdict.points, language), of=verdict.of)


def score_of(match: Match, language: str) -> str:
    """Return how near a challenge's picture is as "Score 87 of 100; solved from 95."."""
    return labels("tasks", language)("score_of", score=int(match.score), goal=match.goal)


def sentence_of(result: CheckResult, language: str) -> str:
    """Return what comes of one check as a sentence."""
    say, check = labels("tasks", language), result.check
    settings = ", ".join(f"{path} = {_local(spell(value), language)}" for path, value in check.at)
    where = say["hidden"] if check.hidden else say("at", at=settings) if check.at else ""
    message = _found(result, say, language)
    return f"{where}{message}" if where else f"{message[0].upper()}{message[1:]}"


def _found(result: CheckResult, say: Labels, language: str) -> str:
    check = result.check
    if result.mistake:
        return say("mistake", mistake=in_language(result.mistake, language).rstrip("."))
    if check.measure is not None:
        return _of_measure(result, say, language)
    kind, of = "texture" if check.of else "picture", f"`{check.of}`"
    if result.passed:
        return say(f"right_{kind}", of=of)
    if result.sizes:
        mine, expected = (_size(size, say) for size in result.sizes)
        return say("size" if check.of else "picture_size", of=of, mine=mine, wanted=expected)
    if result.not_finite:
        return say(
            "not_finite" if result.not_finite > 1 else "not_finite_one", of=of, count=result.not_finite
        )
    region = say[f"{'map' if check.of else 'place'}_{result.region}"] if result.region else ""
    least = check.tolerance if check.of else _BRIGHTER
    more = "more" if result.bias > 0 else "less"
    bias = say[f"bias_{kind}_{more}"] if abs(result.bias) > least else ""
    by, tolerance = (_number(value, language) for value in (result.difference, check.tolerance))
    share = _local(spelled(100.0 * result.difference, 2, "%"), language)
    return say(f"wrong_{kind}", of=of, share=share, by=by, tolerance=tolerance, place=region, bias=bias)


def _of_measure(result: CheckResult, say: Labels, language: str) -> str:
    check, measure = result.check, result.check.measure
    assert measure is not None and measure.between is not None
    what = say[f"measure_{measure.what}"]
    if not math.isfinite(result.difference):
        return say("no_value", what=what, of=f"`{check.of}`")
    low, high, value = (
        _local(spelled(number, 3, measure.unit), language) for number in (*measure.between, result.difference)
    )
    hidden = "hidden_" if check.hidden else ""
    key = f"{hidden}{'right' if result.passed else 'wrong'}_measure"
    return say(key, what=what, of=f"`{check.of}`", value=value, low=low, high=high)


def _size(size: tuple[int, ...], say: Labels) -> str:
    if len(size) == 2:
        return say("texels", width=size[0], height=size[1])
    return say("channels", width=size[0], height=size[1], channels=size[2])


def _number(value: float, language: str) -> str:
    return _local(f"{value:.3g}", language)


def _local(text: str, language: str) -> str:
    return text.replace(".", ",") if language == "fr" else text
