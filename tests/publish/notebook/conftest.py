"""A small sketch, and widgets that are drawn by the tests' own engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.publish.notebook import widget as widgets

KERNEL = """// slope.glsl -- ground that rises to the north-east.
#pragma kernel(output = "height:r32f")
uniform float rise = 0.5;   //! slider(0, 1) How high that corner is
uniform vec2 far = vec2(0.25, 0.75);   //! slider(0, 1) Nothing that is seen
float kernel(ivec2 texel) { return rise * float(texel.x * texel.y) / 1024.0 + 0.0 * far.x; }
"""
SKETCH = """format = 1
title = "Slope"
size = [33, 33]
extent = [320, 320]
relief = 100
main = ["height.rise"]
[[pass]]
name = "height"
use = "./slope"
[view]
use = "view/terrain"
"""


@pytest.fixture
def slope(tmp_path: Path) -> Path:
    """Give the file of a sketch of one kernel."""
    (tmp_path / "slope.glsl").write_text(KERNEL, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path / "sketch.toml"


@pytest.fixture
def engine(any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[Engine]:
    """Give one engine, which draws the widgets as well; all are closed at the end."""
    on_engine: Callable[[Callable[[Engine], object]], object] = lambda work: work(any_engine)  # noqa: E731
    monkeypatch.setattr(widgets, "on_engine", on_engine)
    monkeypatch.setattr(widgets, "release_engine", lambda: None)
    yield any_engine
    for widget in list(widgets.open_widgets):
        widget.close()
