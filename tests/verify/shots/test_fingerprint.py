"""What a picture says it comes from: read from the driver, stored in a PNG, and compared in messages."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground._version import __version__
from playground.data.image_files import write_png
from playground.engine.context import ContextInfo, processor_in
from playground.engine.engine import Engine
from playground.engine.renderer import rounded
from playground.sketch.variants import compiled_text
from playground.verify.shots.references import (
    Fingerprint,
    fingerprint_of,
    read_fingerprint,
    read_reference,
    write_reference_in,
)

from ...cases import each
from ...loading import load
from ...sketch_texts import passes
from .conftest import OURS

LLVMPIPE = ContextInfo(450, "llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa/X.org", "4.5 Mesa 22.3.6", 4)
NVIDIA = ContextInfo(460, "NVIDIA H200/PCIe/SSE2", "NVIDIA Corporation", "4.6.0 NVIDIA 570.86", 32)


@pytest.mark.parametrize(
    ("version", "renderer", "mesa", "llvm"),
    [
        ("4.5 (Core Profile) Mesa 22.3.6", "llvmpipe (LLVM 15.0.6, 256 bits)", "22.3.6", "15.0.6"),
        ("4.5 Mesa 25.0.7-2~bpo12+1", "llvmpipe (LLVM 19.1.7, 128 bits)", "25.0.7-2~bpo12+1", "19.1.7"),
        ("4.5 Mesa 24.1.0-devel (git-1f2e3d4c)", "softpipe", "24.1.0-devel (git-1f2e3d4c)", ""),
        (
            "4.6 Mesa 24.0.2",
            "AMD Radeon RX 6800 (radeonsi, navi21, LLVM 17.0.6, DRM 3.57)",
            "24.0.2",
            "17.0.6",
        ),
        ("4.6.0 NVIDIA 570.86", "NVIDIA H200/PCIe/SSE2", "", ""),
        ("4.1 Metal - 88", "Apple M2", "", ""),
    ],
)
def test_mesa_and_llvm_are_read_from_the_drivers_words(
    version: str, renderer: str, mesa: str, llvm: str
) -> None:
    fingerprint = fingerprint_of(ContextInfo(450, renderer, "vendor", version, 4), (8, 4), "h")
    assert (fingerprint.renderer, fingerprint.version, fingerprint.vendor) == (renderer, version, "vendor")
    assert (fingerprint.mesa, fingerprint.llvm, fingerprint.size, fingerprint.drawn) == (
        mesa,
        llvm,
        "8x4",
        "h",
    )
    assert fingerprint.tool.endswith(__version__)


@pytest.mark.parametrize(
    ("text", "vendor", "simd"),
    [
        (
            "vendor_id\t: GenuineIntel\nmodel name\t: x: y\nflags\t\t: sse avx f16c fma avx2\n",
            "GenuineIntel",
            "avx fma f16c",
        ),
        ("vendor_id\t: AuthenticAMD\nflags\t\t: sse sse2\n\nflags: avx\n", "AuthenticAMD", "none"),
        ("processor\t: 0\nCPU implementer\t: 0x41\nFeatures\t: asimd\n", "ARM", ""),
        ("CPU implementer\t: 0x77\n", "ARM implementer 0x77", ""),
        ("", "", ""),
    ],
)
def test_the_processor_is_read_from_linux(text: str, vendor: str, simd: str) -> None:
    assert processor_in(text) == (vendor, simd)


CARD = replace(OURS, renderer=NVIDIA.renderer, version=NVIDIA.version)


@each(
    ("ours", "changes", "same_build", "said"),
    [
        (OURS, {}, True, []),
        (OURS, {"renderer": "llvmpipe (LLVM 15.0.6, 128 bits)"}, False, ["renderer: "]),
        (OURS, {"version": "4.5 Mesa 22.3.7"}, False, ["OpenGL version: "]),
        (OURS, {"cpu": "AuthenticAMD"}, False, ["processor: "]),
        (OURS, {"simd": "avx"}, False, ["processor's instructions: "]),
        *((OURS, {part: "something else"}, True, [""]) for part in ("vendor", "drawn", "size", "tool")),
        (OURS, {"cpu": "", "simd": "", "drawn": ""}, True, ["the reference does not say its processor"]),
        (CARD, {"cpu": "AuthenticAMD", "simd": "none"}, True, []),  # the processor counts where it draws
    ],
    ids=lambda case: case[1],
)
def test_another_build_is_known_by_each_of_its_parts(
    ours: Fingerprint, changes: dict[str, str], same_build: bool, said: list[str]
) -> None:
    other = replace(ours, **changes)
    assert ours.same_build(other) is other.same_build(ours) is same_build
    lines = ours.differences(other)
    assert len(lines) == len(said) and all(map(str.startswith, lines, said))
    for part, text in changes.items():
        assert same_build or (text in lines[0] and getattr(ours, part) in lines[0])
    assert OURS.same_build(Fingerprint()) and OURS.differences(Fingerprint())
    assert fingerprint_of(NVIDIA, (8, 4)).cpu == fingerprint_of(NVIDIA, (8, 4)).simd == ""


def test_png_fingerprint_round_trips_and_file_is_reproducible(tmp_path: Path) -> None:
    pixels = np.arange(4 * 6 * 4, dtype=np.uint8).reshape(4, 6, 4)
    path, _ = write_reference_in(tmp_path / "a", "dawn", OURS, pixels, "hills")
    reference = read_reference(path)
    assert reference.fingerprint == OURS
    assert (reference.text["sketch"], reference.text["shot"]) == ("hills", "dawn")
    again, _ = write_reference_in(tmp_path / "b", "dawn", OURS, pixels, "hills")
    assert again.read_bytes() == path.read_bytes()


def test_a_png_without_texts_says_nothing(tmp_path: Path) -> None:
    write_png(tmp_path / "x.png", np.zeros((2, 2, 4), np.uint8))
    assert read_reference(tmp_path / "x.png").fingerprint == Fingerprint()
    assert read_fingerprint({"Software": "an editor"}) == Fingerprint()


# ── what was drawn ───────────────────────────────────────────────────────────

HASH = "// hash.glsl -- numbers.\nfloat scatter(int n) { return fract(float(n) * 0.618); }\n"

TERRAIN = """// terrain.glsl -- a slope with a picture on it.
#include "hash.glsl"
#define TWICE(x) (2.0 * (x))
#pragma kernel(output = "height:r32f", repeat = "count")

