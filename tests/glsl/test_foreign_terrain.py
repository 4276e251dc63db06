"""Another tool's shader in a terrain: as heights, as colours, and as a filter of the frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.shader.colours import srgb_to_linear
from playground.sketch.assign import value_of, values_of
from playground.sketch.flatten import flatten
from playground.sketch.replace_technique import choices, with_technique, with_texts

from ..loading import load
from ..sketch_texts import map_of, passes

pytestmark = pytest.mark.room("dialects")

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
PLACED = HEAD + passes(picture="./fine", height="foreign/height") + map_of("height")
FRAME = ("view/map", 'size = "view.size"', 'inputs = { shown = "height" }', 'set = { channel = "red" }')
LAID_OVER = '[view]\nuse = "./invert"\ninputs = { iChannel0 = "frame" }\n'
FILTERED = HEAD + passes(height="./own", frame=FRAME) + LAID_OVER


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    (tmp_path / "placed.toml").write_text(PLACED)
    return tmp_path


def test_foreign_heights_keep_over_8_bits_at_pass_size(folder: Path, any_engine: Engine) -> None:
    result = any_engine.read(load(folder / "placed.toml"), "height")
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    np.testing.assert_allclose(result, 0.5 + (x + SIZE[0] * y) / 65536.0, rtol=0, atol=2**-23)


@pytest.mark.parametrize(
    ("channel", "expected"),
    [("green", 2.0 * 5.5 / SIZE[0]), ("blue", SIZE[1] / 64.0), ("alpha", 1.0)],
)
def test_a_channel_may_be_chosen(folder: Path, any_engine: Engine, channel: str, expected: float) -> None:
    sketch = load(folder / "placed.toml").with_values({"height.channel": channel})
    assert any_engine.read(sketch, "height")[3, 5] == pytest.approx(expected, abs=1e-6)


def test_the_text_s_own_uniform_is_a_parameter(folder: Path, any_engine: Engine) -> None:
    sketch = load(folder / "placed.toml")
    assert value_of(sketch, "picture.rise", values_of(sketch)) == 0.0
    sketch = sketch.with_values({"picture.rise": 0.25, "height.gain": 2.0, "height.offset": -0.5})
    assert any_engine.read(sketch, "height")[0, 0] == pytest.approx(2.0 * 0.75 - 0.5)


def test_colours_become_linear_light(folder: Path, any_engine: Engine) -> None:
    text = HEAD + passes(picture="./plain", colour="foreign/colour") + map_of("colour")
    (folder / "c.toml").write_text(text)
    result = any_engine.read(load(folder / "c.toml"), "colour")
    x, y = np.meshgrid((np.arange(SIZE[0]) + 0.5) / SIZE[0], (np.arange(SIZE[1]) + 0.5) / SIZE[1])
    expected = srgb_to_linear(np.stack([x, y, np.full_like(x, 0.25)], axis=-1))
    np.testing.assert_allclose(result[..., :3], expected, rtol=2**-10, atol=1e-6)  # half floats


def test_a_filter_is_laid_over_the_frame(folder: Path, any_engine: Engine) -> None:
    plain = HEAD + passes(height="./own") + map_of("height", "red")
    (folder / "plain.toml").write_text(plain)
    (folder / "filtered.toml").write_text(FILTERED)
    plain, result = (
        any_engine.render(load(folder / name), size=(64, 40)).array[..., :3]
        for name in ("plain.toml", "filtered.toml")
    )
    assert len(np.unique(plain)) > 9
    np.testing.assert_array_equal(result, 255 - plain)


ISF = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"},
 {"NAME": "share", "TYPE": "float", "MIN": 0.0, "MAX": 1.0, "DEFAULT": 1.0}]}*/
void main() {
    vec4 c = IMG_THIS_PIXEL(inputImage);
    gl_FragColor = vec4(mix(c.rgb, 1.0 - c.rgb, share), 1.0);
}
"""


