"""Expensive textures cached on disk: the same bits come back, and nothing else ever does."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.machinery import ModuleSpec
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine import disk_cache as store_module
from playground.engine.context import ContextInfo
from playground.engine.disk_cache import (
    CachedTextures,
    DiskCache,
    bytes_in,
    clear,
    disk_cache_for,
    limit_in,
    listed,
    trim,
)
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.engine.gl_calls import read_mipmap
from playground.engine.software import MIPMAPS
from playground.engine.textures import levels_of, read_raw
from playground.errors import ParameterError

from ..sketch_texts import passes

ROOT = Path(__file__).resolve().parents[2]
ALWAYS = float("-inf")  # a floor that every pass's cost is above
FORMATS = [f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f")]

# Random bits: NaN with all its payloads, denormals, infinities, -0.
BITS = """#pragma kernel(output = "bits:FORMAT")
#include "noise/hash.glsl"
uniform uint seed = 1u; //! slider(0, 99)
TYPE kernel(ivec2 texel) {
    uvec4 h = uvec4(texel, seed, 7u) * 0x9E3779B9u;
    h = (h ^ (h >> 15u)) * 0x85EBCA6Bu;
    h = (h.yzwx ^ (h >> 13u)) * 0xC2B2AE35u + h.wxyz;
    return CAST;
}
"""
TERRAIN = """#pragma kernel(output = "height:r32f, water:rg16f", repeat = "3")
uniform float bumps = 3.0; //! slider(0, 10)
uniform sampler2D image;   //! file("p.png")
void kernel(ivec2 texel, out float height, out vec2 water) {
    float bump = sin(float(texel.x * texel.y) * bumps);
    height = previous_height(texel) + bump + texelFetch(image, ivec2(0), 0).r;
    water = previous_water(texel) + vec2(texel) / 64.0;
}
"""
SMOOTH = """#pragma kernel(output = "height:r32f")
uniform sampler2D before; //! input("linear", "mipmap")
uniform float share = 0.5; //! slider(0, 1)
float kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    return mix(textureLod(before, place, 0.0).r, textureLod(before, place, 2.0).r, share);
}
"""
LIGHT = """#pragma kernel(output = "light:rgba8")
uniform sampler2D height; //! input("linear", "mipmap")
uniform vec2 sun = vec2(135.0, 30.0); //! direction
vec4 kernel(ivec2 texel) {
    return vec4(fract(textureLod(height, vec2(texel) / vec2(size), 1.0).r * sun.x), sun.y / 90.0, 0.0, 1.0);
}
"""
DRAW = """#pragma draw(mesh = "grid", output = "frame:rgba16f")
uniform sampler2D height; //! input("linear", "mipmap")
uniform sampler2D light;  //! input("linear")
uniform int grid = 9;     //! slider(2, 99)
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    vec4 corner4 = clip_from_world * vec4(corner.xy * 900.0, textureLod(height, place, 0.0).r, 1.0);
    return vec4(corner.xy * 1.8 - 0.9, 0.1 * textureLod(height, place, 0.0).r + 1e-9 * corner4.x, 1.0);
}
vec4 fragment(vec2 place) { return texture(light, place) + 0.1 * texture(height, place).rrrr; }
"""
LOOP = """
[[pass]]
name = "add"
use = "./smooth"
[inputs]
height = "add.before"
[outputs]
height = "add:height"
"""
BODY = (
    "extent = 1000.0\nrelief = 100.0\n"
    + passes(
        terrain="./terrain",
        worn=(
            "./loop",
            "repeat = 3",
            'feedback = { height = "height" }',
            'inputs = { height = "terrain:height" }',
        ),
        light=("./light", 'inputs = { height = "worn:height" }'),
    )
    + """[view]
use = "./draw"
inputs = { height = "worn:height", light = "light" }
"""
)
TERRAIN_PASSES = ("terrain", "worn.add", "light")


@pytest.fixture
def worn(folder):
    """Give a terrain that a loop wears, lit, and drawn from the camera."""
    for name, text in (("terrain", TERRAIN), ("smooth", SMOOTH), ("light", LIGHT), ("draw", DRAW)):
        folder.write(f"{name}.glsl", text)
    folder.write("loop.toml", LOOP)
    write_png(folder.path / "p.png", np.full((1, 1, 4), 255, np.uint8))
    return folder.sketch(BODY, size="size = 33")


class Shelf:
    """A store in a folder, and engines with it, one after another as sessions are."""

    def __init__(self, ctx: moderngl.Context, folder: Path, driver: str = "auto") -> None:
        self.ctx = ctx
        self.folder = folder
        self.driver = driver
        self.engines: list[Engine] = []

    def engine(self, floor: float = ALWAYS, **options: int) -> Engine:
        """Return an engine as a new session has it."""
        made = Engine(self.ctx, driver=self.driver, **options)
        made.disk_caching = DiskCaching(disk_cache_for(made.info, 2**26, self.folder), floor=floor)
        self.engines.append(made)
        return made

    def keep(self, engine: Engine) -> None:
        """Keep what is worth it of an engine's last frame."""
        assert engine.disk_caching is not None and engine.record.plan is not None
        engine.disk_caching.finish(engine, engine.record.plan)
        assert engine.disk_caching.store.trouble == ""

    def close(self) -> None:
        """Release all of it."""
        for engine in self.engines:
            engine.release()


