"""Another tool's shader in a terrain: as heights, as colours, and as a filter of the frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.shader.parameter import srgb_to_linear
from playground.sketch.assign import value_of, values_of
from playground.sketch.replace_technique import choices, with_technique, with_texts
from playground.sketch.save import save, save_copy

from ..loading import load
from ..sketch_texts import map_of, passes

# Differences between neighbours are far below 1/255, and below a half float's steps as well.
FINE = """// Heights as fine as floats.
uniform float rise; // 0..1
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    float x = floor(fragCoord.x) + iResolution.x * floor(fragCoord.y);
    fragColor = vec4(0.5 + x / 65536.0 + rise, 2.0 * fragCoord.x / iResolution.x, iResolution.y / 64.0, 1.0);
}
"""
INVERT = """// The negative of a picture.
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    fragColor = 1.0 - texelFetch(iChannel0, ivec2(fragCoord), 0);
}
"""
OWN = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x) / float(size.x); }
"""
PLAIN = """#version 330
uniform vec2 u_resolution;
out vec4 picture;
void main() { picture = vec4(gl_FragCoord.xy / u_resolution, 0.25, 1.0); }
"""
BROKEN = "void mainImage(out vec4 fragColor, in vec2 fragCoord) { fragColor = missing; }\n"
FILES = {"fine.frag": FINE, "invert.frag": INVERT, "own.glsl": OWN, "plain.glsl": PLAIN}
SIZE = (33, 21)
HEAD = f"format = 1\nsize = [{SIZE[0]}, {SIZE[1]}]\nextent = [320.0, 200.0]\nrelief = 100.0\n"
SKETCH = HEAD + passes(height="./own", colour="texturing/height_colour") + map_of("colour")
PLACED = SKETCH.replace("./own", "foreign/height(./fine)")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    (tmp_path / "placed.toml").write_text(PLACED)
    return tmp_path


def test_heights_keep_more_than_eight_bits_and_the_size_is_the_pass_s(
    folder: Path, any_engine: Engine
) -> None:
    found = any_engine.read(load(folder / "placed.toml"), "height")
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    np.testing.assert_allclose(found, 0.5 + (x + SIZE[0] * y) / 65536.0, rtol=0, atol=2**-23)


@pytest.mark.parametrize(
    ("channel", "wanted"),
    [("green", 2.0 * 5.5 / SIZE[0]), ("blue", SIZE[1] / 64.0), ("alpha", 1.0)],
)
def test_a_channel_may_be_chosen(folder: Path, any_engine: Engine, channel: str, wanted: float) -> None:
    sketch = load(folder / "placed.toml").with_values({"height.channel": channel})
    assert any_engine.read(sketch, "height")[3, 5] == pytest.approx(wanted, abs=1e-6)


def test_the_text_s_own_uniform_is_a_parameter_of_the_pass(folder: Path, any_engine: Engine) -> None:
    sketch = load(folder / "placed.toml")
    assert value_of(sketch, "height.rise", values_of(sketch)) == 0.0
    sketch = sketch.with_values({"height.rise": 0.25, "height.gain": 2.0, "height.offset": -0.5})
    assert any_engine.read(sketch, "height")[0, 0] == pytest.approx(2.0 * 0.75 - 0.5)


def test_colours_become_linear_light(folder: Path, any_engine: Engine) -> None:
    (folder / "c.toml").write_text(SKETCH.replace("texturing/height_colour", "foreign/colour(./plain)"))
    found = any_engine.read(load(folder / "c.toml"), "colour")
    x, y = np.meshgrid((np.arange(SIZE[0]) + 0.5) / SIZE[0], (np.arange(SIZE[1]) + 0.5) / SIZE[1])
    wanted = srgb_to_linear(np.stack([x, y, np.full_like(x, 0.25)], axis=-1))
    np.testing.assert_allclose(found[..., :3], wanted, rtol=2**-10, atol=1e-6)  # half floats


