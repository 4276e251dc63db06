"""Plain shaders and other tools' have the engine's bits in a page on the same renderer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundWarning
from playground.paths import SKETCHES
from playground.publish.web.page_data import page_data

from ...foreign_cases import EVERY, Case
from ...loading import load
from .pages import PageError, Pages

SIZE = (96, 54)
TIME = 0.4
SHIPPED = ("channels", "film_terrain", "flood", "fluid", "from_elsewhere", "life", "reaction_diffusion")
ALONE = ("nearest_stone.frag", "tiles.frag")
EVERYDAY = {
    "main inputs",
    "main pack_420",
    "main bonzomatic_previous",
    "isf with_vertex",
    "shadertoy cube",
}

pytestmark = [
    pytest.mark.filterwarnings(f"ignore::{PlaygroundWarning.__module__}.{PlaygroundWarning.__name__}"),
    pytest.mark.room("dialects"),
]


def params() -> list[Any]:
    return [
        pytest.param(case, id=str(case), marks=[] if str(case) in EVERYDAY else [pytest.mark.slow])
        for case in EVERY
    ]


def agree(pages: Pages, drawn: Engine, sketch: Any, *times: float, size: tuple[int, int] = SIZE) -> None:
    data = page_data([sketch], frame=size, time=times[0])
    pages.begin(data)
    pages.open(data["sketches"][0])
    for time in times:
        picture = pages.picture(sketch.name, time=time)
        assert picture.levels_off(drawn.render(sketch, size=size, time=time).array) == 0
        assert len(np.unique(picture.pixels)) > 2
    pages.run("figures[arguments[0]].close()", sketch.name)


@pytest.mark.slow
@pytest.mark.parametrize("case", params())
def test_another_tools_shader_is_drawn_with_the_engines_bits(
    pages: Pages, drawn: Engine, tmp_path: Path, case: Case
):
    agree(pages, drawn, load(case.write(tmp_path)), TIME)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_sketch_with_foreign_passes_matches_engine_bits(pages: Pages, drawn: Engine, name: str):
    agree(pages, drawn, load(name), TIME)


@pytest.mark.parametrize("name", ALONE)
def test_a_plain_shader_alone_has_the_engines_bits(pages: Pages, drawn: Engine, name: str):
    agree(pages, drawn, load(SKETCHES / name), TIME, 2.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["life", "fluid", "reaction_diffusion", "channels", "film_terrain"])
def test_a_state_or_a_film_goes_on_with_the_time_and_back(pages: Pages, drawn: Engine, name: str):
    agree(pages, drawn, load(name), 0.1, 0.5, 0.2, 13 / 60)


POINTER = """void mainImage(out vec4 c, in vec2 p) {
    c = vec4(iMouse.xy / iResolution.xy, iMouse.z > 0.0 ? 1.0 : 0.25, iDate.w / 86400.0);
}
"""


def test_the_pointer_and_the_date_are_what_the_page_says(pages: Pages, drawn: Engine, tmp_path: Path):
    (tmp_path / "pointer.frag").write_text(POINTER, "utf-8")
    sketch = load(tmp_path / "pointer.frag")
    agree(pages, drawn, sketch, 0.0)
    drawn.runner.drag = (24.0, 36.0, 24.0, -36.0)
    drawn.runner.date = (2024.0, 1.0, 29.0, 43_200.0)
    try:
        expected = drawn.render(sketch, size=SIZE).array
    finally:
        drawn.runner.drag, drawn.runner.date = (0.0, 0.0, 0.0, 0.0), (1970.0, 0.0, 1.0, 0.0)
    data = page_data([sketch], frame=SIZE)
    pages.begin(data)
    pages.open(data["sketches"][0])
    still = pages.picture(sketch.name)
    live = {"drag": [24, 36, 24, -36], "date": [2024, 1, 29, 43_200]}
    moved = pages.picture(sketch.name, live=live)
    assert moved.levels_off(expected) == 0
    assert moved.levels_off(still.pixels) > 50
    assert moved.ran and pages.picture(sketch.name, live=live).ran == []


SIDES = """#pragma kernel(output = "sides:rgba8")
vec4 kernel(ivec2 texel) { return vec4(vec2(texel) / vec2(size), 0.5, 1.0); }
"""
CUBE = """uniform samplerCube sides;
void main() { gl_FragColor = texture(sides, vec3(gl_FragCoord.xy / 40.0 - 1.0, 1.0)); }
"""
INTO_CUBE = """format = 1
size = [8, 48]
[[pass]]
name = "sides"
use = "./sides"
[view]
use = "./cube"
"""


def test_a_terrain_that_cannot_be_a_cube_is_one_sentence(pages: Pages, drawn: Engine, tmp_path: Path):
    (tmp_path / "sides.glsl").write_text(SIDES, "utf-8")
    (tmp_path / "cube.frag").write_text(CUBE, "utf-8")
    (tmp_path / "sketch.toml").write_text(INTO_CUBE, "utf-8")
    sketch = load(tmp_path / "sketch.toml")
    pages.begin(data := page_data([sketch], frame=SIZE))
    pages.open(data["sketches"][0])
    terrain = data["sketches"][0]["terrain"]
    larger = drawn.render(sketch.with_values({"size": "16x96"}), size=SIZE).array
    assert pages.picture(sketch.name, terrain={**terrain, "size": [16, 96]}).levels_off(larger) == 0
    why = "sides reads 8 x 32 texels; a cube map is six faces above each other, 1 : 6, as 8 x 48"
    with pytest.raises(PageError, match=why):
        pages.picture(sketch.name, terrain={**terrain, "size": [8, 32]})


EYES = "#version 330\nuniform vec2 eye; out vec4 colour;\nvoid main() { colour = vec4(eye, 0.5, 1.0); }\n"


@pytest.mark.slow
def test_only_a_picture_that_the_camera_changes_is_steered(pages: Pages, tmp_path: Path):
    """A kernel that names what the engine gives of a camera; a plain shader may call anything `eye`."""
    (tmp_path / "eyes.frag").write_text(EYES, "utf-8")
    land = load("white_noise").with_values({"size": "33"})
    pages.begin(data := page_data([land, load("life"), load(tmp_path / "eyes.frag")], frame=SIZE))
    result = []
    for item in data["sketches"]:
        pages.open(item)
        pages.picture(item["name"])
        result.append(pages.run("return figures[arguments[0]].looks", item["name"]))
    assert result == [True, False, False]
    pages.picture(land.name, map={"path": "height", "output": "height", "values": {}})
    assert not pages.run("return figures[arguments[0]].looks", land.name)