@pytest.fixture(params=["fragment", "compute"])
def shelf(request, ctx, tmp_path) -> Iterator[Shelf]:
    """Give a store for engines of each driver."""
    if request.param == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    made = Shelf(ctx, tmp_path / "terrain", request.param)
    yield made
    made.close()


@pytest.fixture
def any_shelf(ctx, tmp_path) -> Iterator[Shelf]:
    """Give a store for engines that choose their drivers themselves."""
    made = Shelf(ctx, tmp_path / "terrain")
    yield made
    made.close()


def picture(engine: Engine, sketch, steps: dict[str, int] | None = None) -> bytes:
    return engine.render(sketch, size=(64, 36), steps=steps).array.tobytes()


# ── the same bits ────────────────────────────────────────────────────────────


def text_of_bits(form: str) -> str:
    """Return a kernel that writes random bits in a format."""
    count = len(form.rstrip("0123456789f"))
    bits = "vec4(h) / 4294967295.0"
    if form.endswith("32f"):
        bits = "uintBitsToFloat(h)"
    elif form.endswith("16f"):  # powers of two down to the least denormal: GLSL 3.30 makes no halves of bits
        bits = "(vec4(h & 2047u) - 1024.0) * exp2(vec4(ivec4(h >> 20u & 31u) - 24))"
    text = BITS.replace("FORMAT", form).replace("CAST", f"({bits}).{'xyzw'[:count]}")
    return text.replace("TYPE", {1: "float", 2: "vec2", 4: "vec4"}[count])


def sketch_of_every_format(folder, declared, read):
    """Write a sketch with a pass of bits of each format, and one that reads all of them."""
    body, reads = "", ""
    for form in FORMATS:
        folder.write(f"{form}.glsl", text_of_bits(form))
        body += f'[[pass]]\nname = "{form}"\nuse = "./{form}"\n'
        reads += f"    sum += abs({read.format(form)}.r);\n"
    inputs = "".join(f"uniform sampler2D {form}; //! {declared}\n" for form in FORMATS)
    text = f'#pragma kernel(output = "v:r32f")\n{inputs}float kernel(ivec2 texel) {{\n    float sum = 0.0;\n'
    folder.write("all.glsl", f"{text}{reads}    return 1.0 / sum;\n}}\n")
    wires = ", ".join(f'{form} = "{form}"' for form in FORMATS)
    body += f'[[pass]]\nname = "all"\nuse = "./all"\nsize = [64, 36]\ninputs = {{ {wires} }}\n'
    return folder.sketch(body, size="size = [67, 41]")


def test_reopened_textures_of_every_format_have_the_same_bits(shelf, folder):
    """Whatever their bits; the passes do not run."""
    sketch = sketch_of_every_format(folder, "input", "texelFetch({}, texel, 0)")
    first = shelf.engine()
    seen = picture(first, sketch)
    made = {form: read_raw(first.record.results[form].textures["bits"]) for form in FORMATS}
    shelf.keep(first)
    second = shelf.engine()
    assert picture(second, sketch) == seen
    assert second.record.ran == ["all", "view"]
    for form in FORMATS:
        raw = read_raw(second.record.results[form].textures["bits"])
        assert raw.dtype == made[form].dtype and raw.tobytes() == made[form].tobytes(), form
        assert len(np.unique(made[form])) > 100, f"{form}: these are bits"
    floats = made["rgba32f"]
    assert np.isnan(floats).any() and (floats.view(np.uint32) & 0x7F800000 == 0).any()


def test_cached_mipmaps_of_every_format_reload_bit_for_bit(shelf, folder, monkeypatch):
    if not shelf.engine().info.software:
        pytest.skip("a graphics card makes them anew")
    sketch = sketch_of_every_format(
        folder, 'input("linear", "mipmap")', "textureLod({}, vec2(0.4, 0.6), 2.0)"
    )
    first = shelf.engine()
    seen = picture(first, sketch)
    made = {form: levels(first, form) for form in FORMATS}
    shelf.keep(first)
    build, anew = moderngl.Texture.build_mipmaps, list[tuple[int, int]]()
    monkeypatch.setattr(
        moderngl.Texture, "build_mipmaps", lambda texture: [anew.append(texture.size), build(texture)]
    )
    second = shelf.engine()
    assert picture(second, sketch) == seen
    assert (67, 41) not in anew, "they are on disk"
    assert second.record.ran == ["all", "view"]
    for form in FORMATS:
        assert levels(second, form) == made[form], form
        assert len(made[form]) == 7 and len(made[form][-1]) == len(made[form][0]) // (67 * 41)
    for each in listed(shelf.folder):
        each.path.unlink()
    second.disk_caching.pending = True
    shelf.keep(second)  # what came from there is read back as well
    third = shelf.engine()
    assert picture(third, sketch) == seen and third.record.ran == ["all", "view"]
    assert shelf.ctx.error == "GL_NO_ERROR"