def test_a_filter_is_laid_over_the_frame(folder: Path, any_engine: Engine) -> None:
    sketch = load(folder)
    filtered = with_technique(sketch, "view", "./invert(view/map)").with_values({"view.channel": "red"})
    plain = any_engine.render(sketch.with_values({"view.channel": "red"}), size=(64, 40)).array
    found = any_engine.render(filtered, size=(64, 40)).array
    assert len(np.unique(plain[..., :3])) > 9
    np.testing.assert_array_equal(found[..., :3], 255 - plain[..., :3])


@pytest.mark.slow
def test_other_tools_files_are_in_the_chooser(folder: Path) -> None:
    (folder / "broken.frag").write_text('void mainImage(\n#include "nothing.glsl"\n')
    sketch = load(folder)
    height, colour, view = (choices(sketch, name) for name in ("height", "colour", "view"))
    assert {"foreign/height(./fine)", "foreign/height(./plain)", "foreign/height(./invert)"} <= {*height}
    assert {"foreign/colour(./fine)", "foreign/colour(./plain)"} <= {*colour}
    assert not [use for use in height if "foreign/colour" in use or "./broken" in use or "(./own)" in use]
    assert "./invert(view/map)" in view and "view/map" in view
    assert "./plain(view/map)" not in view and "./fine(view/map)" not in view, "they read no picture"
    assert "./plain" in view, "a whole picture by itself, as before"


ISF = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"},
 {"NAME": "share", "TYPE": "float", "MIN": 0.0, "MAX": 1.0, "DEFAULT": 1.0}]}*/
void main() {
    vec4 c = IMG_THIS_PIXEL(inputImage);
    gl_FragColor = vec4(mix(c.rgb, 1.0 - c.rgb, share), 1.0);
}
"""


@pytest.mark.slow
def test_an_isf_filter_takes_the_frame(folder: Path, any_engine: Engine) -> None:
    (folder / "negative.fs").write_text(ISF)
    sketch = load(folder)
    assert "./negative(view/map)" in choices(sketch, "view")
    filtered = with_technique(sketch, "view", "./negative(view/map)")
    plain = any_engine.render(sketch, size=(64, 40)).array[..., :3]
    np.testing.assert_array_equal(any_engine.render(filtered, size=(64, 40)).array[..., :3], 255 - plain)
    off = any_engine.render(filtered.with_values({"view.share": 0.0}), size=(64, 40)).array[..., :3]
    np.testing.assert_array_equal(off, plain)


def test_an_isf_generator_is_a_terrain(folder: Path, any_engine: Engine) -> None:
    text = "void main() { gl_FragColor = vec4(isf_FragNormCoord.x / 300.0); }\n"
    text = '/*{"ISFVSN": "2", "INPUTS": []}*/\n' + text
    (folder / "slope.fs").write_text(text)
    sketch = load(folder)
    assert "foreign/height(./slope)" in choices(sketch, "height")
    found = any_engine.read(with_technique(sketch, "height", "foreign/height(./slope)"), "height")
    wanted = np.broadcast_to((np.arange(SIZE[0]) + 0.5) / SIZE[0] / 300.0, SIZE[::-1])
    np.testing.assert_allclose(found, wanted, rtol=1e-5)


BUFFERED = """/*{"ISFVSN": "2", "INPUTS": [],
 "PASSES": [{"TARGET": "first", "FLOAT": true}, {}]}*/
