"""A pass runs again when, and only when, something that its textures depend on has changed."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.sketch.model import Camera

from ..sketch_texts import passes

TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float bumps = 3.0;   //! slider(0, 10) How many
uniform float unused = 1.0;  //! slider(0, 10) Never read
float kernel(ivec2 texel) { return fract(float(texel.x * texel.y) * bumps * 0.01); }
"""
LIGHT = """#pragma kernel(output = "light:r32f")
uniform sampler2D height; //! input
uniform vec2 sun = vec2(135.0, 30.0); //! direction
float kernel(ivec2 texel) { return texelFetch(height, texel, 0).r * sun.y; }
"""
SLOPE = """#pragma kernel(output = "slope:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) { return (texelFetch(height, texel, 0).r) / spacing.x; }
"""
SPAN = """#pragma kernel(output = "span:r32f")
float kernel(ivec2 texel) { return extent.x + relief; }
"""
CLOCK = """#pragma kernel(output = "clock:r32f")
float kernel(ivec2 texel) { return time; }
"""
FOUR = "\nextent = 1000.0\nrelief = 100.0\n" + passes(
    height="./terrain",
    slope="./slope",
    span="./span",
    clock="./clock",
    light=("./light", 'inputs = { height = "height" }'),
)
EVERYTHING = ("height", "slope", "span", "clock", "light")


@pytest.fixture
def four(folder):
    for name, text in {
        "terrain": TERRAIN,
        "light": LIGHT,
        "slope": SLOPE,
        "span": SPAN,
        "clock": CLOCK,
    }.items():
        folder.write(f"{name}.glsl", text)
    return folder.sketch(FOUR)


def ran_after(engine: Engine, sketch, time: float = 0.0) -> set[str]:
    """Return what runs to bring every pass up to date."""
    names: set[str] = set()
    for path in (*EVERYTHING, "view:frame"):
        engine.texture(sketch, path, size=(32, 18), time=time)
        names |= set(engine.record.ran)
    return names


def test_the_same_sketch_twice_runs_nothing(engine, four):
    assert ran_after(engine, four) == {*EVERYTHING, "view"}
    assert ran_after(engine, four) == set()
    assert engine.record.texels == 0
    assert engine.runs == dict.fromkeys((*EVERYTHING, "view"), 1)


def test_moving_the_light_runs_light_and_view_only(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"light.sun": (200.0, 10.0)})) == {"light", "view"}
    assert ran_after(engine, four) == set(), "both are cached"


def test_a_changed_terrain_runs_what_reads_it(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"height.bumps": 4.0})) == {"height", "slope", "light", "view"}


def test_only_what_is_requested_runs(engine, four):
    engine.texture(four, "slope")
    assert engine.record.ran == ["height", "slope"]
    assert engine.record.texels == 2 * 17 * 17


def test_a_value_that_the_text_never_uses_makes_nothing_stale(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"height.unused": 9.0})) == set()


def test_a_comment_makes_nothing_stale(engine, folder, four):
    ran_after(engine, four)
    folder.write(
        "terrain.glsl", "// a new first line\n" + TERRAIN.replace("How many", "How many bumps /* or not */")
    )
    folder.write("light.glsl", LIGHT.replace("\nfloat", "\n\n// a remark\n   float"))
    assert ran_after(engine, folder.sketch(FOUR)) == set()


def test_a_changed_text_runs_it_and_what_reads_it(engine, folder, four):
    ran_after(engine, four)
    folder.write("terrain.glsl", TERRAIN.replace("0.01", "0.02"))
    assert ran_after(engine, folder.sketch(FOUR)) == {"height", "slope", "light", "view"}


def test_a_changed_way_of_reading_an_input_runs_it(engine, folder, four):
    ran_after(engine, four)
    folder.write("light.glsl", LIGHT.replace("//! input", '//! input("linear")'))
    assert ran_after(engine, folder.sketch(FOUR)) == {"light", "view"}


def test_extent_and_relief_matter_to_texts_that_name_them(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"extent": (2000.0, 1000.0)})) == {"slope", "span"}
    assert ran_after(engine, four.with_values({"relief": 50.0})) == {"span"}


def test_time_matters_to_texts_that_name_it(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four, time=1.0) == {"clock"}
    assert ran_after(engine, four, time=0.0) == set()


def test_the_size_matters_to_all_but_the_view_of_the_same_frame(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"size": (33, 17)})) == {*EVERYTHING, "view"}


