"""Five hundred reloads keep no more than two hundred do."""

from __future__ import annotations

import gc
import math
import sys
from collections import Counter
from pathlib import Path

import moderngl
import pytest

from playground.engine.engine import Engine
from playground.studio.picture import shown_picture
from playground.studio.session import Session

from ..sketch_texts import TERRAIN_IN_3D

SIZE = (64, 36)
TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "3")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return previous(texel) * EDIT + level * float(texel.x) / float(size.x); }
"""


def resident() -> int:
    """Return this process's memory in bytes."""
    if not sys.platform.startswith("linux"):
        pytest.skip("reads /proc")
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.slow
def test_memory_is_flat_over_five_hundred_reloads(
    tmp_path: Path, ctx: moderngl.Context, alive: Counter[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each with another text, every tenth with a mistake, values set by the user between.

    When a picture is drawn in full, with a mesh of its own, is told, and does not depend on the clock.
    """
    monkeypatch.setattr(shown_picture, "REST", math.inf)
    (tmp_path / "sketch.toml").write_text(TERRAIN_IN_3D, encoding="utf-8")
    seen = []
    before = dict(+alive)
    with Engine(ctx) as engine:
        session = None
        for number in range(500):
            edit = "wrong" if number % 10 == 9 else f"0.{number + 1000}"
            (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("EDIT", edit), encoding="utf-8")
            if session is None:
                session = Session(engine, tmp_path)
            else:
                session.drafts.reload()
            session.frame(SIZE)
            assert (session.error is not None) == (edit == "wrong")
            session.drafts.set("height.level", number % 7 / 7)
            session.frame(SIZE)
            if number % 10 == 0:
                session.read()
            if number in (199, 499):
                gc.collect()
                seen.append((dict(+alive), resident()))
        assert session is not None
        session.release()
    (objects, memory), (later, grown) = seen
    assert later == objects
    assert grown - memory < 12 * 2**20, "300 programs that stayed would take several times that"
    gc.collect()
    assert dict(+alive) == before
