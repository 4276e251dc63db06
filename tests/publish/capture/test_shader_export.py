"""Ways out: a sketch's picture, or one texture, as ISF, Shadertoy and GLSL, drawn again and the same."""

from __future__ import annotations

import json
import re
from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from playground.data.image_files import read_image
from playground.engine.engine import Engine
from playground.errors import DataError, PlaygroundError
from playground.publish.export import export

from ...loading import load
from ...sketch_texts import map_of, passes
from .shader_hosts import draw_isf, draw_shadertoy

FRAME = (96, 60)

LAND = """// land.glsl -- hills, and what each widget gives them.
#pragma kernel(output = "height:r32f")
uniform float waves = 3.0;      //! slider(1, 12) step(0.1) How many hills
uniform int steps = 4;          //! slider(1, 9) Terraces
uniform uint seed = 7u;         //! slider(0, 9999) Which
uniform int shape = 1;          //! menu("sine", "square") The form
uniform bool turned = true;     //! checkbox Along the other side
uniform vec2 sun = vec2(135.0, 25.0);  //! direction The light
uniform vec3 tint = vec3(0.2, 0.5, 0.8);  //! colour What is added
uniform vec2 middle = vec2(0.25, 0.5);  //! point Where
uniform vec3 gain = vec3(1.0, 0.5, 0.25);  //! slider(0, 2) One for each
uniform float offset = 0.125;   //! step(0.01) Without a range
uniform float turn = 30.0;      //! angle Which way
float wave(float x) { return shape == 1 ? step(0.0, sin(x)) : sin(x); }
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1) - middle;
    float along = turned ? place.y : place.x;
    float h = 0.25 + 0.1 * wave(waves * 6.2831853 * along + radians(turn)) + 0.1 * offset;
    h += 0.1 * floor(place.x * float(steps)) / float(steps) + 0.01 * float(seed % 16u);
    return h + 0.1 * dot(gain, tint) + 0.1 * towards_sun.z + 0.01 * towards_sun.x + 0.05 * sin(time);
}
"""
SLOPE = """// slope.glsl -- how steep a terrain is.
#pragma kernel(output = "slope:rg16f")
uniform sampler2D height;  //! input
uniform float gain = 40.0;  //! slider(1, 99) How much
float at(sampler2D texels, ivec2 place) { return texelFetch(texels, clamp(place, ivec2(0), size - 1), 0).r; }
vec2 kernel(ivec2 texel) {
    float here = at(height, texel);
    return gain * vec2(at(height, texel + ivec2(1, 0)) - here, at(height, texel + ivec2(0, 1)) - here);
}
"""
SHOWN = """// shown.glsl -- a picture of a slope.
#pragma kernel(output = "frame:rgba8")
uniform sampler2D slope;   //! input("linear", "clamp")
uniform sampler2D extra;   //! input("nearest", "black")
uniform float gain = 0.5;  //! slider(0, 1) How bright
vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    vec2 found = textureLod(slope, place, 0.0).rg * gain + 0.5;
    return vec4(found, wired_extra ? 1.0 : texelFetch(extra, texel, 0).r + 0.25, 1.0);
}
"""
LIFE = """// life.glsl -- a kernel that repeats, and reads the step before.
#pragma kernel(output = "cells:r8", repeat = "3")
float kernel(ivec2 texel) {
    if (iteration == 0) return float((texel.x * 7 + texel.y * 3) % 5 == 0);
    float sum = previous(texel + ivec2(1, 0)) + previous(texel - ivec2(1, 0)) + previous(texel + ivec2(0, 1));
    return 0.4 * sum + 0.11 * float(iteration) / float(iterations);
}
"""
BOTH = """// both.glsl -- two outputs.
#pragma kernel(output = "height:r32f, water:rgba16f")
void kernel(ivec2 texel, out float height, out vec4 water) {
    height = float(texel.x) / float(size.x);
    water = vec4(0.1, float(texel.y) / float(size.y), 0.8, 1.0);
}
"""
FILES = {"land": LAND, "slope": SLOPE, "shown": SHOWN, "life": LIFE, "both": BOTH}
HEAD = "format = 1\nsize = 33\nextent = 1000.0\n"
CHAIN = HEAD + passes(height="./land", slope="./slope") + '[view]\nuse = "./shown"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / f"{name}.glsl").write_text(text)
    (tmp_path / "chain.toml").write_text(CHAIN)
    (tmp_path / "alone.toml").write_text(HEAD + passes(height="./land") + map_of("height", "red"))
    (tmp_path / "lives.toml").write_text(HEAD + passes(cells="./life") + map_of("cells", "red"))
    (tmp_path / "water.toml").write_text(HEAD + passes(land="./both") + map_of("land:water"))
    return tmp_path