def test_the_camera_matters_to_what_names_it(engine, folder):
    folder.write(
        "eye.glsl", '#pragma kernel(output = "e:r32f")\nfloat kernel(ivec2 texel) { return eye.x; }\n'
    )
    folder.write("terrain.glsl", TERRAIN)
    sketch = folder.sketch(passes(height="./terrain", e="./eye"))
    engine.texture(sketch, "e")
    engine.texture(sketch, "height")
    turned = replace(sketch, camera=replace(sketch.camera, azimuth=10.0))
    engine.texture(turned, "height")
    assert engine.record.ran == []
    engine.texture(turned, "e")
    assert engine.record.ran == ["e"]


def test_a_file_matters_by_its_contents(engine, folder, tmp_path):
    picture = np.full((4, 4, 4), 255, np.uint8)
    write_png(tmp_path / "p.png", picture)
    sketch = folder.one(
        '#pragma kernel(output = "p:r32f")\nuniform sampler2D image; //! file("p.png")\n'
        "float kernel(ivec2 texel) { return texelFetch(image, texel / 5, 0).r; }\n"
    )
    assert engine.read(sketch, "a").max() == 1.0
    os.utime(tmp_path / "p.png", ns=(1, 1))  # another time, the same contents
    engine.texture(sketch, "a")
    assert engine.record.ran == []
    write_png(tmp_path / "p.png", picture // 255)
    assert engine.read(sketch, "a").max() < 0.001
    assert engine.record.ran == ["a"]


def test_visit_count_may_depend_on_parameter_unused_in_code(any_engine, folder):
    kernel = """#pragma kernel(output = "h:r32f", repeat = "2", visits = "count, 1")
uniform int count = 3; //! slider(1, 17)
ivec2 visit(ivec2 cell) { return cell; }
float kernel(ivec2 texel) { return previous(texel) + 1.0; }
"""
    if not any_engine.info.compute:
        pytest.skip("without compute every texel is run")
    sketch = folder.one(kernel)
    assert (any_engine.read(sketch, "a") > 0).sum() == 3
    assert (any_engine.read(sketch.with_values({"a.count": 5}), "a") > 0).sum() == 5


def test_the_driver_and_the_form_enter_the_key(ctx, four):
    with Engine(ctx, driver="fragment") as engine, Engine(ctx, driver="auto") as two:
        engine.texture(four, "height")
        two.texture(four, "height")
        assert set(engine.cache._cached) == set(two.cache._cached), "auto draws a plain kernel by fragment"
    if ctx.version_code >= 430:
        with Engine(ctx, driver="compute") as three:
            three.texture(four, "height")
            assert set(three.cache._cached) != set(engine.cache._cached)


# ── the bound ────────────────────────────────────────────────────────────────


def test_the_cache_keeps_its_bound_and_drops_the_oldest(ctx, folder):
    sketch = folder.one(TERRAIN, size="size = 64")  # 16 KiB
    each = 64 * 64 * 4
    with Engine(ctx, cache_bytes=4 * each) as engine:
        for bumps in range(10):
            engine.texture(sketch.with_values({"a.bumps": bumps}), "a")
            assert engine.cache.bytes <= 4 * each
        assert len(engine.cache) == 4
        for bumps, runs in ((9, 0), (6, 0), (5, 1), (9, 0), (7, 1)):
            engine.texture(sketch.with_values({"a.bumps": bumps}), "a")
            assert len(engine.record.ran) == runs, f"bumps {bumps}"


def test_what_a_frame_uses_is_cached_even_over_the_bound(ctx, four):
    with Engine(ctx, cache_bytes=1000) as engine:
        values = engine.read(four, "light", size=(32, 18))
        assert engine.cache.bytes == 2 * 17 * 17 * 4 > 1000
        assert values.shape == (17, 17)
        engine.texture(four, "span")
        assert engine.cache.bytes == 17 * 17 * 4, "the next frame needs one texture only"


def test_a_texture_lives_until_the_next_frame(ctx, four):
    with Engine(ctx, cache_bytes=0) as engine:
        texture = engine.texture(four, "span")
        assert np.frombuffer(texture.read(), "f4")[0] == 1100.0


def test_mipmaps_count(ctx, folder):
    folder.write(
        "far.glsl", LIGHT.replace("//! input", '//! input("linear", "mipmap")').replace("height", "a")
    )
    folder.write("one.glsl", TERRAIN)
    sketch = folder.sketch(passes(a="./one", b="./far"), size="size = 64")
    with Engine(ctx) as engine:
        engine.texture(sketch, "a")
        before = engine.cache.bytes
        engine.texture(sketch, "b")
        assert engine.cache.bytes == 2 * before + before // 3


def test_keys_and_plan_take_little_time(any_engine, four):
    import time

    any_engine.texture(four, "light", size=(32, 18))
    spent = []
    for i in range(30):
        start = time.process_time()  # of this process: others on the machine do not count
        any_engine.texture(four, "light", size=(32, 18), time=float(i))
        spent.append(time.process_time() - start)
    assert any_engine.record.ran == []
    assert min(spent) < 0.02, "a second of Python in every frame would be felt"


CHANGES = {
    "relief": lambda four: four.with_values({"relief": 150.0}),
    "extent": lambda four: four.with_values({"extent": (2000.0, 1000.0)}),
    "camera": lambda four: four.with_camera(Camera(azimuth=77.0)),
    "a value": lambda four: four.with_values({"light.sun": (90.0, 10.0)}),
    "nothing": lambda four: four,
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_would_run_is_what_runs_and_asking_changes_nothing(engine, folder, four, what):
    four = folder.sketch(f'{FOUR}[view]\nuse = "view/terrain"\n')
    engine.draw(four, size=(32, 18))
    plan, drawn = engine.record.plan, engine.drawn()
    changed = CHANGES[what](four)
    would = engine.stale(changed, size=(32, 18))
    fingerprint = engine.fingerprint(changed, size=(32, 18))
    assert engine.record.plan is plan and engine.drawn() == drawn
    assert (fingerprint == engine.fingerprint(four, size=(32, 18))) == (what == "nothing")
    engine.draw(changed, size=(32, 18))
    assert engine.record.ran == would
    assert bool(would) == (what != "nothing")


def save_silently(path, data: bytes) -> None:
    """Save other contents in place, of the same size, inode and time of change, as ``cp -p`` does."""
    before = path.stat()
    path.write_bytes(data)
    os.utime(path, (1e9, 1e9))
    assert (path.stat().st_ino, path.stat().st_size) == (before.st_ino, before.st_size)


def test_saves_that_keep_inode_size_and_time_are_drawn(any_engine, folder, tmp_path):
    """Many at once: some of them fall into one tick of the file system's clock."""
    pragma = '#include "part.glsl"\n#pragma kernel(output = "height:r32f")\n'
    kernel = pragma + "float kernel(ivec2 texel) {{ return {}.0 * part(); }}\n"
    ramp = np.linspace(0.0, 1.0, 17 * 17, dtype=np.float32).reshape(17, 17)
    folder.write("k.glsl", kernel.format(0))
    folder.write("part.glsl", "float part() { return 0.0; }\n")
    np.save(tmp_path / "ramp.npy", ramp)
    head = (tmp_path / "ramp.npy").read_bytes()[: -ramp.nbytes]
    elevation = 'set = { elevation = "ramp.npy", first_row = "south" }'
    folder.sketch(passes(a="./k", b=("generation/heightmap", elevation)))
    for value in range(1, 9):
        save_silently(tmp_path / "k.glsl", kernel.format(value).encode())
        save_silently(tmp_path / "part.glsl", f"float part() {{ return {value}.0; }}\n".encode())
        save_silently(tmp_path / "ramp.npy", head + (ramp**value).tobytes())
        assert any_engine.read(tmp_path / "sketch.toml", "a")[0, 0] == value * value
        np.testing.assert_allclose(any_engine.read(tmp_path / "sketch.toml", "b"), ramp**value, atol=1e-6)


@pytest.mark.parametrize(
    ("ref", "change", "reasons"),
    [
        ("light", {"height.bumps": 4.0}, {"height": ("value bumps",), "light": ("input height",)}),
        ("light", {"light.sun": (1.0, 2.0)}, {"light": ("value sun",)}),
        ("span", {"relief": 50.0}, {"span": ("given relief",)}),
        ("slope", {"extent": (500.0, 500.0)}, {"slope": ("given spacing",)}),
        ("slope", {"size": 9}, {"height": ("size",), "slope": ("size", "input height", "given spacing")}),
    ],
)
def test_the_keys_of_two_frames_say_why_a_pass_ran(engine, four, ref, change, reasons):
    engine.texture(four, ref)
    assert {path: engine.record.reasons(path) for path in engine.record.ran} == dict.fromkeys(
        engine.record.ran, ("the pass",)
    )
    engine.texture(four.with_values(change), ref)
    assert {path: engine.record.reasons(path) for path in engine.record.ran} == reasons


def test_a_text_a_file_and_a_dropped_texture_are_reasons_too(engine, folder, four):
    engine.texture(four, "slope")
    folder.write("slope.glsl", SLOPE.replace(").r)", ").r * 2.0)"))
    engine.texture(folder.sketch(FOUR), "slope")
    assert engine.record.reasons("slope") == ("text",)
    engine.cache.clear()
    engine.texture(folder.sketch(FOUR), "slope")
    assert engine.record.ran == ["height", "slope"]
    assert engine.record.reasons("slope") == ()
