"""What ISF's inputs, passes and files beside it become, more than a case can say."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.errors import ShaderError
from playground.verify.reduce.case import copied, inline_sketch

from ..foreign_cases import CASES, photo
from ..loading import load
from .drawing import SIZE, colours, drawn, first_texel, kernels, shader_of

ISF = CASES["isf"]


@pytest.fixture
def isf(folder):
    """Write a case, or a text, and give its path."""

    def written(case, name="shader.fs"):
        return ISF[case].write(folder.path) if case in ISF else folder.write(name, case)

    return written


def text_of(name):
    return ISF[name].files[f"{name}.fs"]


def test_values_of_inputs(any_engine, isf):
    path = isf("inputs")
    assert {p.name: p.title for p in shader_of(path).parameters}["level"] == "Level of red"
    values = {"view.on": False, "view.level": 0.25}
    off = first_texel(any_engine, path, size=SIZE, **values, **{"view.mode": "nine"})
    np.testing.assert_allclose(off[:3], 255 * 0.25 * 9 / 4, atol=1)
    any_engine.runner.pressed = frozenset({"view.go"})
    pressed = first_texel(any_engine, path, size=SIZE, **values)
    any_engine.runner.pressed = frozenset()
    np.testing.assert_allclose(pressed[:3], 255 * 0.75, atol=1)


def test_menus_of_every_form(isf):
    result = {p.name: p for p in shader_of(isf("long_alone")).parameters}
    assert (result["a"].widget.choices, result["a"].default) == (("zero", "one"), 1)
    assert (result["b"].widget.values, result["b"].default) == ((2, 2, 7), 0)
    assert len(set(result["b"].widget.choices)) == 3
    assert (result["c"].widget.kind, result["c"].default) == ("number", 0)


def test_places_in_pixels_without_a_range_are_kept(isf):
    (result,) = shader_of(isf("pixels_1")).parameters
    assert (result.default, result.widget.axes) == ((16.0, 9.0), ((0.0, 16.0), (0.0, 9.0)))


def test_a_size_follows_an_input(any_engine, isf):
    plan = any_engine.plan(load(isf("passes")).with_values({"view.blurAmount": 5.0}), (64, 36))
    assert [step.size for step in plan.walk() if step.path == "view.across"] == [(12, 36)]


def test_cells_live_and_die_as_numpy_s_do(any_engine, isf):
    def frame(number):
        return drawn(any_engine, isf("game"), (number - 1) / 60, size=(64, 36))[::2, ::2, 0] > 127

    cells = frame(1)
    assert 0.2 < cells.mean() < 0.6
    for number in (2, 3, 4):
        edge = np.pad(cells, 1, mode="edge").astype(int)  # texels beyond the edge are those at the edge
        around = sum(np.roll(np.roll(edge, y, 0), x, 1) for y in (-1, 0, 1) for x in (-1, 0, 1))[1:-1, 1:-1]
        around = around - cells
        cells = (around == 3) | ((around == 2) & cells)
        np.testing.assert_array_equal(frame(number), cells)


# ── files beside it ──────────────────────────────────────────────────────────


def test_a_vertex_file_is_followed_and_one_that_comes_is_read(any_engine, isf, folder):
    path, vertex = isf(text_of("with_vertex_1")), ISF["with_vertex_1"].files["with_vertex_1.vs"]
    without = drawn(any_engine, path)
    assert str(folder.write("shader.vs", vertex)) in load(path).files
    turned = drawn(any_engine, path)
    assert not np.array_equal(without, turned)
    folder.write("shader.vs", vertex.replace("cos(turn)", "cos(turn * 2.0)"))
    assert not np.array_equal(turned, drawn(any_engine, path))
    assert not np.array_equal(turned, drawn(any_engine, path, **{"view.turn": 1.0}))


def test_a_name_with_blanks_has_its_vertex_shader(any_engine, isf, folder):
    folder.write("Edge of it.vs", ISF["with_vertex"].files["with_vertex.vs"])
    path = isf(text_of("with_vertex"), "Edge of it.fs")
    assert kernels(path)[0].vertex_source is not None and colours(drawn(any_engine, path)) > 1


def test_an_imported_image_is_as_in_its_file(any_engine, isf):
    np.testing.assert_allclose(drawn(any_engine, isf("imported_1"), size=(8, 6)), photo(5), atol=1)
    missing = isf(text_of("imported_1").replace("photo.png", "gone.png"))
    assert colours(drawn(any_engine, missing)) > 1
    (kernel,) = kernels(missing)
    assert kernel.unfed == (("photo", "there is no file './gone.png', so a stand-in is drawn"),)
    outside = isf(text_of("imported_1").replace("./photo.png", "../../x.png"))
    assert "lies outside the sketch's folder" in kernels(outside)[0].unfed[0][1]


SIX = ["right", "left", "top", "bottom", "front", "back"]
CUBE = """/*{{"ISFVSN": "1", "INPUTS": [], "IMPORTED": [{{"NAME": "around", "TYPE": "cube", "PATH": {}}}]}}*/
uniform vec3 towards;  //! Which way
void main() {{ gl_FragColor = textureCube(around, towards); }}
"""


def test_a_cube_of_six_images(any_engine, isf, folder):
    (folder.path / "faces").mkdir()
    for number, name in enumerate(SIX):
        face = np.full((4, 4, 4), 255, np.uint8)
        face[..., 0] = 40 * number
        write_png(folder.path / "faces" / f"{name}.png", face)
    paths = [f"faces/{name}.png" for name in SIX]
    path = isf(CUBE.format(str(paths).replace("'", '"')))
    ways = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    result = [first_texel(any_engine, path, **{"view.towards": way})[0] for way in ways]
    np.testing.assert_allclose(result, [0, 40, 80, 120, 160, 200], atol=1)
    missing = isf(CUBE.format(str([*paths[:5], "faces/x.png"]).replace("'", '"')))
    assert kernels(missing)[0].unfed[0][1] == "there is no file 'faces/x.png', so a sky stands in"


# ── reduced ──────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", ["inputs", "passes", "persistent", "with_vertex", "tabs"])
def test_what_is_reduced_fails_in_the_same_way(any_engine, folder, name):
    wrong, _ = ISF[name].with_mistake()
    path = wrong.write(folder.path)
    path.with_suffix(".vs").write_text(
        wrong.files.get(f"{name}.vs", "void main() { isf_vertShaderInit(); }\n"), encoding="utf-8"
    )
    case = inline_sketch(load(path), frame=(8, 8))
    assert case.passes[0].text.count("not_declared") == 1
    result = {path: folder.write(f"small/{path}", written) for path, written in case.texts().items()}
    assert sorted(result) == ["shader.frag", "shader.vs"]
    with pytest.raises(ShaderError, match="not_declared"):
        any_engine.render(load(result["shader.frag"]), size=(8, 8))


def test_images_go_with_what_is_reduced(isf, folder):
    case = inline_sketch(load(isf("imported")), frame=(8, 8))
    assert copied(case.files, case.texts()) == [("photo.png", folder.path / "photo.png")]
