"""A sun that is drawn on an arc of its own although it is set elsewhere is reported, once."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.workbench.session import Session

SKETCH = """format = 1
size = 33
extent = 1000.0
relief = 300.0
[[pass]]
name = "height"
use = "generation/diamond_square"
[[pass]]
name = "light"
use = "lighting/horizon_sun"
set = { sun = { azimuth = 135.0, elevation = 25.0 }, arc = 135.0 }
[view]
use = "view/map"
inputs = { shown = "light" }
"""


@pytest.mark.parametrize(("azimuth", "off"), [(135.0, False), (315.0, False), (200.0, True)])
def test_a_sun_off_its_arc_is_reported_once(
    any_engine: Engine, tmp_path: Path, azimuth: float, off: bool
) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    session = Session(any_engine, tmp_path)
    try:
        session.frame((32, 32))
        assert session.error is None and not session.notes
        for elevation in (30.0, 40.0):
            session.drafts.set("light.sun", (azimuth, elevation))
            session.frame((32, 32))
        notes = [note for note in session.notes if "off its arc at 135°" in note]
        assert len(notes) == (1 if off else 0)
        session.drafts.set("light.arc", -360.0)  # the arc follows the sun again
        session.frame((32, 32))
        assert len(session.notes) == len(notes)
    finally:
        session.release()
