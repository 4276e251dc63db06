"""What is drawn a thousand times costs no more memory than once, and all of it is given back."""

from __future__ import annotations

import contextlib
import gc
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.images.files import write_png

from ..sketch_texts import passes

ROOT = Path(__file__).resolve().parents[2]
TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "3")
uniform float bumps = 3.0; //! slider(0, 1000)
uniform sampler2D image;   //! file("p.png")
float kernel(ivec2 texel) { return previous(texel) + sin(float(texel.x) * bumps)
    + texelFetch(image, ivec2(0), 0).r; }
"""
DRAW = """#pragma draw(mesh = "grid", output = "frame:rgba16f")
uniform sampler2D height; //! input("linear", "mipmap")
uniform int grid = 9;     //! slider(2, 99)
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(corner.xy * 1.8 - 0.9, textureLod(height, corner.xy, 0.0).r * 0.1, 1.0);
}
vec4 fragment(vec2 place) { return vec4(texture(height, place).rrr, 1.0); }
"""
BODY = (
    "\n"
    + passes(height="./terrain", turned=("./loop", "repeat = 3"))
    + """feedback = { height = "height" }
[view]
use = "./draw"
inputs = { height = "turned:height" }
"""
)
LOOP = """
[[pass]]
name = "add"
use = "./add"
[inputs]
height = "add.before"
[outputs]
height = "add:height"
"""
ADD = """#pragma kernel(output = "height:r32f")
uniform sampler2D before; //! input
float kernel(ivec2 texel) { return texelFetch(before, texel, 0).r * 0.9; }
"""


def total(count: Counter[str]) -> dict[str, int]:
    gc.collect()
    return {kind: number for kind, number in sorted(count.items()) if number}


def resident() -> int:
    """Return this process's memory in bytes."""
    if not sys.platform.startswith("linux"):
        pytest.skip("reads /proc")
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.fixture
def sketch(folder, tmp_path):
    write_png(tmp_path / "p.png", np.full((4, 4, 4), 255, np.uint8))
    for name, text in {"terrain": TERRAIN, "draw": DRAW, "add": ADD}.items():
        folder.write(f"{name}.glsl", text)
    folder.write("loop.toml", LOOP)
    return folder.sketch(BODY, size="size = 64")


@contextlib.contextmanager
def small_engine(ctx: moderngl.Context, driver: str) -> Iterator[Engine]:
    if driver == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver=driver, cache_bytes=512 * 1024) as engine:
        yield engine


@pytest.mark.parametrize("driver", ["fragment", "compute"])
@pytest.mark.slow
def test_five_hundred_renders_keep_no_more_than_fifty(ctx, sketch, alive, driver):
    with small_engine(ctx, driver) as engine:
        for i in range(50):
            engine.render(sketch.with_values({"height.bumps": i / 7}), size=(64, 36))
        objects, memory = total(alive), resident()
        for i in range(500):
            engine.render(sketch.with_values({"height.bumps": i / 3 + 0.1}), size=(64, 36))
        assert total(alive) == objects
        assert resident() - memory < 6 * 2**20


@pytest.mark.slow
def test_a_hundred_changed_programs_are_bounded(ctx, folder, sketch, alive):
    with small_engine(ctx, "fragment") as engine:
        seen = []
        for i in range(100):
            folder.write("terrain.glsl", TERRAIN.replace("sin", f"{i}.5 + sin"))
            engine.render(folder.sketch(BODY, size="size = 64"), size=(64, 36))
            if i in (75, 99):
                seen.append(total(alive))
        assert seen[0] == seen[1], "old programs go"
        assert len(engine.internal.runner.programs) <= 65


@pytest.mark.slow
def test_changing_sizes_and_meshes_are_bounded(ctx, sketch, alive):
    with small_engine(ctx, "fragment") as engine:
        seen = []
        for i in range(60):
            engine.render(sketch.with_values({"view.grid": 2 + i, "size": 32 + i}), size=(64 + i, 36))
            seen.append(sum(total(alive).values()))
        assert max(seen[30:]) <= max(seen[:30])


@pytest.mark.parametrize("driver", ["fragment", "compute"])
def test_release_gives_all_back(ctx, sketch, alive, driver):
    before = total(alive)
    with small_engine(ctx, driver) as engine:
        engine.internal.profiling = True
        for i in range(3):
            engine.render(sketch.with_values({"height.bumps": i}), size=(64, 36))
        list(engine.steps(sketch, "height", size=(64, 36)))
        list(engine.steps(sketch, "turned", size=(64, 36)))
        assert total(alive) != before
    assert total(alive) == before, "given back, not only forgotten"
    assert ctx.error == "GL_NO_ERROR"


def test_an_engine_that_was_released_works_again(ctx, sketch):
    engine = Engine(ctx)
    first = engine.render(sketch, size=(64, 36)).array
    engine.release()
    np.testing.assert_array_equal(engine.render(sketch, size=(64, 36)).array, first)
    engine.release()


TWO_CONTEXTS = """
import sys
import moderngl
import numpy as np
import playground
from playground.engine.engine import Engine
from playground.gpu.context import open_context
sketch = playground.load(sys.argv[1])
one = playground.headless()
first = one.render(sketch, size=(64, 36)).array
two = playground.headless()
other = [two.ctx.buffer(reserve=4) for _ in range(50)] + [two.ctx.texture((1, 1), 4) for _ in range(50)]
for engine in (one, two, one):
    engine.internal.cache.clear()
    engine.internal.pool.clear()
    assert np.array_equal(engine.render(sketch, size=(64, 36)).array, first)
    assert engine.internal.ran
two.release()
assert isinstance(two.ctx.mglo, moderngl.InvalidObject), "its own context goes with it"
one.internal.cache.clear()
assert np.array_equal(one.render(sketch, size=(64, 36)).array, first)
ctx = open_context()
with Engine(ctx) as borrowed:
    assert np.array_equal(borrowed.render(sketch, size=(64, 36)).array, first)
assert not isinstance(ctx.mglo, moderngl.InvalidObject), "a borrowed one stays"
one.release()
"""


@pytest.mark.slow
def test_each_engine_draws_in_its_own_context(sketch):
    done = subprocess.run(
        [sys.executable, "-c", TWO_CONTEXTS, sketch.file],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