def drawn(engine: Engine, path: Path | str, *, time: float = 0.0, texture: str = "") -> NDArray[np.uint8]:
    """Return the picture, or a texture as one, of a terrain with as many texels; rows from the south."""
    sketch = load(path).with_values({"size": FRAME})
    if not texture:
        return engine.render(sketch, size=FRAME, time=time).array[::-1, :, :3]
    values = engine.read(sketch, texture, time=time)
    three = np.repeat(values[..., None], 3, axis=2) if values.ndim == 2 else values[..., :3]
    return np.floor(np.clip(three.astype(np.float64), 0, 1) * 255.0 + 0.5).astype(np.uint8)


def apart(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> int:
    assert first.shape == other.shape
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 1, "nothing to see"
    return int(np.abs(first.astype(int) - other.astype(int)).max())


def isf_of(ctx: moderngl.Context, path: Path, **more: object) -> NDArray[np.uint8]:
    return draw_isf(ctx, path.read_text(), FRAME, **more)  # type: ignore[arg-type]


def toy_of(ctx: moderngl.Context, path: Path, time: float = 0.0) -> NDArray[np.uint8]:
    text = path.read_text()
    if path.suffix == ".frag":
        result = [{"type": "image", "code": text, "inputs": [], "outputs": []}]
    else:
        result = json.loads(text)[0]["renderpass"]
    return draw_shadertoy(ctx, result, FRAME, time=time)


# Half floats between passes are 32-bit ones elsewhere, and a rounding may fall the other way: one level.
ROUNDING = 1


def check_again(
    engine: Engine, sketch: Path, path: Path, *, texture: str = "", time: float = 0.0, own: bool = False
) -> NDArray[np.uint8]:
    """Export a sketch, see that the file draws the same, and return its picture: by its host, or by us."""
    done = export(sketch, path, texture=texture, engine=engine)
    assert texture or "the terrain has as many texels as the picture has pixels" in done.warnings
    if own:
        again = engine.render(load(path), size=FRAME, time=time).array[::-1, :, :3]
    elif path.suffix == ".fs":
        again = isf_of(engine.ctx, path, time=time)
    else:
        again = toy_of(engine.ctx, path, time)
    assert apart(drawn(engine, sketch, time=time, texture=texture), again) <= ROUNDING
    return again


@pytest.mark.parametrize("own", [False, pytest.param(True, marks=pytest.mark.room("dialects"))])
@pytest.mark.parametrize("ending", ["fs", "json"])
@pytest.mark.parametrize("name", ["chain", "alone", "lives", "water"])
def test_a_picture_of_several_passes_is_drawn_the_same(
    folder: Path, any_engine: Engine, ending: str, name: str, own: bool
) -> None:
    check_again(any_engine, folder / f"{name}.toml", folder / f"again.{ending}", time=1.5, own=own)


@pytest.mark.parametrize("ending", ["fs", "json", "frag"])
def test_one_texture_is_a_picture(folder: Path, any_engine: Engine, ending: str) -> None:
    check_again(any_engine, folder / "chain.toml", folder / f"out.{ending}", texture="height")


@pytest.mark.parametrize("ending", ["frag", "glsl"])
@pytest.mark.room("dialects")
def test_a_text_of_one_pass_is_read_again_and_drawn_the_same(
    folder: Path, any_engine: Engine, ending: str
) -> None:
    path = folder / f"again.{ending}"
    check_again(any_engine, folder / "chain.toml", path, texture="height", time=2.0, own=True)


def test_a_file_of_its_own_keeps_its_sliders(folder: Path, any_engine: Engine) -> None:
    path = folder / "again.glsl"
    sketch = load(folder / "chain.toml").with_values({"height.waves": 5.5, "height.shape": "sine"})
    export(sketch, path, texture="height", engine=any_engine)
    kernel = load(path).graph.passes[-1].technique
    waves = kernel.parameter("waves")  # type: ignore[union-attr]
    assert (waves.default, waves.widget.low, waves.widget.high, waves.step) == (5.5, 1.0, 12.0, 0.1)
    assert kernel.parameter("shape").widget.choices == ("sine", "square")  # type: ignore[union-attr]


INPUTS = {
    "waves": ("float", 1.0, 12.0, 3.0),
    "height_steps": ("float", 1.0, 9.0, 4.0),
    "height_seed": ("float", 0.0, 9999.0, 7.0),
    "turn": ("float", -360.0, 360.0, 30.0),
    "height_gain_y": ("float", 0.0, 2.0, 0.5),
    "height_sun_azimuth": ("float", -360.0, 360.0, 135.0),
    "height_sun_elevation": ("float", -90.0, 90.0, 25.0),
}


def test_parameters_are_inputs_of_an_isf(folder: Path, any_engine: Engine) -> None:
    path = folder / "out.fs"
    done = export(folder / "alone.toml", path, texture="height", engine=any_engine)
    header = json.loads(path.read_text().partition("}*/")[0].removeprefix("/*") + "}")
    result = {each["NAME"]: each for each in header["INPUTS"]}
    for name, (kind, low, high, value) in INPUTS.items():
        each = result[name]
        assert (each["TYPE"], each["MIN"], each["MAX"], each["DEFAULT"]) == (kind, low, high, value), name
    assert result["shape"]["LABELS"] == ["sine", "square"]
    assert result["shape"]["VALUES"] == [0, 1]
    assert result["shape"]["DEFAULT"] == 1
    assert result["turned"] == {"NAME": "turned", "TYPE": "bool", "LABEL": "Height: Turned", "DEFAULT": True}
    assert result["height_middle"]["TYPE"] == "point2D"
    assert result["height_tint"]["TYPE"] == "color"
    assert result["height_tint"]["DEFAULT"][:3] == pytest.approx([0.484529, 0.735357, 0.906332], abs=1e-5)
    assert any("Height: Offset" in warning for warning in done.warnings), "its range is made up"


CHANGED = {"waves": 7.5, "height_steps": 2.0, "shape": 0, "turned": False, "height_sun_elevation": 60.0}


def test_an_input_does_what_the_parameter_did(
    folder: Path, any_engine: Engine, ctx: moderngl.Context
) -> None:
    path = folder / "out.fs"
    export(folder / "chain.toml", path, texture="height", engine=any_engine)
    again = isf_of(ctx, path, values=CHANGED)
    sketch = load(folder / "chain.toml").with_values(
        {"size": FRAME, "height.waves": 7.5, "height.steps": 2, "height.shape": 0, "height.turned": False}
        | {"height.sun": (135.0, 60.0)}
    )
    values = np.clip(any_engine.read(sketch, "height").astype(np.float64), 0, 1)
    expected = np.repeat(np.floor(values * 255 + 0.5).astype(np.uint8)[..., None], 3, axis=2)
    assert apart(expected, again) <= ROUNDING


def test_one_name_in_two_passes_keeps_two_meanings(folder: Path, any_engine: Engine) -> None:
    path = folder / "out.fs"
    export(folder / "chain.toml", path, engine=any_engine)
    names = re.findall(r'"NAME": "(\w*gain\w*)"', path.read_text())
    assert {"slope_gain", "view_gain"} <= {*names}


def test_what_passes_share_is_common_once(folder: Path, any_engine: Engine) -> None:
    path = folder / "out.json"
    text = HEAD + passes(first="./slope", second="./slope")
    text = text.replace('name = "first"', 'name = "first"\ninputs = { height = "land" }')
    text = text.replace('name = "second"', 'name = "second"\ninputs = { height = "first" }')
    text = text.replace("[[pass]]", passes(land="./land") + "[[pass]]", 1)
    (folder / "two.toml").write_text(text + '[view]\nuse = "./shown"\ninputs = { slope = "second" }\n')
    export(folder / "two.toml", path, engine=any_engine)
    result = {each["name"]: each["code"] for each in json.loads(path.read_text())[0]["renderpass"]}
    assert sum("float at(sampler2D texels" in code for code in result.values()) == 1
    assert "float at(sampler2D texels" in result["Common"]
    assert list(result) == ["Common", "Buffer A", "Buffer B", "Buffer C", "Image"]


GROW = """// grow.glsl -- what grows from frame to frame, and where it was.
#pragma kernel(output = "cells:r8, trail:r32f")
uniform sampler2D before;        //! input("zero")
uniform sampler2D trail_before;  //! input("zero")
void kernel(ivec2 texel, out float cells, out float trail) {
    float west = texelFetch(before, (texel + ivec2(size.x - 1, 0)) % size, 0).r;
    float here = texelFetch(before, texel, 0).r;
    cells = iteration == 0 ? here : max(west, iteration % 3 == 0 ? 0.0 : here);
    int zero = int(texelFetch(trail_before, texel + int(texelFetch(trail_before, texel, 0).r), 0).r);
    trail = 0.9 * texelFetch(trail_before, texel + zero, 0).r + 0.1 * cells + 0.001 * float(iteration);
}
"""
SPREAD = """// spread.glsl -- three steps a frame.
#pragma kernel(output = "cells:rg32f", repeat = "3")
vec2 kernel(ivec2 texel) {
    vec2 sum = previous(texel + ivec2(1, 0)) + previous(texel - ivec2(0, 1)) + 2.0 * previous(texel);
    return 0.25 * sum + 0.001 * float(iteration);
}
"""
SEED = """// seed.glsl -- how it starts.
#pragma kernel(output = "cells:rg32f")
vec2 kernel(ivec2 texel) { return vec2(float((texel.x * 7 + texel.y * 3) % 5 == 0), 0.5); }
"""
LOOPS = {
    "grow": (
        'inputs = { before = "seed", trail_before = "seed" }',
        'repeat = "frames"',
        'feedback = { before = "cells", trail_before = "trail" }',
    ),
    "spread": ('inputs = { initial = "seed" }', 'repeat = "frames"', 'feedback = { initial = "cells" }'),
}


@pytest.mark.parametrize("ending", ["fs", "json"])
@pytest.mark.parametrize("name", ["grow", "spread"])
@pytest.mark.room("dialects")
def test_what_runs_once_a_frame_goes_on_from_its_own_buffer(
    folder: Path, any_engine: Engine, ending: str, name: str
) -> None:
    for file, text in {"grow": GROW, "spread": SPREAD, "seed": SEED}.items():
        (folder / f"{file}.glsl").write_text(text)
    shown = "state:trail" if name == "grow" else "state"
    text = HEAD + passes(seed="./seed", state=(f"./{name}", *LOOPS[name]))
    (folder / "loop.toml").write_text(text + map_of(shown, "red"))
    path = folder / f"looped.{ending}"
    if (name, ending) == ("spread", "json"):
        (folder / "spread.glsl").write_text(SPREAD.replace('"3"', '"2"'))
    export(folder / "loop.toml", path, engine=any_engine)
    for frame in (0, 1, 7):
        again = any_engine.render(load(path), size=FRAME, time=frame / 60).array[::-1, :, :3]
        expected = drawn(any_engine, folder / "loop.toml", time=frame / 60)
        assert apart(expected, again) <= ROUNDING, frame


def test_a_loop_that_is_not_the_frames_stays_behind(folder: Path, any_engine: Engine) -> None:
    (folder / "seed.glsl").write_text(SEED)
    (folder / "spread.glsl").write_text(SPREAD)
    lines = [line.replace('"frames"', '"5"') for line in LOOPS["spread"]]
    text = HEAD + passes(seed="./seed", state=("./spread", *lines))
    (folder / "loop.toml").write_text(text + map_of("state", "red"))
    result = refusal(any_engine, folder / "loop.toml", folder / "out.fs")
    assert result[0].startswith("pass 'state' repeats passes (5), which these formats have not")


ASKED = """// asked.glsl -- an input that a function reads, where something is wired.
#pragma kernel(output = "frame:rgba8")
uniform sampler2D height;  //! input
uniform sampler2D extra;   //! input("white")
float at(sampler2D texels, ivec2 texel) { return texelFetch(texels, texel, 0).r; }
vec4 kernel(ivec2 texel) { return vec4(at(height, texel), wired_extra ? at(extra, texel) : 0.5, 0.0, 1.0); }
"""


@pytest.mark.parametrize("ending", ["fs", "json"])
@pytest.mark.room("dialects")
def test_an_unwired_input_may_be_handed_to_a_function(folder: Path, any_engine: Engine, ending: str) -> None:
    (folder / "asked.glsl").write_text(ASKED)
    (folder / "a.toml").write_text(HEAD + passes(height="./land") + '[view]\nuse = "./asked"\n')
    path = folder / f"again.{ending}"
    check_again(any_engine, folder / "a.toml", path, own=True)
    (folder / "asked.glsl").write_text(
        ASKED.replace("wired_extra ? at(extra, texel) : 0.5", "at(extra, texel)")
    )
    again = check_again(any_engine, folder / "a.toml", path, own=True)
    assert (again[..., 1] == 255).all(), "white, by a pass of its own"


REDUCED = """// reduced.glsl -- the mean of a texture, as one texel.
#pragma kernel(output = "mean:r32f")
uniform sampler2D height;  //! input
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int x = 0; x < textureSize(height, 0).x; x++) sum += texelFetch(height, ivec2(x, texel.y), 0).r;
    return sum / float(textureSize(height, 0).x);
}
"""
AROUND = """// around.glsl -- a texture less its mean.
#pragma kernel(output = "frame:rgba8")
uniform sampler2D height;  //! input
uniform sampler2D mean;    //! input
vec4 kernel(ivec2 texel) {
    float far = float(textureSize(mean, 0).x);
    return vec4(vec3(0.5 * far + texelFetch(height, texel, 0).r - texelFetch(mean, ivec2(0), 0).r), 1.0);
}
"""


@pytest.mark.parametrize("ending", ["fs", "json"])
def test_a_pass_of_another_size_has_its_own_or_a_corner(
    folder: Path, any_engine: Engine, ctx: moderngl.Context, ending: str
) -> None:
    (folder / "reduced.glsl").write_text(REDUCED)
    (folder / "around.glsl").write_text(AROUND)
    text = HEAD + passes(height="./land", mean=("./reduced", "size = 1")) + '[view]\nuse = "./around"\n'
    (folder / "mean.toml").write_text(text)
    path = folder / f"out.{ending}"
    done = export(folder / "mean.toml", path, engine=any_engine)
    assert ("it needs a picture of at least 1 x 1 pixels" in done.warnings) == (ending == "json")
    again = isf_of(ctx, path) if ending == "fs" else toy_of(ctx, path)
    assert apart(drawn(any_engine, folder / "mean.toml"), again) <= ROUNDING


BARK = """// bark.glsl -- an image file.
#pragma kernel(output = "frame:rgba8")
uniform sampler2D bark;  //! file("bark.png", "linear", "repeat")
vec4 kernel(ivec2 texel) { return textureLod(bark, vec2(texel) / 37.0, 0.0); }
"""


def test_an_image_goes_with_an_isf(folder: Path, any_engine: Engine, ctx: moderngl.Context) -> None:
    from playground.data.image_files import write_png

    random = np.random.default_rng(5)
    pixels = random.integers(0, 256, (7, 11, 4)).astype(np.uint8)
    pixels[..., 3] = 255
    write_png(folder / "bark.png", pixels)
    (folder / "barked.glsl").write_text(BARK)
    (folder / "bark_sketch.toml").write_text(HEAD + passes(height="./land") + '[view]\nuse = "./barked"\n')
    (folder / "away").mkdir()
    path = folder / "away" / "out.fs"
    done = export(folder / "bark_sketch.toml", path, engine=any_engine)
    assert [p.name for p in done.sidecars] == ["out-bark.png"]
    copied = read_image(folder / "away" / "out-bark.png").pixels
    again = isf_of(ctx, path, images={"bark": np.ascontiguousarray(copied[::-1])})
    assert apart(drawn(any_engine, folder / "bark_sketch.toml"), again) <= ROUNDING
    with pytest.raises(
        PlaygroundError, match=r"reads the image file .*bark.png, which Shadertoy cannot be given"
    ):
        export(folder / "bark_sketch.toml", folder / "out.json", engine=any_engine)
    path.with_name("out-bark.png").write_bytes(b"something of mine")
    with pytest.raises(DataError, match=r"out-bark\.png is there already"):
        export(folder / "bark_sketch.toml", path, engine=any_engine)


def refusal(engine: Engine, sketch: Path | str, path: Path, **more: str) -> list[str]:
    with pytest.raises(PlaygroundError) as caught:
        export(sketch, path, engine=engine, **more)  # type: ignore[arg-type]
    assert not path.exists()
    return [diagnostic.message for diagnostic in caught.value.diagnostics]


def test_what_cannot_leave_is_named_one_by_one(folder: Path, any_engine: Engine) -> None:
    (folder / "far.toml").write_text(HEAD + passes(height="./land") + '[view]\nuse = "view/terrain"\n')
    result = refusal(any_engine, folder / "far.toml", folder / "out.fs")
    assert sum("--texture PASS exports one texture" in item for item in result) == 1
    assert any("'view.land' draws a mesh (land)" in item for item in result)
    assert any("'view.sky' reads the camera" in item for item in result)
    assert not any("'height'" in item for item in result)


def test_more_passes_than_a_format_has_are_counted(folder: Path, any_engine: Engine) -> None:
    result = refusal(any_engine, folder / "chain.toml", folder / "out.frag")
    assert result == [
        "a Shadertoy text is one pass; these are 3 (height, slope, view): export it as .json",
    ]
    (folder / "life.glsl").write_text(LIFE.replace('"3"', '"9"'))
    result = refusal(any_engine, folder / "lives.toml", folder / "out.json")
    assert "Shadertoy has 4 buffers, and 9 are needed" in result[0]


def test_a_whole_number_for_a_float_is_refused_for_shadertoy(folder: Path, any_engine: Engine) -> None:
    (folder / "land.glsl").write_text(LAND.replace("float h = 0.25", "float h = 1; h *= 0.25"))
    result = refusal(any_engine, folder / "alone.toml", folder / "out.frag", texture="height")
    assert "does not compile as GLSL ES 3.00" in result[0]


@pytest.mark.parametrize("ending", ["fs", "json"])
def test_a_size_that_a_kernel_insists_on_is_kept(
    folder: Path, any_engine: Engine, ctx: moderngl.Context, ending: str
) -> None:
    (folder / "land.glsl").write_text(LAND.replace('"height:r32f"', '"height:r32f", accepts = "2**n + 1"'))
    path = folder / f"out.{ending}"
    export(folder / "alone.toml", path, texture="height", engine=any_engine)
    values = np.clip(any_engine.read(load(folder / "alone.toml"), "height").astype(np.float64), 0, 1)
    x, y = np.arange(FRAME[0]) * 33 // FRAME[0], np.arange(FRAME[1]) * 33 // FRAME[1]
    expected = np.floor(values[np.ix_(y, x)] * 255 + 0.5).astype(np.uint8)
    again = isf_of(ctx, path) if ending == "fs" else toy_of(ctx, path)
    assert apart(np.repeat(expected[..., None], 3, axis=2), again) <= ROUNDING


# ── widgets of an ISF, read again by us ──────────────────────────────────────

WIDGETS = """#pragma kernel(output = "height:r32f")
uniform int mode = 9;                 //! menu("soft", "hard", "none") values(-3, 9, 40)
uniform vec2 place = vec2(0.0, 3.0);  //! point(-1, 1, 2, 4)
uniform vec4 tint = vec4(0.25, 0.5, 1.0, 1.0);  //! colour("raw")
uniform vec3 lit = vec3(0.25, 0.5, 1.0);        //! colour
uniform bool go;                      //! button
uniform float level = 0.5;            //! slider(0, 2)
float kernel(ivec2 texel) {
    float east = float(texel.x) / float(size.x);
    float found = float(mode) / 80.0 + east * level * tint.g * lit.r + place.y * 0.05;
    return go ? 1.0 - found : found;
}
"""
WIDGETS_SKETCH = """format = 1
size = [32, 18]
[[pass]]
name = "height"
use = "./k"
[view]
use = "view/map"
inputs = { shown = "height" }
set = { lowest = 0.0, highest = 1.0 }
"""


@pytest.fixture
def widgets(tmp_path: Path) -> Path:
    (tmp_path / "k.glsl").write_text(WIDGETS)
    (tmp_path / "s.toml").write_text(WIDGETS_SKETCH)
    return tmp_path / "s.toml"


CHANGES = [{}, {"mode": "soft"}, {"mode": "none"}, {"place": (0.5, 4.0)}, {"tint": (0.1, 0.9, 0.1, 1.0)},
           {"lit": "#c08040"}, {"go": True}, {"level": 1.75}]  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=str)
@pytest.mark.room("dialects")
def test_widgets_of_an_isf_do_the_same(any_engine: Engine, widgets: Path, changes: dict[str, object]) -> None:
    out = widgets.with_name("out.fs")
    export(widgets, out, texture="height", engine=any_engine)
    again = load(out)
    names = {p.name.removeprefix("height_"): p for p in again.graph.find("view").technique.parameters}  # type: ignore[union-attr]
    values = {f"view.{names[name].name}": value for name, value in changes.items()}
    sketch = load(widgets).with_values({f"height.{name}": value for name, value in changes.items()})
    expected = np.clip(any_engine.read(sketch, "height"), 0.0, 1.0)
    array = any_engine.render(again.with_values(values), size=(32, 18)).array[::-1, :, 0]
    np.testing.assert_allclose(array / 255.0, expected, atol=1.5 / 255.0)
    kinds = {name: p.widget.kind for name, p in names.items()}
    assert {
        "mode": "menu",
        "place": "point",
        "tint": "colour",
        "lit": "colour",
        "go": "button",
    }.items() <= kinds.items()
    assert names["mode"].widget.values == (-3, 9, 40)
    assert names["place"].widget.axes == ((-1.0, 1.0), (2.0, 4.0))