def levels(engine: Engine, form: str) -> list[bytes]:
    """Return the texels of a pass, and of each of its mipmaps."""
    texture = engine.record.results[form].textures["bits"]
    sizes = levels_of(texture.size)
    return [read_mipmap(texture, level, size) for level, size in enumerate(sizes)]


@pytest.mark.slow
def test_bits_are_the_same_where_there_is_no_compute():
    """As on macOS: OpenGL 4.1, in a process of its own."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", __file__]
    done = subprocess.run(
        [*command, "-k", "reopened_textures or reopened_sketch"],
        cwd=ROOT,
        env={**os.environ, "MESA_GL_VERSION_OVERRIDE": "4.1", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "passed" in done.stdout


def test_reopened_sketch_matches_and_runs_camera_passes_alone(shelf, worn):
    """Loops, several outputs, mipmaps and a mesh over them; the terrain itself is not even read."""
    first = shelf.engine()
    seen = picture(first, worn)
    assert set(first.runs) == {*TERRAIN_PASSES, "view"}
    shelf.keep(first)
    second = shelf.engine()
    assert picture(second, worn) == seen
    assert dict(second.runs) == {"view": 1}
    assert second.disk_caching.reads == 2 and set(second.record.results) == {
        "worn.add",
        "light",
        "view",
    }
    assert second.disk_caching.skipped == {"terrain"}
    turned = replace(worn, camera=replace(worn.camera, azimuth=worn.camera.azimuth + 40.0))
    with Engine(shelf.ctx, driver=shelf.driver) as plain:
        assert picture(second, turned) == picture(plain, turned)
    assert dict(second.runs) == {"view": 2}, "the second frame skips what the first skipped"


def test_what_was_skipped_runs_where_it_is_wanted(any_shelf, worn):
    first = any_shelf.engine()
    picture(first, worn)
    any_shelf.keep(first)
    second = any_shelf.engine()
    seen = picture(second, worn)
    second.disk_caching.skips = False
    assert picture(second, worn) == seen
    assert {"terrain", "worn.add", "light", "view"} == set(
        second.record.results
    ) and not second.disk_caching.skipped
    assert second.runs["terrain"] == 1 and second.runs["light"] == 0
    with Engine(any_shelf.ctx) as plain:
        for path in ("terrain:water", "worn", "light"):
            np.testing.assert_array_equal(second.read(worn, path), plain.read(worn, path))


@pytest.mark.parametrize("memory", [20_000, 2**24])
def test_edits_and_sessions_in_any_order_match_uncached_engine(any_shelf, worn, memory):
    """Values back and forth, loops stopped, sessions that end; also in memory too small for two terrains."""
    rng = random.Random(memory)
    sketch, reads, steps = worn, 0, {}
    engine = any_shelf.engine(cache_bytes=memory)
    with Engine(any_shelf.ctx) as plain:
        for _ in range(50):
            match rng.randrange(7):
                case 0:
                    sketch = sketch.with_values({"terrain.bumps": rng.choice((1.0, 2.0, 3.0))})
                case 1:
                    sketch = sketch.with_values({"light.sun": (rng.choice((10.0, 200.0)), 30.0)})
                case 2:
                    sketch = sketch.with_values({"worn.add.share": rng.choice((0.25, 0.5))})
                case 3:
                    engine.disk_caching.skips = not engine.disk_caching.skips
                case 4 if engine.record.plan is not None:
                    any_shelf.keep(engine)
                    reads += engine.disk_caching.reads
                    engine = any_shelf.engine(cache_bytes=memory)
                case 5:
                    steps = rng.choice(({}, {"worn": 1}, {"worn": 2}, {"terrain": 2}))
                case 6 if engine.record.plan is not None:
                    any_shelf.keep(engine)
            expected = set(engine.stale(sketch, size=(64, 36), steps=steps))
            assert picture(engine, sketch, steps) == picture(plain, sketch, steps)
            # What is read may take the place of what was still there when stale() looked.
            assert set(engine.record.ran) == expected or memory < 2**20, "stale() returns what runs"
        path = rng.choice(("terrain", "worn", "light"))
        np.testing.assert_array_equal(engine.read(sketch, path), plain.read(sketch, path))
    assert reads + engine.disk_caching.reads > 0, "the disk cache was used"


# ── what is another terrain ─────────────────────────────────────────────────────


def reopened(shelf: Shelf, sketch) -> set[str]:
    """Return the passes of the terrain that a new session runs, and see that it shows the truth."""
    engine = shelf.engine()
    with Engine(shelf.ctx, driver=shelf.driver) as plain:
        assert picture(engine, sketch) == picture(plain, sketch)
    return set(engine.runs) - {"view"}


@pytest.fixture
def cached(any_shelf, worn) -> Shelf:
    """Give a store that has the worn terrain."""
    engine = any_shelf.engine()
    picture(engine, worn)
    any_shelf.keep(engine)
    assert reopened(any_shelf, worn) == set()
    return any_shelf


def test_cached_terrain_is_invalidated_by_code_not_by_comment(cached, folder, worn):
    folder.write("terrain.glsl", "// a remark\n" + TERRAIN.replace("    water", "    // more\n  water"))
    assert reopened(cached, folder.sketch(BODY, size="size = 33")) == set()
    folder.write("terrain.glsl", TERRAIN.replace("64.0", "32.0"))
    assert reopened(cached, folder.sketch(BODY, size="size = 33")) == set(TERRAIN_PASSES)
    folder.write("terrain.glsl", TERRAIN)
    folder.write("light.glsl", LIGHT.replace('"linear", "mipmap"', '"nearest", "mipmap"'))
    assert reopened(cached, folder.sketch(BODY, size="size = 33")) == {"light"}


def test_another_value_is_another_terrain(cached, worn):
    assert reopened(cached, worn.with_values({"terrain.bumps": 3.0000001})) == set(TERRAIN_PASSES)
    assert reopened(cached, worn.with_values({"light.sun": (135.0, 31.0)})) == {"light"}
    assert reopened(cached, worn.with_values({"size": 32})) == set(TERRAIN_PASSES)


def test_another_content_of_a_file_is_another_terrain(cached, folder, worn):
    path = folder.path / "p.png"
    before = path.stat()
    write_png(path, np.full((1, 1, 4), 254, np.uint8))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + 1))
    assert reopened(cached, worn) == set(TERRAIN_PASSES)


def test_what_made_it_is_part_of_the_key(cached, worn, monkeypatch):
    """Another driver, processor or version of the playground would perhaps compute other bits."""
    ours = cached.engine().info
    monkeypatch.setattr(store_module, "tool", lambda: "another version")
    assert reopened(cached, worn) == set(TERRAIN_PASSES)
    monkeypatch.undo()
    for other in (
        replace(ours, version=f"{ours.version}.1"),
        replace(ours, renderer="llvmpipe (LLVM 99)"),
        replace(ours, version_code=410),
    ):
        assert names(disk_cache_for(other, 1, cached.folder)) != names(disk_cache_for(ours, 1, cached.folder))
    monkeypatch.setattr("playground.engine.context.processor", lambda: ("Other", "avx"))
    software = ContextInfo(450, "llvmpipe", "Mesa", "4.5", 4)
    first = names(disk_cache_for(software, 1, cached.folder))
    monkeypatch.setattr("playground.engine.context.processor", lambda: ("Other", "avx fma"))
    assert names(disk_cache_for(software, 1, cached.folder)) != first
    card = replace(software, renderer="NVIDIA H200")
    first = names(disk_cache_for(card, 1, cached.folder))
    monkeypatch.undo()
    assert names(disk_cache_for(card, 1, cached.folder)) == first, (
        "a card's bits do not depend on the processor"
    )


def names(store: DiskCache) -> str:
    return store.path_of("a key").name


def test_the_tool_is_its_own_files(monkeypatch, tmp_path):
    (tmp_path / "engine").mkdir()
    file = tmp_path / "engine" / "one.py"
    file.write_text("1")
    monkeypatch.setattr(store_module.paths, "__file__", str(tmp_path / "paths.py"))
    before = store_module.tool.__wrapped__()
    assert store_module.tool.__wrapped__() == before
    file.write_text("12")
    assert store_module.tool.__wrapped__() != before


def test_another_version_of_a_package_is_another_tool(monkeypatch, tmp_path):
    monkeypatch.setattr(store_module.paths, "__file__", str(tmp_path / "paths.py"))
    package = tmp_path / "__init__.py"
    package.write_text("1")

    def spec_of(name: str) -> ModuleSpec | None:
        return ModuleSpec(name, None, origin=str(package)) if name == "numpy" else None

    monkeypatch.setattr(store_module, "find_spec", spec_of)
    before = store_module.tool.__wrapped__()
    assert store_module.tool.__wrapped__() == before
    package.write_text("12")
    assert store_module.tool.__wrapped__() != before


def test_each_form_of_a_pass_has_its_own(ctx, folder, tmp_path):
    """By another driver the bits should be the same, but the store does not rely on it."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    sketch = folder.one('#pragma kernel(output = "v:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n')
    for driver in ("fragment", "compute"):
        shelf = Shelf(ctx, tmp_path / "terrain", driver)
        engine = shelf.engine()
        picture(engine, sketch)
        shelf.keep(engine)
        assert engine.runs["a"] == 1, driver
        shelf.close()


