"""A picture drawn part by part is the picture drawn whole."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.engine.plan import Window
from playground.engine.textures import read_picture, read_texture
from playground.errors import DataError, ParameterError, SketchError
from playground.publish.large import TILE, count_parts, count_tiles, is_large, strips, tiles_of, write_large

from ...loading import load
from ...sketch_texts import passes

SIZE, TILES = (640, 360), (100, 70)
SMALL = {"size": 129}
FIRST_OBJECT = 4.0  # of seen.w: see scene/packing.glsl

PLAIN = """#version 330
uniform vec3 iResolution;
uniform float iTime;
out vec4 colour;
void main() {
    vec2 place = gl_FragCoord.xy / iResolution.xy;
    float rings = sin(40.0 * distance(place, vec2(0.4, 0.6)) + iTime);
    colour = vec4(place, 0.5 + 0.5 * rings, 1.0) + 0.001 * dFdx(gl_FragCoord.x);
}
"""
VIEW = """#pragma kernel(output = "frame:rgba8")
uniform sampler2D shown;  //! input
{above}
vec4 kernel(ivec2 texel) {{
    {body}
}}
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(height="generation/white_noise", first=("view/map", 'inputs = {{ shown = "height" }}'))
    + '[view]\nuse = "./both"\ninputs = {{ height = "height" }}\n'
)
BOTH = (
    "format = 1\n"
    + passes(first="view/map", last=("./last", 'inputs = {{ shown = "first" }}'))
    + '[inputs]\nheight = "first.shown"\n'
)


def together(engine: Engine, sketch, size=SIZE, tile=TILES, **more) -> np.ndarray:
    return np.concatenate(list(strips(engine, sketch, size, tile=tile, **more)))


def two_passes(folder: Path, body: str, above: str = ""):
    (folder / "sketch.toml").write_text(SKETCH.format().replace("{{", "{"), encoding="utf-8")
    (folder / "both.toml").write_text(BOTH.format(), encoding="utf-8")
    (folder / "last.glsl").write_text(VIEW.format(body=body, above=above), encoding="utf-8")
    return load(folder)


# ── exactly the same ─────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", ["contours_map", "white_noise_image", "profile", "diamond_square_steps"])
def test_kernels_give_the_same_bytes(any_engine: Engine, name: str):
    sketch = load(name)
    whole = any_engine.render(sketch, size=SIZE).array
    np.testing.assert_array_equal(together(any_engine, sketch), whole)
    np.testing.assert_array_equal(together(any_engine, sketch, tile=(640, 64)), whole)


def test_a_plain_shader_gives_the_same_bytes(any_engine: Engine, tmp_path: Path):
    (tmp_path / "plain.frag").write_text(PLAIN, encoding="utf-8")
    sketch = load(tmp_path / "plain.frag")
    whole = any_engine.render(sketch, size=SIZE, time=1.5).array
    np.testing.assert_array_equal(together(any_engine, sketch, time=1.5), whole)


def test_both_drivers_give_the_same_bytes(engine: Engine, tmp_path: Path):
    position = "vec2(texel) / vec2(textureSize(shown, 0))"
    body = f"return vec4({position}, texelFetch(shown, texel, 0).r, 1.0);"
    sketch = two_passes(tmp_path, body)
    whole = engine.render(sketch, size=(90, 50)).array
    assert whole[..., 2].std() > 10
    np.testing.assert_array_equal(together(engine, sketch, (90, 50), (32, 24)), whole)


# ── as good as the same ──────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "zoomed"),
    [
        pytest.param("geomipmap", False, id="geomipmap-viewport"),
        pytest.param("jacksboro", True, id="jacksboro-stretched"),
        pytest.param("geomipmap", True, id="geomipmap-stretched", marks=pytest.mark.slow),
        pytest.param("jacksboro", False, id="jacksboro-viewport", marks=pytest.mark.slow),
    ],
)
def test_a_mesh_differs_in_few_pixels_and_at_no_seam(any_engine: Engine, name: str, zoomed: bool):
    """Rounding of single precision from another corner: few pixels, little, and anywhere."""
    sketch = load(name).with_values(SMALL)
    whole = any_engine.render(sketch, size=SIZE).array.astype(int)
    if zoomed:  # as where the driver's viewports are smaller than the picture
        any_engine.runner.draws.widest = (64, 64)
    apart = np.abs(together(any_engine, sketch) - whole).max(axis=2)
    assert np.count_nonzero(apart) < 0.002 * apart.size
    assert apart.mean() < 0.005, "of 255 levels"
    assert apart.max() <= 32
    seams = np.zeros(apart.shape, bool)
    for x in range(TILES[0], SIZE[0], TILES[0]):
        seams[:, x - 1 : x + 1] = True
    for y in range(TILES[1], SIZE[1], TILES[1]):
        seams[SIZE[1] - y - 1 : SIZE[1] - y + 1] = True
    assert apart[seams].mean() < 0.02, "no more there than elsewhere"


