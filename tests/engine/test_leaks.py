"""What is drawn a thousand times costs no more memory than once, and all of it is given back."""

from __future__ import annotations

import contextlib
import gc
import os
import subprocess
import sys
import threading
import warnings
import weakref
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from playground.api import headless
from playground.data.image_files import write_png
from playground.engine import programs as programs_module
from playground.engine.cache import VERSIONS
from playground.engine.context import open_context, open_contexts, release_context
from playground.engine.engine import Engine
from playground.errors import ContextError

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


def run_alone(script: str, *arguments: str) -> str:
    """Run a script in a process of its own, and return what it prints."""
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def sketch(folder, tmp_path):
    write_png(tmp_path / "p.png", np.full((4, 4, 4), 255, np.uint8))
    folder.kernels(terrain=TERRAIN, draw=DRAW, add=ADD)
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
        assert len(engine.runner.programs) <= 65


def test_freed_memory_is_given_back_once_after_compiling(ctx, folder, sketch, monkeypatch):
    given_back: list[int] = []
    with small_engine(ctx, "fragment") as engine:
        programs = engine.runner.programs
        monkeypatch.setattr(programs_module, "trim_heap", lambda: given_back.append(programs.compiled))
        for i in range(3):
            folder.write("terrain.glsl", TERRAIN.replace("sin", f"{i}.25 + sin"))
            changed = folder.sketch(BODY, size="size = 64")
            for bumps in (1.0, 2.0):  # another value compiles nothing
                engine.render(changed.with_values({"height.bumps": bumps}), size=(64, 36))
                programs.rest()
        assert len(given_back) == 3 and given_back[-1] == programs.compiled


def test_texts_before_a_loop_leave_few_versions_of_it(ctx, folder, sketch):
    with Engine(ctx) as engine:
        seen = []
        for i in range(4 * VERSIONS):
            folder.write("terrain.glsl", TERRAIN.replace("sin", f"{i}.75 + sin"))
            engine.render(folder.sketch(BODY, size="size = 64"), size=(64, 36))
            seen.append((len(engine.cache), engine.cache.bytes, engine.runner.pool.made))
        assert seen[-1] == seen[2 * VERSIONS], "the textures of earlier texts are used again"


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
        engine.options.profiling = True
        for i in range(3):
            engine.render(sketch.with_values({"height.bumps": i}), size=(64, 36))
        list(engine.steps(sketch, "height", size=(64, 36)))
        list(engine.steps(sketch, "turned", size=(64, 36)))
        assert total(alive) != before
    assert total(alive) == before, "given back, not only forgotten"
    assert ctx.error == "GL_NO_ERROR"


def test_traces_hold_no_more_with_time_and_give_all_back(ctx, sketch, alive):
    before, seen = total(alive), []
    with small_engine(ctx, "fragment") as engine:
        for i in range(40):
            engine.render(sketch.with_values({"height.bumps": i}), size=(64, 36))
            for path, texel in (("height", (i, 3)), ("turned", (8, i)), ("view", (32, 18))):
                assert engine.trace_frame(path, texel=texel).calls
            seen.append(sum(total(alive).values()))
        assert max(seen[20:]) <= max(seen[:20])
    assert total(alive) == before


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
from playground.errors import ContextError
from playground.engine.context import open_context
sketch = playground.load(sys.argv[1])
one = playground.headless()
first = one.render(sketch, size=(64, 36)).array
two = playground.headless()
other = [two.ctx.buffer(reserve=4) for _ in range(50)] + [two.ctx.texture((1, 1), 4) for _ in range(50)]
for engine in (one, two, one):
    engine.cache.clear()
    engine.runner.pool.clear()
    assert np.array_equal(engine.render(sketch, size=(64, 36)).array, first)
    assert engine.record.ran
two.release()
assert isinstance(two.ctx.mglo, moderngl.InvalidObject), "its own context goes with it"
one.cache.clear()
assert np.array_equal(one.render(sketch, size=(64, 36)).array, first)
ctx = open_context()
with Engine(ctx) as borrowed:
    assert np.array_equal(borrowed.render(sketch, size=(64, 36)).array, first)