# ── what is never cached ───────────────────────────────────────────────────────

TIMES = """#pragma kernel(output = "v:r32f"REPEAT)
uniform sampler2D before; //! input("black")
float kernel(ivec2 texel) { return texelFetch(before, texel, 0).r + BODY; }
"""


def cached_of(shelf: Shelf, sketch, **options) -> set[str]:
    engine = shelf.engine()
    engine.render(sketch, size=(64, 36), **options)
    shelf.keep(engine)
    return {each.textures.made_for.partition(": ")[2] for each in listed(shelf.folder)}


def test_time_and_camera_passes_and_their_readers_are_not_cached(any_shelf, folder):
    timed = TIMES.replace("REPEAT", "")
    bodies = {"still": "0.5", "moves": "time", "after": "0.25", "sees": "eye.x"}
    folder.kernels(**{name: timed.replace("BODY", body) for name, body in bodies.items()})
    folder.write("grows.glsl", TIMES.replace("REPEAT", ', repeat = "2 + floor(time)"').replace("BODY", "0.1"))
    folder.write(
        "both.glsl",
        '#pragma kernel(output = "v:r32f")\nuniform sampler2D a; //! input\nuniform sampler2D b; //! input\n'
        "uniform sampler2D c; //! input\n"
        "float kernel(ivec2 texel) { return texelFetch(a, texel, 0).r + texelFetch(b, texel, 0).r"
        " + texelFetch(c, texel, 0).r; }\n",
    )
    text = passes(
        still="./still",
        moves=("./moves", 'inputs = { before = "still" }'),
        after=("./after", 'inputs = { before = "moves" }'),
        sees=("./sees", 'inputs = { before = "still" }'),
        grows=("./grows", 'inputs = { before = "still" }'),
        both=("./both", 'inputs = { a = "after", b = "sees", c = "grows" }'),
    )
    assert cached_of(any_shelf, folder.sketch(text)) == {"still"}