@pytest.mark.slow
def test_crowns_have_the_same_bits_in_every_part(any_engine: Engine):
    """But where another one is seen: depths and edges of squares are rounded as those of any mesh."""
    size, ref = (320, 180), "view.crowns"
    sketch = load("trees").with_values({"view.antialias": False})
    whole = any_engine.read(sketch, ref, size=size).copy()
    parts = np.zeros_like(whole)
    for window in (window for row in tiles_of(size, (96, 64)) for window in row):
        plan = any_engine.plan_for_window(sketch, window)
        (x, y), (wide, tall) = window.origin, window.size
        texture = any_engine.texture_of(plan, plan.flat.ref(ref, sketch.name))
        parts[y : y + tall, x : x + wide] = read_texture(texture)
    crowns = (whole[..., 3] >= FIRST_OBJECT) & (parts[..., 3] >= FIRST_OBJECT)
    other = (whole.view(np.uint32) != parts.view(np.uint32)).any(axis=2) & crowns
    swapped = np.abs(whole[..., :3] - parts[..., :3]).max(axis=2) > 0.1
    assert crowns.sum() > 20_000 and not (other & ~swapped).any()
    assert np.count_nonzero(other) < 0.002 * other.size


@pytest.mark.slow
def test_levels_of_detail_are_those_of_the_whole_picture(any_engine: Engine):
    """The mesh chosen by pixels is that of the whole: a tile of its own size would take a coarser one."""
    sketch = load("geomipmap").with_values(SMALL)
    any_engine.render(sketch, size=SIZE)
    triangles = any_engine.runner.draws.triangles
    list(strips(any_engine, sketch, SIZE, tile=TILES))
    assert any_engine.runner.draws.triangles == triangles


# ── sizes, memory, files ─────────────────────────────────────────────────────


def test_tiles_cover_a_picture_once():
    seen = np.zeros((361, 643), int)
    for row in tiles_of((643, 361), TILES):
        for tile in row:
            (x, y), (width, height) = tile.origin, tile.size
            assert tile.full_size == (643, 361) and x % 2 == y % 2 == 0
            seen[y : y + height, x : x + width] += 1
    assert (seen == 1).all()
    assert count_tiles((643, 361), TILES) == 7 * 6
    with pytest.raises(ParameterError, match="even"):
        tiles_of(SIZE, (99, 70))


def test_the_parts_of_a_supersampled_picture_are_counted(any_engine: Engine):
    sketch = load("white_noise_image").with_picture(supersample=3)
    done = Counter()
    list(strips(any_engine, sketch, (3000, 400), done=lambda: done.update(["tile"])))
    assert done["tile"] == count_parts(sketch, (3000, 400)) > count_tiles((3000, 400))


def test_what_is_large(any_engine: Engine, tmp_path: Path):
    sketch = load("l_dot_n")
    assert not is_large(any_engine, sketch, (3840, 2160))
    assert is_large(any_engine, sketch, (7680, 4320)) and is_large(any_engine, sketch, (20000, 2))
    blurred = two_passes(tmp_path, "return texelFetch(shown, texel + 1, 0);")
    assert not is_large(any_engine, blurred, (7680, 4320)), "its textures still hold that"
    assert is_large(any_engine, blurred, (20000, 2)), "to be refused in a sentence"


