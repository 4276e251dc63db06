"""Note which plans are made from nothing: most frames reuse the last one's."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from playground.engine import planner
from playground.engine.plan import Plan
from playground.sketch.model import Sketch


def plans_made_whole(monkeypatch: pytest.MonkeyPatch) -> list[Sketch]:
    """Return a list that grows by the sketch of each plan that is made from nothing."""
    sketches: list[Sketch] = []
    build = planner.Planning.build

    def noted(self: planner.Planning, refused: Mapping[str, str]) -> Plan:
        sketches.append(self.sketch)
        return build(self, refused)

    monkeypatch.setattr(planner.Planning, "build", noted)
    return sketches