def test_what_has_a_texel_for_each_pixel_is_not_cached(any_shelf, folder):
    sketch = folder.one(TIMES.replace("REPEAT", "").replace("BODY", "0.5"), size="size = [64, 36]")
    assert cached_of(any_shelf, sketch) == set()
    assert cached_of(any_shelf, sketch.with_values({"size": (64, 37)})) == {"a"}


def test_what_stops_before_its_last_iteration_is_not_cached(any_shelf, folder, worn):
    assert cached_of(any_shelf, worn, steps={"terrain": 2}) == set()
    assert cached_of(any_shelf, worn, steps={"worn": 2}) == {"terrain"}
    assert cached_of(any_shelf, worn) == {"terrain", "worn.add", "light"}


class Strokes:
    """An image of one pixel that is painted in this process."""

    token = "a brush's"
    pixels = np.full((1, 1, 4), 128, np.uint8)
    version = 1

    def holds(self) -> bool:
        return True

    def changed_since(self, version: int) -> tuple[slice, slice]:
        return slice(0, 1), slice(0, 1)


def test_what_reads_a_painted_file_is_not_cached(any_shelf, folder, worn):
    """No other process knows it by that version: the cache would fill with what is never read again."""
    engine = any_shelf.engine()
    engine.painted[folder.path / "p.png"] = Strokes()
    engine.render(worn, size=(64, 36))
    any_shelf.keep(engine)
    assert not listed(any_shelf.folder)
    assert cached_of(any_shelf, worn) == {"worn.add", "light"}, "without the strokes"


def test_draw_continued_by_another_keeps_samples_and_is_uncached(any_shelf, folder):
    draw = '#pragma draw(mesh = "triangles", count = "1", output = "v:rgba16f", depth = "none")\n'
    draw += "INITIALvec4 vertex(int corner) { return vec4(corner == 1, corner == 2, 0, 1); }\n"
    draw += "vec4 fragment() { return vec4(0.5); }\n"
    folder.write("first.glsl", draw.replace("INITIAL", ""))
    folder.write("over.glsl", draw.replace("INITIAL", "uniform sampler2D initial; //! input\n"))
    body = '[[pass]]\nname = "first"\nuse = "./first"\n[[pass]]\nname = "over"\nuse = "./over"\n'
    sketch = folder.sketch(body + 'inputs = { initial = "first" }\n')
    assert cached_of(any_shelf, sketch) == set()
    alone = folder.sketch('[[pass]]\nname = "first"\nuse = "./first"\n')
    assert cached_of(any_shelf, alone) == {"first"}


def test_nothing_is_cached_unless_somebody_asks(any_engine, worn, monkeypatch, tmp_path):
    """A picture for a test must not come from a store."""
    monkeypatch.setattr(DiskCache, "read", lambda *_: pytest.fail("the disk cache was read"))
    monkeypatch.setattr(DiskCache, "write", lambda *_: pytest.fail("the disk cache was written"))
    assert any_engine.disk_caching is None
    picture(any_engine, worn)
    using = {
        p.relative_to(ROOT / "playground").as_posix()
        for p in (ROOT / "playground").rglob("*.py")
        if "engine.disk_cache" in p.read_text("utf-8")
    }
    assert {name.partition("/")[0] for name in using} == {"commands", "engine", "studio"}
    assert {name for name in using if name.startswith("commands")} == {
        "commands/cache.py",
        "commands/doctor.py",
    }


