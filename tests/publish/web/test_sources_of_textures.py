"""What a source with inputs makes is drawn once, by the engine that an export holds."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.publish.export import prepare, run
from playground.publish.export_formats import ExportOptions
from playground.sketch.model import Sketch

from ...loading import load
from ...sketch_texts import map_of, passes

BASE = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float((texel.x * 7 + texel.y * 5) % 11) / 11.0; }
"""
OTHER = """#pragma kernel(output = "height:r32f")
uniform sampler2D base;  //! input
float kernel(ivec2 texel) { return texelFetch(base, texel, 0).r; }
"""


@pytest.fixture
def sketch(tmp_path: Path) -> Sketch:
    """Return a sketch with a source that is made of a texture, and a pass with two techniques after it."""
    (tmp_path / "base.glsl").write_text(BASE)
    for name in ("one", "two"):
        (tmp_path / f"{name}.glsl").write_text(OTHER)
    text = passes(
        base=("./base",),
        noise=("generation/by_example", 'inputs = { example = "base" }'),
        height=("./one", 'inputs = { base = "noise" }'),
    )
    (tmp_path / "sketch.toml").write_text("format = 1\nsize = 17\n" + text + map_of("height"))
    return load(tmp_path)


def test_the_engine_of_an_export_makes_a_source_once(
    engine: Engine, sketch: Sketch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Neither another technique nor the poster makes it again."""
    monkeypatch.setattr("playground.publish.web_page.read_bundle", lambda name: f"/* {name} */")
    engine.runs.clear()
    job = prepare(engine, sketch, tmp_path / "a.html", ExportOptions(techniques={"height": ("./two",)}))
    assert job.page is not None and len(job.page.data["sketches"]) == 2
    [source] = {n["path"] for item in job.page.data["sketches"] for n in item["nodes"] if n.get("data")}
    assert engine.runs[source] == 1
    run(engine, job)
    assert engine.runs[source] == 1