def test_a_picture_wider_than_any_texture(any_engine: Engine, tmp_path: Path):
    """20,000 pixels: its columns are those of a small picture, each eight times."""
    sketch = load("white_noise_image")
    done = Counter()
    path = write_large(
        any_engine, sketch, tmp_path / "wide.png", (20000, 6), done=lambda: done.update(["tile"])
    )
    pixels, _ = read_png(path)
    assert pixels.shape == (6, 20000, 4) and done["tile"] == count_tiles((20000, 6)) == -(-20000 // TILE[0])


@pytest.mark.slow
def test_the_far_end_of_a_picture_wider_than_any_viewport(any_engine: Engine):
    """16,640 pixels: what is there is what a tenth of the size shows there, pixel by hundred pixels."""
    sketch = load("jacksboro").with_values(SMALL)
    window = Window((16000, 100), (640, 100), (16640, 9360))
    texture = any_engine.draw_window(sketch, window)
    wide = read_picture(texture)[..., :3].astype(float)
    small = any_engine.render(sketch, size=(1664, 936)).array[-20:-10, 1600:, :3]
    means = wide.reshape(10, 10, 64, 10, 3).mean(axis=(1, 3))
    assert small.std() > 5, "there is something to see"
    assert np.abs(means - small).mean() < 3.0
    assert np.abs(means - small).mean() < 0.5 * np.abs(means[:, ::-1] - small).mean()


def test_nothing_is_left_of_a_picture_that_fails(any_engine: Engine, tmp_path: Path):
    sketch = two_passes(tmp_path, "return texelFetch(shown, texel + 1, 0);")
    folder = tmp_path / "out"
    folder.mkdir()
    with pytest.raises(SketchError, match="cannot be drawn in parts"):
        write_large(any_engine, sketch, folder / "a.png", (64, 64), tile=(32, 32))
    assert not list(folder.iterdir())


@pytest.mark.slow
def test_live_objects_do_not_grow_with_the_tiles(any_engine: Engine, alive: Counter[str]):
    sketch = load("l_dot_n")
    list(strips(any_engine, sketch, (64, 36), tile=(32, 18)))
    before = Counter(alive)
    list(strips(any_engine, sketch, (128, 72), tile=(32, 18)))
    assert alive == before


def test_variables_of_other_functions_may_have_an_input_s_name(any_engine: Engine, tmp_path: Path):
    """Of types that GLSL has, and of structs: there the name is no input."""
    above = (
        "struct Shown { vec4 colour; };\n"
        "vec4 of_struct(Shown shown) { return shown.colour; }\n"
        "vec4 of_vector(vec4 given) { vec4 shown = given; return shown; }\n"
    )
    body = "return of_struct(Shown(of_vector(texelFetch(shown, texel, 0))));"
    sketch = two_passes(tmp_path, body, above)
    parts = together(any_engine, sketch, (64, 64), (32, 32))
    np.testing.assert_array_equal(parts, any_engine.render(sketch, size=(64, 64)).array)


@pytest.mark.parametrize(
    ("body", "above", "message"),
    [
        ("return texelFetch(shown, texel + 1, 0);", "", "it reads 'shown' elsewhere than at its own texel"),
        ("return textureLod(shown, vec2(0.5), 0.0);", "", "it reads 'shown' elsewhere"),
        ("texel += 1; return texelFetch(shown, texel, 0);", "", "it changes its 'texel'"),
        ("return of(texel);", "vec4 of(ivec2 texel) { return texelFetch(shown, texel, 0); }", "elsewhere"),
        (
            "return shown_of(texel);",
            "vec4 shown_of(ivec2 texel) { if (texel.x < 0) return vec4(0.0); else\n"
            "return texelFetch(shown, texel, 0); }",
            "elsewhere",
        ),
    ],
)
def test_what_reads_its_neighbours_is_refused(any_engine: Engine, tmp_path: Path, body, above, message):
    sketch = two_passes(tmp_path, body, above)
    with pytest.raises(SketchError, match=r"pass 'view.last' cannot be drawn in parts") as caught:
        together(any_engine, sketch, (64, 64), (32, 32))
    assert message in str(caught.value) and caught.value.diagnostics[0].file.endswith("both.toml")


def test_a_picture_drawn_in_parts_is_no_jpeg(any_engine: Engine, tmp_path: Path):
    with pytest.raises(DataError, match=r"a\.jpg: a picture that is drawn in parts .* ending in \.png"):
        write_large(any_engine, "white_noise_image", tmp_path / "a.jpg", (64, 36))
    assert not list(tmp_path.iterdir())