# ── damage ───────────────────────────────────────────────────────────────────


def break_at(where: float) -> Callable[[bytes], bytes]:
    def broken(data: bytes) -> bytes:
        position = min(int(where * len(data)), len(data) - 1)
        return data[:position] + bytes([data[position] ^ 0x10]) + data[position + 1 :]

    return broken


DAMAGE = {
    "empty": lambda data: b"",
    "cut": lambda data: data[: len(data) // 2],
    "cut in the header": lambda data: data[:40],
    "cut by one": lambda data: data[:-1],
    "longer": lambda data: data + b"\0",
    "foreign": lambda data: b"\x89PNG\r\n\x1a\n" + data,
    "text": lambda data: b"playground land 1\n\x05\0\0\0[1,2]" + data,
    "nested": lambda data: b"playground land 1\n" + (60000).to_bytes(4, "little") + b"[" * 60000,
    **{f"a bit at {where}": break_at(where) for where in (0.0, 0.004, 0.01, 0.02, 0.3, 0.5, 0.9, 1.0)},
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_file_is_dropped(tmp_path, damage):
    store = DiskCache(tmp_path)
    store.write("one", some(1))
    store.close()
    path = store.path_of("one")
    whole = path.read_bytes()
    path.write_bytes(DAMAGE[damage](whole))
    assert listed(tmp_path)[0].path == path
    assert store.read("one") is None and not path.exists()
    path.write_bytes(whole)
    assert store.read("one") is not None


def test_where_files_are_damaged_the_terrain_is_computed(cached, worn):
    for each in listed(cached.folder):
        each.path.write_bytes(each.path.read_bytes()[:-1])
    assert reopened(cached, worn) == set(TERRAIN_PASSES)
    assert listed(cached.folder) == []


def test_a_file_under_anothers_name_is_dropped(cached, worn):
    first, other = (each.path for each in listed(cached.folder))
    first.write_bytes(other.read_bytes())
    assert reopened(cached, worn) in ({"light"}, {"terrain", "worn.add"})
    assert not first.exists()


def test_a_texture_of_another_size_is_not_taken(cached, folder):
    """Not even where the key agrees, as with a technique whose fast variant has other outputs."""
    engine = cached.engine()
    store = engine.disk_caching.store
    sketch = folder.one('#pragma kernel(output = "v:r8")\nfloat kernel(ivec2 texel) { return 0.5; }\n')
    picture(engine, sketch)
    key = engine.keys_of(engine.record.plan).steps["a"].result
    store.write(key, CachedTextures((16, 17), (("v", "r8"),), 1.0, "", (memoryview(bytes(16 * 17)),)))
    store.close()
    assert key in store
    assert reopened(cached, sketch) == {"a"}


# ── what is worth it ─────────────────────────────────────────────────────────


def test_only_what_costs_more_than_to_read_it_is_cached(any_shelf, worn, monkeypatch):
    costs = {"terrain": 500.0, "worn": 1.0, "light": 100.0}
    monkeypatch.setattr("playground.engine.disk_caching.read_time", lambda size: 4.0)
    monkeypatch.setattr("playground.engine.software.Software.mipmap_cost", 0.0)

    def cached_with(floor: float, **more: float) -> set[str]:
        clear(any_shelf.folder)
        engine = any_shelf.engine(floor)
        picture(engine, worn)
        keys = engine.keys_of(engine.record.plan)
        engine.disk_caching.costs.clear()
        for name, cost in (costs | more).items():
            engine.disk_caching.costs.put(keys.loops.get(name) or keys.steps[name].result, cost)
        any_shelf.keep(engine)
        return {each.textures.made_for.partition(": ")[2] for each in listed(any_shelf.folder)}

    # The view reads worn and light. Wearing is cheap: the terrain is cached, and worn again.
    assert cached_with(20.0) == {"terrain", "light"}
    assert cached_with(20.0, worn=30.0) == {"worn.add", "light"}
    assert cached_with(20.0, worn=30.0, light=19.0) == {"worn.add"}, "what it reads is read anyway"
    assert cached_with(600.0) == set()
    assert cached_with(20.0, terrain=1.0, light=1.0) == set()
    assert cached_with(0.0, terrain=1.0, light=1.0) == set(), "to read takes longer"


def test_what_has_mipmaps_is_worth_more_on_a_software_renderer(any_shelf, worn, monkeypatch):
    """To make the first of a format is compiled again in each process, unless no texture needs it."""
    engine = any_shelf.engine(MIPMAPS / 2)
    if not engine.info.software:
        pytest.skip("a graphics card has nothing to compile")
    picture(engine, worn)
    assert "height" in engine.record.results["terrain"].mipmapped
    for key in engine.disk_caching.costs:
        engine.disk_caching.costs.put(key, 1.0)
    any_shelf.keep(engine)
    (result,) = [each.textures for each in listed(any_shelf.folder)]
    assert result.made_for.endswith("worn.add") and result.cost == pytest.approx(2.0)


def test_cost_is_measured_per_terrain_pass_with_loop_as_one(any_shelf, worn):
    engine = any_shelf.engine()
    picture(engine, worn)
    keys = engine.keys_of(engine.record.plan)
    expected = {keys.steps["terrain"].result, keys.loops["worn"], keys.steps["light"].result}
    assert set(engine.disk_caching.costs) == expected
    assert all(cost > 0.0 for cost in engine.disk_caching.costs.values())
    any_shelf.keep(engine)
    (light,) = (each.textures for each in listed(any_shelf.folder) if "light" in each.textures.made_for)
    assert light.cost == pytest.approx(sum(engine.disk_caching.costs.values()), abs=0.01)


def test_caching_waits_for_idle_terrain_and_reads_piece_by_piece(any_shelf, worn, monkeypatch):
    monkeypatch.setattr("playground.engine.disk_caching.PIECE", 33 * 4 * 10)  # rows of 33 floats, ten at once
    now = 100.0
    engine = any_shelf.engine()
    caching = engine.disk_caching = DiskCaching(
        engine.disk_caching.store, floor=ALWAYS, rest=1.0, now=lambda: now
    )
    assert caching.look(engine, None) is None, "nothing has been made yet"
    picture(engine, worn)
    assert caching.look(engine, engine.record.plan) == pytest.approx(1.0)
    now += 0.75
    picture(engine, worn.with_values({"terrain.bumps": 4.0}))  # a slider that moves
    assert caching.look(engine, engine.record.plan) == pytest.approx(1.0)
    now += 1.5
    iterations = 0
    while caching.look(engine, engine.record.plan) is not None:
        iterations += 1
        picture(engine, worn.with_values({"terrain.bumps": 4.0}))
    assert iterations > 4 + 4, "both textures, each in four pieces"
    caching.close()
    assert len(listed(any_shelf.folder)) == 2
    assert caching.look(engine, engine.record.plan) is None
    assert reopened(any_shelf, worn.with_values({"terrain.bumps": 4.0})) == set()


def test_a_terrain_that_goes_while_it_is_read_back_is_not_cached(any_shelf, worn, monkeypatch):
    monkeypatch.setattr("playground.engine.disk_caching.PIECE", 33 * 4 * 10)
    engine = any_shelf.engine(cache_bytes=20_000)
    engine.disk_caching.rest = 0.0
    picture(engine, worn)
    engine.disk_caching.look(engine, engine.record.plan)
    engine.disk_caching.look(engine, engine.record.plan)
    other = worn.with_values({"terrain.bumps": 9.0})
    picture(engine, other)
    any_shelf.keep(engine)
    assert reopened(any_shelf, other) == set()
    assert reopened(any_shelf, worn) == set(TERRAIN_PASSES)


def test_sketch_drawn_before_caching_is_not_stored_as_another(any_shelf, worn, folder):
    bare = folder.sketch(
        '[[pass]]\nname = "terrain"\nuse = "./terrain"\n[view]\nuse = "./light"\n'
        'inputs = { height = "terrain:height" }\n',
        size="size = 33",
    )
    engine = any_shelf.engine()
    engine.disk_caching.rest = 0.0
    picture(engine, worn)
    engine.disk_caching.look(engine, engine.record.plan)
    picture(engine, bare)
    any_shelf.keep(engine)
    assert {each.textures.made_for for each in listed(any_shelf.folder)} <= {f"{bare.name}: terrain"}
    assert "worn.add" in reopened(any_shelf, worn)


# ── the files ────────────────────────────────────────────────────────────────


def some(number: int, size: int = 64) -> CachedTextures:
    data = np.random.default_rng(number).bytes(size * size * 4)
    return CachedTextures(
        (size, size), (("height", "r32f"),), 12.5, f"terrain: {number}", (memoryview(data),)
    )


def test_a_store_gives_back_what_it_was_given(tmp_path):
    store = DiskCache(tmp_path / "deep" / "terrain")
    store.write("one", some(1))
    store.close()
    result = store.read("one")
    assert result == replace(some(1), data=result.data) and bytes(result.data[0]) == bytes(some(1).data[0])
    assert "one" in store and "two" not in store and store.read("two") is None
    assert [(each.textures, each.bytes) for each in listed(store.folder)] == [
        (replace(some(1), data=()), bytes_in(store.folder)[1])
    ]
    assert bytes_in(tmp_path / "nowhere") == (0, 0) and clear(tmp_path / "nowhere") == (0, 0)


def test_what_was_used_least_recently_goes_first(tmp_path):
    store = DiskCache(tmp_path, limit=2**30)
    for number in range(5):
        store.write(str(number), some(number))
    store.close()
    for number in range(5):
        os.utime(store.path_of(str(number)), (1000.0 + number, 1000.0 + number))
    assert store.read("0") is not None  # and so it was used
    each = bytes_in(tmp_path)[1] // 5
    trim(tmp_path, 3 * each + 10)
    assert [number for number in range(5) if str(number) in store] == [0, 3, 4]
    trim(tmp_path, 2**30, most=1)
    assert "0" in store and bytes_in(tmp_path)[0] == 1


def test_the_bound_holds_while_it_is_written(tmp_path):
    store = DiskCache(tmp_path, limit=5 * 64 * 64 * 4)
    for number in range(20):
        store.write(str(number), some(number))
    store.close()
    number, size = bytes_in(tmp_path)
    assert 3 <= number <= 4 and size <= store.limit
    assert "19" in store
    assert store.fits(64 * 64 * 4) and not store.fits(2 * 64 * 64 * 4), "none takes more than a quarter"


def test_what_was_left_half_written_goes(tmp_path):
    old, new, other = (tmp_path / name for name in (".a.part", ".b.part", "notes.txt"))
    for path in (old, new, other):
        path.write_bytes(b"x")
    os.utime(old, (1000.0, 1000.0))
    trim(tmp_path, 0)
    assert not old.exists() and new.exists() and other.exists()
    os.utime(new, (1000.0, 1000.0))
    assert clear(tmp_path) == (0, 0)
    assert not new.exists() and other.exists(), "what is not ours stays"


def test_sessions_write_read_and_clear_at_once(tmp_path):
    """Each sees a whole file or none: what is read is always right."""
    wrong: list[object] = []
    ends = threading.Event()

    def reads() -> None:
        store = DiskCache(tmp_path)
        while not ends.is_set():
            for number in range(4):
                result = store.read(str(number))
                if result is not None and bytes(result.data[0]) != bytes(some(number).data[0]):
                    wrong.append(number)

    readers = [threading.Thread(target=reads) for _ in range(2)]
    for thread in readers:
        thread.start()
    writers = [DiskCache(tmp_path, limit=3 * 64 * 64 * 4) for _ in range(2)]
    for iteration in range(40):
        for store in writers:
            store.write(str(iteration % 4), some(iteration % 4))
        if iteration % 10 == 0:
            clear(tmp_path)
    for store in writers:
        store.close()
    ends.set()
    for thread in readers:
        thread.join()
    assert not wrong and all(store.trouble == "" for store in writers)
    assert not list(tmp_path.glob("*.part"))


def test_unwritable_cache_is_reported_once_and_disabled(tmp_path):
    (tmp_path / "terrain").write_text("a file where the folder should be")
    store = DiskCache(tmp_path / "terrain")
    store.write("one", some(1))
    store.close()
    assert store.trouble.startswith("terrain cannot be cached on disk: ") and not store.fits(1)
    assert store.read("one") is None and listed(store.folder) == []


def test_a_name_that_another_session_holds_open_is_no_trouble(tmp_path, monkeypatch):
    """Windows does not rename over a file that is being read."""
    store = DiskCache(tmp_path)
    store.write("one", some(1))
    store.close()

    def refuses(*_: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, "replace", refuses)
    store.write("one", some(1))
    store.close()
    assert store.trouble == "" and store.read("one") is not None
    store.write("two", some(2))
    store.close()
    assert "cannot access" in store.trouble


def test_a_file_that_cannot_be_removed_is_no_trouble(tmp_path, monkeypatch):
    store = DiskCache(tmp_path)
    store.write("one", some(1))
    store.close()
    store.path_of("one").write_bytes(b"damaged")

    def refuses(*_: object, **__: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, "unlink", refuses)
    assert store.read("one") is None
    assert clear(tmp_path) == (0, 0)
    trim(tmp_path, 0)


@pytest.mark.parametrize(
    ("value", "size"),
    [
        ("", 2**30),
        ("0", 0),
        ("off", 0),
        ("500M", 500 * 2**20),
        ("1.5g", 3 * 2**29),
        ("2 GiB", 2**31),
        ("64kb", 2**16),
    ],
)
def test_the_environment_says_how_much(value, size):
    assert limit_in({"PLAYGROUND_CACHE": value}) == size


@pytest.mark.parametrize("value", ["much", "-1", "nan", "inf", "1e40", "1X", "M"])
def test_what_is_no_size_is_refused_in_a_sentence(value):
    with pytest.raises(ParameterError, match=f"PLAYGROUND_CACHE={value}: expected a size, as 500M"):
        limit_in({"PLAYGROUND_CACHE": value})


def test_a_writer_that_hangs_does_not_keep_a_session_from_ending(tmp_path, monkeypatch):
    goes_on = threading.Event()
    monkeypatch.setattr(store_module, "trim", lambda *_: goes_on.wait(60))
    store = DiskCache(tmp_path)
    store.write("one", some(1))
    start = time.monotonic()
    store.close(patience=0.01)
    assert time.monotonic() - start < 30
    goes_on.set()
