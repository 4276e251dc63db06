"""A page shows of a film and of a sound what the engine shows, at any time, set to play in any way."""

from __future__ import annotations

import base64
import gzip
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.data.live_inputs import LiveInputs, Now
from playground.engine.sources import source_kind
from playground.publish.web import sources
from playground.publish.web.page_data import page_data
from playground.sketch.model import Sketch
from tests.data.films import sound, uneven_film

from ...loading import load
from .node import Node

SKETCH = """format = 1
[[pass]]
name = "a"
use  = "foreign/{0}"
set  = {{ {0} = "{1}", loop = {2} }}
[view]
use = "./shown"
"""
SHOWN = """#pragma kernel(output = "colour:rgba8")
uniform sampler2D a;  //! input
vec4 kernel(ivec2 texel) { return texelFetch(a, ivec2(0), 0); }
"""


def made(folder: Path, kind: str, file: str, loop: bool) -> Sketch:
    (folder / "shown.glsl").write_text(SHOWN)
    path = folder / "s.toml"
    path.write_text(SKETCH.format(kind, file, str(loop).lower()))
    return load(path)


def bytes_of(page: dict[str, Any], key: str) -> bytes:
    return gzip.decompress(base64.b64decode(page["shared"]["blobs"][key]))


def leaf(page: dict[str, Any]) -> dict[str, Any]:
    return next(node for node in page["sketches"][0]["nodes"] if node["path"] == "a")


@pytest.mark.parametrize("loop", [True, False])
@pytest.mark.parametrize(("kind", "samples"), [("video", 0), ("sound", 44_100), ("sound", 11_025)])
def test_every_moment_shows_the_engines_texels(
    node: Node, tmp_path: Path, kind: str, samples: int, loop: bool
):
    """A sound that repeats hears its end in the next lap; a short one, several laps before."""
    if kind == "video":
        uneven_film(tmp_path / "f.mkv", [0, 40, 50, 120, 500, 510, 900])
        sketch = made(tmp_path, kind, "f.mkv", loop)
    else:
        sound(tmp_path / "f.wav", np.sin(np.arange(samples)[None] / 30) * 0.4)
        sketch = made(tmp_path, kind, "f.wav", loop)
    page = page_data([sketch])
    [texture] = leaf(page)["data"]
    assert leaf(page)["clock"]["start"] == "a.start"
    chance = random.Random(kind)
    technique = sketch.graph.passes[0].technique
    registered = source_kind(f"{kind}_file")
    values = {p.name: p.default for p in technique.parameters}
    values |= {kind: str(tmp_path / f"f.{'mkv' if kind == 'video' else 'wav'}"), "loop": loop}
    assert registered.moment
    for turn in range(60):  # a page may set it to repeat, or no longer
        repeats = loop if turn % 3 else not loop
        playing: dict[str, Any] = {"start": chance.randint(-30, 60) / 60, "loop": repeats}
        if kind == "video":
            playing["speed"] = chance.choice([1.0, -1.0, 2.0, 0.5])
        time = chance.randint(0, 300) / 60
        result = node.call("player.js", "blobAt", texture, playing, time)
        moment = registered.moment(values | playing, Now(time, LiveInputs()))
        [texels] = registered.make(values | playing, tuple(texture["size"]), moment).values()
        assert bytes_of(page, result) == texels.tobytes(), (playing, time)


def test_a_long_film_is_cut_and_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    uneven_film(tmp_path / "f.mkv", [0, 40, 50, 120, 500, 510, 900])
    monkeypatch.setattr(sources, "MAX_SECONDS", 0.3)
    page = page_data([made(tmp_path, "video", "f.mkv", False)])
    [texture] = leaf(page)["data"]
    assert texture["times"] == pytest.approx([0, 0.04, 0.05, 0.12])
    assert any("has the first 0.5 s" in note for note in page["sketches"][0]["notes"])


def test_playback_parameters_are_editable_and_others_locked(tmp_path: Path):
    uneven_film(tmp_path / "f.mkv", [0, 40])
    page = page_data([made(tmp_path, "video", "f.mkv", False)])
    locked = {row["path"]: row["locked"] for row in page["sketches"][0]["shown"]}
    assert {path for path, why in locked.items() if why} == {"a.video"}
    assert locked["a.video"] == "The film was made when the page was exported."