uniform int   count = 2;      //! slider(1, 4) Steps
uniform float gain  = 0.5;    //! slider(0, 1) How steep it is
uniform float idle  = 0.5;    //! slider(0, 1) Nothing reads it
uniform sampler2D stones;     //! file("stones.png")

float kernel(ivec2 texel) {
    float slope = gain * float(texel.x) / float(size.x);   // rises to the east
    return previous(texel) + TWICE(slope) + scatter(texel.y) * texelFetch(stones, texel & 3, 0).r;
}
"""

SKETCH = (
    "format = 1\nsize = 16\nextent = 1000.0\n"
    + passes(
        height=("./terrain", 'set = { gain = 0.25, stones = "stones.png" }'),
        light=("lighting/l_dot_n", 'inputs = { height = "height" }', "set = { sun = [135.0, 30.0] }"),
    )
    + """[view]
use = "view/terrain"
set = { grid = 9 }
camera = { azimuth = 200.0, elevation = 30.0 }
"""
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "one"
    made.mkdir()
    (made / "hash.glsl").write_text(HASH)
    (made / "terrain.glsl").write_text(TERRAIN)
    (made / "hills.toml").write_text(SKETCH)
    stones = np.random.default_rng(3).integers(0, 256, (4, 4, 4), dtype=np.uint8)
    stones[..., 3] = 255
    write_png(made / "stones.png", stones)
    return made


@pytest.fixture
def drawing(ctx: moderngl.Context) -> Iterator[Engine]:
    with Engine(ctx) as made:
        yield made


def drawn(
    engine: Engine, folder: Path, size: tuple[int, int] = (24, 16), time: float = 0.0, **steps: int
) -> str:
    engine.render(load(folder / "hills.toml"), size=size, time=time, steps=steps)
    return engine.drawn()


def edited(folder: Path, file: str, old: str, new: str) -> Path:
    text = (folder / file).read_text()
    assert old in text
    (folder / file).write_text(text.replace(old, new))
    return folder


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("terrain.glsl", "rises to the east", "falls to the west"),
        ("terrain.glsl", "a slope with a picture", "another title"),
        ("terrain.glsl", "How steep it is", "Another tooltip"),
        ("terrain.glsl", "    return previous", "\n\n\t/* two\nlines */ return\nprevious"),
        ("terrain.glsl", "TWICE(slope) + scatter", "TWICE( slope )+scatter"),
        ("hash.glsl", "-- numbers", "-- no numbers"),
        ("hills.toml", "size = 16\nextent = 1000.0", "extent = 1000  # metres\nsize = 16"),
        ("hills.toml", 'name = "height"\nuse = "./terrain"', 'use = "./terrain"\nname = "height"'),
        ("hills.toml", "gain = 0.25", "gain = 0.250"),
        ("hills.toml", "gain = 0.25", "gain = 0.25, idle = 0.75"),
        ("hills.toml", "format = 1", 'format = 1\ntitle = "Hills"'),
    ],
)
def test_what_changes_no_picture_changes_no_hash(
    drawing: Engine, folder: Path, file: str, old: str, new: str
) -> None:
    before = drawn(drawing, folder)
    assert before
    assert drawn(drawing, edited(folder, file, old, new)) == before


def test_moved_files_and_another_engine_change_no_hash(
    drawing: Engine, folder: Path, tmp_path: Path, ctx: moderngl.Context
) -> None:
    assert drawing.drawn() == "", "nothing is drawn yet"
    before = drawn(drawing, folder)
    with Engine(ctx) as other:
        assert drawn(other, folder) == before
    moved = tmp_path / "elsewhere"
    shutil.copytree(folder, moved)
    (moved / "deeper").mkdir()
    for name in ("terrain.glsl", "hash.glsl"):
        (moved / name).rename(moved / "deeper" / name)
    (moved / "stones.png").rename(moved / "pebbles.png")
    edited(moved, "hills.toml", "./terrain", "./deeper/terrain")
    edited(moved, "hills.toml", "stones.png", "pebbles.png")
    assert drawn(drawing, moved) == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("hash.glsl", "0.618", "0.619"),
        ("terrain.glsl", "(2.0 * (x))", "(2.5 * (x))"),
        ("terrain.glsl", "previous(texel) + TWICE", "previous(texel) - TWICE"),
        ("terrain.glsl", "count = 2", "count = 3"),
        ("terrain.glsl", "height:r32f", "height:r16f"),
        ("terrain.glsl", 'file("stones.png")', 'file("stones.png") input("linear")'),
        ("hills.toml", "gain = 0.25", "gain = 0.2500001"),
        ("hills.toml", "size = 16", "size = 17"),
        ("hills.toml", "extent = 1000.0", "extent = 1001.0"),
        ("hills.toml", "azimuth = 200.0", "azimuth = 200.01"),
        ("hills.toml", "[135.0, 30.0]", "[136.0, 30.0]"),
        ("hills.toml", "grid = 9", "grid = 5"),
        ("hills.toml", "lighting/l_dot_n", "lighting/height_difference"),
        ("hills.toml", 'use = "view/terrain"', 'use = "view/terrain"\ninputs = { light = "height" }'),
    ],
)
def test_what_changes_a_picture_changes_the_hash(
    drawing: Engine, folder: Path, file: str, old: str, new: str
) -> None:
    if "linear" in new:
        new = 'file("stones.png", "linear")'
    if "height_difference" in new:
        edited(folder, "hills.toml", "set = { sun = [135.0, 30.0] }\n", "")
    before = drawn(drawing, folder)
    assert drawn(drawing, edited(folder, file, old, new)) != before


def test_one_byte_of_an_image_changes_the_hash(drawing: Engine, folder: Path) -> None:
    before = drawn(drawing, folder)
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[..., 3] = 255
    write_png(folder / "stones.png", pixels)
    black = drawn(drawing, folder)
    pixels[3, 3, 0] = 1
    write_png(folder / "stones.png", pixels)
    assert len({before, black, drawn(drawing, folder)}) == 3


def test_the_shots_own_settings_change_the_hash(drawing: Engine, folder: Path) -> None:
    edited(folder, "terrain.glsl", "TWICE(slope)", "TWICE(slope) * (1.0 + time)")
    result = [drawn(drawing, folder), drawn(drawing, folder, (25, 16)), drawn(drawing, folder, time=1.0)]
    result.append(drawn(drawing, folder, height=1))
    sketch = load(folder / "hills.toml")
    drawing.render(sketch.with_picture(samples=1), size=(24, 16))
    result.append(drawing.drawn())
    assert len(set(result)) == 5


def test_the_drivers_form_is_part_of_it(ctx: moderngl.Context, folder: Path) -> None:
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver="fragment") as first, Engine(ctx, driver="compute") as other:
        assert drawn(first, folder) != drawn(other, folder)


@pytest.mark.parametrize(
    ("first", "other", "same"),
    [
        ("a - -b;", "a--b;", False),
        ("a+b ;", "a + b;", True),
        ("x = .5e-3;", "x=.5e-3 ;", True),
        ("x = 1. 5;", "x = 1.5;", False),
        ("int\nx;", "int x;", True),
        ("intx;", "int x;", False),
        ("#define F (x)", "#define F(x)", False),
        ("#define  F(x)   x", "#define F(x) x", True),
        ("#define A 1\nB", "#define A 1 B", False),
        ("a <<= 1;", "a << = 1;", False),
    ],
)
def test_a_text_counts_by_its_tokens(first: str, other: str, same: bool) -> None:
    assert (compiled_text(first) == compiled_text(other)) is same


def test_the_last_digits_of_a_matrix_say_nothing() -> None:
    assert rounded((1.0, 6e-17, -0.5)) == rounded((1.0 + 1e-15, -5e-17, -0.5))
    assert rounded((1.0, 1e-6)) != rounded((1.0, 2e-6))
    assert rounded(0.1 + 0.2) == rounded(0.3)
    assert rounded(0.3) != rounded(0.30001)
    assert (rounded((0.0, 0.0)), rounded(3), rounded("text")) == (("0", "0"), 3, "text")