assert not isinstance(ctx.mglo, moderngl.InvalidObject), "a borrowed one stays"
one.release()
"""


@pytest.mark.slow
def test_each_engine_draws_in_its_own_context(sketch):
    run_alone(TWO_CONTEXTS, sketch.file)


class Textures:
    """Textures and buffers of a context, whose names other contexts use too; their bytes must stay."""

    def __init__(self, ctx: moderngl.Context) -> None:
        ctx.__enter__()
        self.ctx = ctx
        self.texels = [bytes([i, 1, 2, 3]) for i in range(200)]
        self.textures = [ctx.texture((1, 1), 4, data=texel) for texel in self.texels]
        self.buffers = [ctx.buffer(texel) for texel in self.texels]

    def assert_intact(self) -> None:
        gc.collect()
        self.ctx.__enter__()
        assert [texture.read() for texture in self.textures] == self.texels
        assert [buffer.read() for buffer in self.buffers] == self.texels
        assert self.ctx.error == "GL_NO_ERROR"


@pytest.fixture
def other() -> Iterator[Textures]:
    """Give textures and buffers in a second context, which is current."""
    ctx = open_context()
    yield Textures(ctx)
    release_context(ctx)


def dropped(engine: Engine) -> None:
    """Drop an engine that is part of a cycle, as one that a traceback holds is."""
    engine.itself = engine  # type: ignore[attr-defined]


@pytest.mark.parametrize("driver", ["fragment", "compute"])
def test_a_dropped_engine_frees_nothing_of_others(sketch, other, driver):
    for i in range(3):
        engine = headless(driver=driver)
        engine.render(sketch.with_values({"height.bumps": i}), size=(64, 36))
        context = weakref.ref(engine.ctx)
        other.assert_intact()  # makes the other context current
        dropped(engine)
        del engine
        other.assert_intact()
        assert context() is None, "nothing holds it"


def test_an_engine_that_cannot_be_opened_leaves_no_context():
    before = open_contexts()
    with pytest.raises(ContextError, match="driver 'cuda'") as caught:
        headless(driver="cuda")
    assert open_contexts() == before
    assert caught.traceback, "whose frames still refer to the context"


def test_a_texture_outlives_its_dropped_engine(sketch, other):
    engine = headless()
    texture = engine.texture(sketch, "height", size=(64, 36))
    values, context = texture.read(), weakref.ref(engine.ctx)
    dropped(engine)
    del engine
    other.assert_intact()
    texture.ctx.__enter__()
    assert texture.read() == values
    del texture
    other.assert_intact()
    assert context() is None


def test_a_texture_of_a_released_engine_frees_nothing(sketch, other):
    with headless() as engine:
        texture = engine.texture(sketch, "height", size=(64, 36))
    other.assert_intact()
    del engine, texture
    other.assert_intact()


def test_dropped_engines_do_not_pile_up(sketch):
    contexts = []
    gc.disable()  # as it may be long before Python looks for garbage
    try:
        for _ in range(8):
            engine = headless()
            engine.render(sketch, size=(64, 36))
            contexts.append(weakref.ref(engine.ctx))
            dropped(engine)
        assert sum(context() is not None for context in contexts) <= 4
    finally:
        gc.enable()
        del engine
        gc.collect()  # here, before another thread happens to


@pytest.mark.parametrize("mode", ["auto", "context_gc", None])
def test_an_engine_dropped_on_a_users_context_is_reported(sketch, other, mode):
    ctx = open_context()
    ctx.gc_mode = mode
    for _ in range(2):
        engine = Engine(ctx)
        first = engine.render(sketch, size=(64, 36)).array
        other.assert_intact()
        dropped(engine)
        del engine
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            other.assert_intact()
        assert [(w.category, "release()" in str(w.message)) for w in caught] == [(ResourceWarning, True)]
    with Engine(ctx) as engine:
        np.testing.assert_array_equal(engine.render(sketch, size=(64, 36)).array, first)
    release_context(ctx)


def test_an_engine_dropped_in_another_thread_waits(sketch, other):
    opened, dropped_elsewhere = threading.Event(), threading.Event()
    engines: list[Engine] = []
    pictures: list[NDArray[np.uint8]] = []

    def work() -> None:
        engines.append(headless())
        pictures.append(engines[0].render(sketch, size=(64, 36)).array)
        opened.set()
        assert dropped_elsewhere.wait(30)
        with headless() as engine:  # destroys what was dropped
            pictures.append(engine.render(sketch, size=(64, 36)).array)
        engines.append(engine)

    thread = threading.Thread(target=work, name="worker")
    thread.start()
    assert opened.wait(30)
    dropped(engines.pop())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        other.assert_intact()
    assert ["thread 'worker'" in str(w.message) for w in caught] == [True]
    dropped_elsewhere.set()
    thread.join(30)
    np.testing.assert_array_equal(*pictures)
    engines.clear()  # one that was released is nothing to report
    other.assert_intact()


def test_an_engine_whose_thread_has_ended_is_reported(sketch, other):
    engines: list[Engine] = []
    thread = threading.Thread(target=lambda: engines.append(headless()), name="worker")
    thread.start()
    thread.join(30)
    dropped(engines.pop())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        other.assert_intact()
    assert ["that thread has ended" in str(w.message) for w in caught] == [True]


THREADS = """
import sys
import threading
from pathlib import Path
import playground
sketch = playground.load(sys.argv[1])
def work():
    with playground.headless() as engine:
        engine.render(sketch, size=(64, 36))
for count in (12, 24):
    for _ in range(count):
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    print(int(Path("/proc/self/statm").read_text().split()[1]) * 4096)
"""


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_threads_that_release_engines_leave_no_memory(sketch):
    early, late = map(int, run_alone(THREADS, sketch.file).split())
    assert late - early < 24 * 2**20  # a context is some 10 MiB