def test_an_isf_filter_takes_the_frame(folder: Path, any_engine: Engine) -> None:
    (folder / "negative.fs").write_text(ISF)
    text = FILTERED.replace("./invert", "./negative").replace("iChannel0", "inputImage")
    (folder / "filtered.toml").write_text(text)
    (folder / "plain.toml").write_text(HEAD + passes(height="./own") + map_of("height", "red"))
    filtered = load(folder / "filtered.toml")
    plain = any_engine.render(load(folder / "plain.toml"), size=(64, 40)).array[..., :3]
    np.testing.assert_array_equal(any_engine.render(filtered, size=(64, 40)).array[..., :3], 255 - plain)
    off = any_engine.render(filtered.with_values({"view.share": 0.0}), size=(64, 40)).array[..., :3]
    np.testing.assert_array_equal(off, plain)


def test_an_isf_generator_is_a_terrain(folder: Path, any_engine: Engine) -> None:
    text = "void main() { gl_FragColor = vec4(isf_FragNormCoord.x / 300.0); }\n"
    text = '/*{"ISFVSN": "2", "INPUTS": []}*/\n' + text
    (folder / "slope.fs").write_text(text)
    (folder / "placed.toml").write_text(PLACED.replace("./fine", "./slope"))
    result = any_engine.read(load(folder / "placed.toml"), "height")
    expected = np.broadcast_to((np.arange(SIZE[0]) + 0.5) / SIZE[0] / 300.0, SIZE[::-1])
    np.testing.assert_allclose(result, expected, rtol=1e-5)


BUFFERED = """/*{"ISFVSN": "2", "INPUTS": [],
 "PASSES": [{"TARGET": "first", "FLOAT": true}, {}]}*/
void main() {
    if (PASSINDEX == 0) gl_FragColor = vec4(gl_FragCoord.x / 70000.0);
    else gl_FragColor = IMG_THIS_PIXEL(first);
}
"""


def test_several_passes_of_one_file_keep_their_numbers(folder: Path, any_engine: Engine) -> None:
    (folder / "buffered.fs").write_text(BUFFERED)
    (folder / "placed.toml").write_text(PLACED.replace("./fine", "./buffered"))
    result = any_engine.read(load(folder / "placed.toml"), "height")
    expected = np.broadcast_to((np.arange(SIZE[0]) + 0.5) / 70000.0, SIZE[::-1])
    np.testing.assert_allclose(result, expected, rtol=1e-5)


def test_a_text_that_is_typed_takes_the_file_s_place(folder: Path, any_engine: Engine) -> None:
    texts = {str(folder / "fine.frag"): FINE.replace("0.5 + x", "0.25 + x")}
    sketch = with_texts(load(folder / "placed.toml"), texts)
    result = any_engine.read(sketch, "height")
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    np.testing.assert_allclose(result, 0.25 + (x + SIZE[0] * y) / 65536.0, rtol=0, atol=2**-23)


def test_the_chooser_keeps_what_is_wired(folder: Path, any_engine: Engine) -> None:
    sketch = load(folder / "placed.toml")
    assert {"./fine", "./plain", "./invert"} <= {*choices(sketch, "picture")}
    assert "foreign/height" in choices(sketch, "height")
    result = any_engine.read(with_technique(sketch, "picture", "./plain"), "height")
    np.testing.assert_allclose(result[0], (np.arange(SIZE[0]) + 0.5) / SIZE[0], rtol=1e-6)


def test_a_picture_that_no_kernel_reads_stays_of_bytes(folder: Path) -> None:
    (folder / "filtered.toml").write_text(HEAD + passes(frame="./plain") + LAID_OVER)
    formats = {
        leaf.path: leaf.kernel.outputs[0].format
        for name in ("placed.toml", "filtered.toml")
        for leaf in flatten(load(folder / name)).leaves
    }
    assert formats["picture.view"] == "rgba32f" and formats["frame"] == "rgba8"


def test_a_mistake_is_told_at_the_text_s_own_line(folder: Path, any_engine: Engine) -> None:
    (folder / "fine.frag").write_text("// one\n" + BROKEN)
    with pytest.raises(PlaygroundError) as caught:
        any_engine.render(load(folder / "placed.toml"), size=(32, 20))
    assert caught.value.diagnostics[0].file.endswith("fine.frag")
    assert caught.value.diagnostics[0].line == 2
