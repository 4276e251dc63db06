"""Menus of techniques in a page: a sketch for each choice, and which of them is which."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import prod
from typing import Any

from playground.allowed_files import looking_once
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.errors import ParameterError, PlaygroundError, SketchError
from playground.publish.web.plan import KINDS
from playground.shader.parameter import label_of
from playground.sketch.model import DEFAULT_PICTURE, Sketch
from playground.sketch.replace_technique import choices, fits, nearest_fitting, with_technique

MAX_COMBINATIONS = 24
"""Sketches that a page may hold: one for each combination of techniques."""


@looking_once()
def technique_menus(
    sketch: Sketch, names: Mapping[str, Sequence[str]]
) -> tuple[list[Sketch], list[list[dict[str, Any]]]]:
    """Return a sketch for each combination of techniques, the sketch itself first, and the menus of each.

    ``names`` lists techniques by pass, as ``use`` names them; none means all that fit and
    can be planned. What fills a pass now is always among them. Raises ``ParameterError`` for more than
    ``MAX_COMBINATIONS`` combinations, ``SketchError`` for what does not fit.
    """
    lists = {name: _fitting(sketch, name, uses) for name, uses in names.items()}
    count = prod(map(len, lists.values()))
    if count > MAX_COMBINATIONS:
        listed = " x ".join(f"{len(uses)} of {name}" for name, uses in lists.items())
        raise ParameterError(
            f"{listed} are {count} sketches in one page; at most {MAX_COMBINATIONS}: name fewer techniques"
        )
    chosen = list(product(*lists.values()))
    numbers = {uses: number for number, uses in enumerate(chosen)}
    sketches: list[Sketch] = []
    for uses in chosen:
        made = sketch
        for name, use in zip(lists, uses, strict=True):
            made = with_technique(made, name, use)
        sketches.append(made)
    menus: list[list[dict[str, Any]]] = []
    for uses in chosen:
        menus.append([])
        for at, name in enumerate(lists):
            others = []
            for use in lists[name]:
                number = numbers[(*uses[:at], use, *uses[at + 1 :])]
                filled = sketches[number].graph.find(name)
                assert filled is not None
                others.append({"use": use, "title": filled.technique.title, "sketch": number})
            menus[-1].append({"pass": name, "label": label_of(name), "now": uses[at], "others": others})
    return sketches, menus


def _fitting(sketch: Sketch, name: str, uses: Sequence[str]) -> list[str]:
    """Return what fills a pass, and what else is wanted there."""
    techniques = uses or [use for use in choices(sketch, name) if _is_planned(sketch, name, use)]
    for use in uses:
        if not fits(sketch, name, use):
            hint = nearest_fitting(sketch, name, use)
            raise SketchError(f"no technique '{use}' fits pass '{name}'{hint}")
    spec = sketch.graph.find(name)
    assert spec is not None  # or ``choices`` has said so
    return list(dict.fromkeys([spec.use, *techniques]))


def _is_planned(sketch: Sketch, name: str, use: str) -> bool:
    try:
        changed = with_technique(sketch, name, use)
        make_plan(changed, PlanRequest(frame_size=DEFAULT_PICTURE, variants=KINDS))
    except PlaygroundError:
        return False
    return True
