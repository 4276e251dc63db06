"""Every shot of every shipped sketch is its reference in screenshots/, exactly, on the reference renderer.

To rewrite what does not match: ./play test tests/test_shots.py --shots-update
"""

from __future__ import annotations

import pytest

from playground.shots.plugin import Shots
from playground.shots.suite import ShotCase, shots_of
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load

SKETCHES = [load(name) for name in shipped_sketches()]


@pytest.mark.parametrize("case", shots_of(SKETCHES), ids=str)
def test_shot(case: ShotCase, shots: Shots) -> None:
    shots.check(case)


def test_every_shipped_sketch_promises_a_picture() -> None:
    assert SKETCHES, "no sketches ship"
    assert not [sketch.name for sketch in SKETCHES if not sketch.shots]


def test_every_reference_belongs_to_a_shot(shots: Shots) -> None:
    shots.check_no_stale(SKETCHES)
