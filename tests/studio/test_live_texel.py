"""What a window tells editors of the texel that it traces: the same trace can be made of it."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from playground.engine.trace.live_texel import live_file, read_live_texel
from playground.engine.trace.model import first_difference
from playground.studio.trace.live import LiveTexelFile
from playground.studio.trace.tracing import Tracing

from ..sketch_texts import map_of_height
from .session_desk import OpenSession

TERRAIN = """// terrain.glsl -- steps
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) {
    float x = float(texel.x + size.x) * level;
    return x + float(texel.y);
}
"""
PICTURE = 90, 60


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(TERRAIN)
    (tmp_path / "sketch.toml").write_text("format = 1\nsize = [9, 6]\n" + map_of_height())
    return tmp_path


def test_the_traced_texel_is_written_for_editors(folder: Path, open_session: OpenSession) -> None:
    session = open_session(folder)
    session.frame(PICTURE)
    session.drafts.set("height.level", 0.25)
    session.frame(PICTURE)
    session.show("height:height")
    tracing = Tracing(session, now=lambda: 0.0)
    times = iter(range(100))
    file = live_file(folder / "state")
    live = LiveTexelFile(tracing, file, lambda: float(next(times)))
    live.update()
    assert not file.exists() and live.patience == math.inf
    tracing.toggle()
    for _ in range(3):
        session.frame(PICTURE)
        session.picture.rest = 0.0
        tracing.point((40, 30))
        tracing.update(session.picture.texture)
    assert tracing.view is not None and live.patience == 0.0
    live.update()
    written = read_live_texel(file)
    assert written is not None and live.patience == math.inf
    other = session.engine.trace(
        written.sketch,
        written.path,
        texel=written.texel,
        size=written.size or (1, 1),
        time=written.time,
        values=dict(written.values),
    )
    assert first_difference(tracing.view.trace, other) is None
    assert ("height.level", 0.25) in written.values
    tracing.toggle()
    live.update()
    assert not file.exists()