void main() {
    if (PASSINDEX == 0) gl_FragColor = vec4(gl_FragCoord.x / 70000.0);
    else gl_FragColor = IMG_THIS_PIXEL(first);
}
"""


def test_several_passes_of_one_file_keep_their_numbers(folder: Path, any_engine: Engine) -> None:
    (folder / "buffered.fs").write_text(BUFFERED)
    sketch = load(folder)
    assert "foreign/height(./buffered)" in choices(sketch, "height")
    found = any_engine.read(with_technique(sketch, "height", "foreign/height(./buffered)"), "height")
    wanted = np.broadcast_to((np.arange(SIZE[0]) + 0.5) / 70000.0, SIZE[::-1])
    np.testing.assert_allclose(found, wanted, rtol=1e-5)


def test_a_text_that_is_typed_takes_the_file_s_place(folder: Path, any_engine: Engine) -> None:
    texts = {str(folder / "fine.frag"): FINE.replace("0.5 + x", "0.25 + x")}
    sketch = with_texts(load(folder / "placed.toml"), texts)
    found = any_engine.read(sketch, "height")
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    np.testing.assert_allclose(found, 0.25 + (x + SIZE[0] * y) / 65536.0, rtol=0, atol=2**-23)


def test_all_files_of_both_parts_are_watched(folder: Path) -> None:
    (folder / "twice.toml").write_text(passes(flat="./plain"))
    (folder / "placed.toml").write_text(SKETCH.replace("./own", "foreign/height(./twice)"))
    names = {Path(file).name for file in load(folder / "placed.toml").files}
    assert {"twice.toml", "plain.glsl", "height.glsl"} <= names


def test_a_filter_is_replaced_and_taken_off_again(folder: Path) -> None:
    (folder / "soft.frag").write_text(INVERT.replace("1.0 -", "0.5 *"))
    sketch = with_technique(load(folder), "view", "./invert(view/map)")
    view = choices(sketch, "view")
    assert {"./soft(view/map)", "view/map", "./invert(view/map)"} <= {*view}
    assert not [use for use in view if use.count("(") > 1]
    assert with_technique(sketch, "view", "view/map").graph == load(folder).graph


def test_a_choice_is_saved_as_a_person_would_write_it(folder: Path, any_engine: Engine) -> None:
    file = load(folder)
    wanted = with_technique(file, "height", "foreign/height(./fine)")
    wanted = with_technique(wanted, "view", "./invert(view/map)").with_values({"height.gain": 1.5})
    save(file, wanted)
    text = (folder / "sketch.toml").read_text()
    assert 'use = "foreign/height(./fine)"' in text
    assert 'use = "./invert(view/map)"' in text
    again = load(folder)
    assert value_of(again, "height.gain", values_of(again)) == 1.5
    one, other = (any_engine.render(s, size=(48, 32)).array for s in (wanted, again))
    np.testing.assert_array_equal(one, other)


def test_a_copy_takes_the_files_along(folder: Path, tmp_path: Path) -> None:
    away = tmp_path / "away"
    away.mkdir()
    file = load(folder)
    copied = save_copy(file, with_technique(file, "height", "foreign/height(./fine)"), away)
    assert (copied.parent / "fine.frag").read_text() == FINE
    assert load(copied).graph.passes[0].use == "foreign/height(./fine)"


@pytest.mark.parametrize(
    ("use", "message"),
    [
        ("foreign/height(./fin)", r"there is no technique './fin'.*did you mean './fine'"),
        ("foreign/heigth(./fine)", r"there is no technique 'foreign/heigth'.*did you mean 'foreign/height'"),
        ("./own(./fine)", r"./own reads no picture; it has no input"),
        ("foreign/height(../fine)", r"there is no technique '../fine'|lies outside"),
    ],
)
def test_what_cannot_be_composed_is_told(folder: Path, use: str, message: str) -> None:
    (folder / "sketch.toml").write_text(SKETCH.replace("./own", use))
    with pytest.raises(PlaygroundError, match=message):
        load(folder)


def test_a_mistake_is_told_at_the_text_s_own_line(folder: Path, any_engine: Engine) -> None:
    (folder / "fine.frag").write_text("// one\n" + BROKEN)
    with pytest.raises(PlaygroundError) as caught:
        any_engine.render(load(folder / "placed.toml"), size=(32, 20))
    assert caught.value.diagnostics[0].file.endswith("fine.frag")
    assert caught.value.diagnostics[0].line == 2
