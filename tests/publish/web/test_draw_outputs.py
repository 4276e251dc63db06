"""A page draws several outputs at once, and as many instances as a texture says, as the engine does."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data

from ...loading import load
from ...sketch_texts import map_of, passes
from .pages import PageError, Pages

pytestmark = pytest.mark.slow


SIZE = (96, 64)
DOTS = """#pragma draw(mesh = "sheet", instances = "min(list.x, most)", \\
               output = "seen:rgba32f, more:rg16f")
uniform sampler2D list;     //! input
uniform int most = 20;      //! slider(0, 20)
uniform float depth = 0.0;  //! slider(-1, 1)
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy + vec2(gl_InstanceID);
    return vec4((corner.xy * 1.7 + vec2(gl_InstanceID)) / 6.0 - 1.0, depth, 1.0);
}
void fragment(vec2 place, out vec4 seen, out vec4 more) {
    seen = vec4(0.1 * place, 1.0 - 0.5 * depth, 1.0);
    more = vec4(place.yx / 9.0 * (1.0 - depth), 0.0, 0.0);
}
"""
LIST = """#pragma kernel(output = "list:r32f, seen:rgba32f, more:rg16f")
uniform float many = 5.0;  //! slider(-1, 20)
void kernel(ivec2 texel, out float list, out vec4 seen, out vec2 more) {
    list = many + float(texel.x);
    seen = vec4(0.3, 0.2, 0.9, 1.0);
    more = vec2(0.25, 0.75);
}
"""


@pytest.mark.parametrize("samples", [1, 4])
def test_outputs_instances_and_what_goes_on_are_the_engines(
    pages: Pages, drawn: Engine, tmp_path: Path, samples: int
):
    (tmp_path / "dots.glsl").write_text(DOTS, "utf-8")
    (tmp_path / "list.glsl").write_text(LIST, "utf-8")
    both = 'inputs = {{ list = "list:list", initial = "{}" }}'
    body = passes(
        list=("./list", "size = [96, 64]"),
        one=("./dots", both.format("list:seen"), "size = [96, 64]"),
        two=("./dots", both.format("one:seen"), "size = [96, 64]", "set = { depth = 0.5, most = 3 }"),
    )
    sketches = []
    for shown in ("seen", "more"):
        file = tmp_path / f"{shown}.toml"
        view = map_of(f"two:{shown}").replace("[view]\n", f"[view]\nsamples = {samples}\n")
        file.write_text(f"format = 1\nsize = 33\n{body}{view}", "utf-8")
        sketches.append(load(file))
    drawn.cache.clear()
    data = page_data(sketches, frame=SIZE)
    pages.begin(data)
    for item in data["sketches"]:
        pages.open(item)
    for sketch in sketches:
        for many in (5.0, 2.0, 0.0, 7.0):
            changes = {"list.many": many}
            frame = drawn.render(sketch.with_values(changes), size=SIZE)
            picture = pages.picture(sketch.name, values=changes)
            assert picture.levels_off(frame.array) == 0, (sketch.name, many)
            assert picture.ran == drawn.record.ran
    with pytest.raises(PageError, match="instances = -1"):
        pages.picture(sketch.name, values={"list.many": -1.0})


ROW = """#pragma draw(mesh = "triangles", count = "list.size.x // 2 + more.size.y", output = "frame:rgba8")
uniform sampler2D list;  //! input
uniform sampler2D more;  //! input("zero")
vec4 vertex(vec3 corner) {
    vec2 place = vec2(corner.x + mod(corner.y, 2.0), corner.y);
    return vec4(place / 16.0 - 1.0, 0.0, 1.0);
}
vec4 fragment() { return vec4(1.0, 0.5, 0.0, 1.0); }
"""


def test_a_draw_has_as_many_triangles_as_an_input_s_size_says(pages: Pages, drawn: Engine, tmp_path: Path):
    (tmp_path / "row.glsl").write_text(ROW, "utf-8")
    (tmp_path / "list.glsl").write_text(LIST, "utf-8")
    sketches = []
    for wide in (12, 40):
        body = passes(
            list=("./list", f"size = [{wide}, 2]"), row=("./row", 'inputs = { list = "list:list" }')
        )
        file = tmp_path / f"wide{wide}.toml"
        file.write_text(f"format = 1\nsize = 33\n{body}{map_of('row')}", "utf-8")
        sketches.append(load(file))
    drawn.cache.clear()
    data = page_data(sketches, frame=SIZE)
    pages.begin(data)
    lit = []
    for item, sketch in zip(data["sketches"], sketches, strict=True):
        pages.open(item)
        frame = drawn.render(sketch, size=SIZE)
        assert pages.picture(sketch.name).levels_off(frame.array) == 0
        lit.append((drawn.read(sketch, "row", size=SIZE)[..., 0] > 0).any(0).sum())
    assert lit[1] > 2 * lit[0] > 0
