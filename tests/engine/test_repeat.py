"""A kernel that repeats gives what the same loop gives in NumPy, ends when settled, and stops anywhere."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from math import isqrt
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.engine.programs import Program
from playground.errors import PlaygroundError
from playground.sketch.model import Keyframe, Sketch

from ..loading import load
from ..sketch_texts import map_of, passes

COUNT = """#pragma kernel(output = "a:r32f", repeat = "count")
uniform int count = 5; //! slider(0, 50)
float kernel(ivec2 texel) { return previous(texel) * 2.0 + float(iteration) + 0.25 * float(iterations); }
"""
SPREAD = """#pragma kernel(output = "a:r32f", repeat = "4")
uniform sampler2D start; //! input
float kernel(ivec2 texel) {
    return (previous(texel + ivec2(1, 0)) + previous(texel - ivec2(1, 0))
          + previous(texel + ivec2(0, 1)) + previous(texel - ivec2(0, 1))) * 0.25;
}
"""
NUMBERS = """#pragma kernel(output = "n:r32f")
float kernel(ivec2 texel) { return float((texel.x * 7 + texel.y * 13) % 11); }
"""
WITH_START = "\n" + passes(n="./numbers", a=("./one", 'inputs = { initial = "n" }'))


def numbers(ny: int = 17, nx: int = 17) -> np.ndarray:
    y, x = np.mgrid[0:ny, 0:nx]
    return ((x * 7 + y * 13) % 11).astype(np.float64)


def counted(iterations: int, whole: int | None = None) -> float:
    value = 0.0
    for iteration in range(iterations):
        value = value * 2.0 + iteration + 0.25 * (iterations if whole is None else whole)
    return value


@pytest.mark.parametrize("iterations", [1, 2, 5, 6])
def test_previous_is_the_iteration_before_and_zero_on_the_first(engine, folder, iterations):
    sketch = folder.one(COUNT).with_values({"a.count": iterations})
    np.testing.assert_array_equal(
        engine.read(sketch, "a"), np.full((17, 17), counted(iterations), np.float32)
    )
    assert engine.record.texels == 17 * 17 * iterations
    assert engine.runs["a"] == 1


def test_no_iteration_at_all_gives_zeros(engine, folder):
    sketch = folder.one(COUNT).with_values({"a.count": 0})
    assert not engine.read(sketch, "a").any()


def test_stopping_early_gives_the_state_on_the_way(engine, folder):
    """``iterations`` stays the count of all iterations: a picture on the way is one of the way."""
    sketch = folder.one(COUNT)
    for iteration in (0, 1, 3, 5, 2):
        result = engine.read(sketch, "a", steps={"a": iteration})
        assert result[3, 4] == counted(iteration, whole=5)


def test_steps_go_on_from_iteration_to_iteration(engine, folder):
    sketch = folder.one(COUNT)
    texels = []
    for iteration, values in engine.steps(sketch, "a"):
        assert values[0, 0] == counted(iteration, whole=5)
        texels.append(engine.record.texels // (17 * 17))
    assert texels == [1, 1, 1, 1, 1, 1], "each iteration is run once; the first is the empty texture"


def test_steps_of_what_does_not_repeat_have_a_sentence(engine, folder):
    sketch = folder.one(NUMBERS)
    with pytest.raises(PlaygroundError, match=r"no .*pass 'b'"):
        list(engine.steps(sketch, "b"))


@pytest.mark.parametrize("shape", [(17, 17), (33, 9)])
def test_neighbours_are_clamped_at_the_border(engine, folder, shape):
    folder.write("numbers.glsl", NUMBERS)
    folder.write("one.glsl", SPREAD.replace("uniform sampler2D start; //! input\n", ""))
    sketch = folder.sketch(WITH_START, size=f"size = [{shape[1]}, {shape[0]}]")
    state = numbers(*shape)
    for _ in range(4):
        far = np.pad(state, 1, mode="edge")
        state = (far[1:-1, 2:] + far[1:-1, :-2] + far[2:, 1:-1] + far[:-2, 1:-1]) / 4
    np.testing.assert_allclose(engine.read(sketch, "a"), state, rtol=1e-6)


def test_initial_is_what_the_first_iteration_reads(engine, folder):
    folder.write("numbers.glsl", NUMBERS)
    folder.write("one.glsl", COUNT)
    sketch = folder.sketch(WITH_START).with_values({"a.count": 2})
    expected = (numbers() * 2 + 0 + 0.5) * 2 + 1 + 0.5
    np.testing.assert_array_equal(engine.read(sketch, "a"), expected.astype(np.float32))
    np.testing.assert_array_equal(engine.read(sketch, "a", steps={"a": 0}), numbers().astype(np.float32))
    np.testing.assert_array_equal(engine.read(sketch, "n"), numbers().astype(np.float32), "it is left alone")


def test_an_initial_of_another_size_has_a_sentence(engine, folder):
    folder.write("numbers.glsl", NUMBERS)
    folder.write("one.glsl", COUNT)
    sketch = folder.sketch(WITH_START.replace('use = "./numbers"', 'use = "./numbers"\nsize = 9'))
    with pytest.raises(PlaygroundError, match=r"initial is 9 x 9 texels, the pass 17 x 17"):
        engine.read(sketch, "a")


TWO = """#pragma kernel(output = "a:r32f, b:rg32f", repeat = "3")
void kernel(ivec2 texel, out float a, out vec2 b) {
    a = previous_a(texel) + 1.0;
    b = vec2(previous_b(texel).y + previous_a(texel), previous_b(texel).x + 2.0);
}
"""


def test_several_outputs_change_places_together(engine, folder):
    folder.write("one.glsl", TWO)
    folder.write("numbers.glsl", NUMBERS)
    sketch = folder.sketch(passes(n="./numbers", p=("./one", 'inputs = { initial_a = "n" }')))
    a, b = numbers(), np.zeros((17, 17, 2))
    for _ in range(3):
        a, b = a + 1, np.stack([b[..., 1] + a, b[..., 0] + 2], axis=-1)
    np.testing.assert_array_equal(engine.read(sketch, "p:a"), a)
    np.testing.assert_array_equal(engine.read(sketch, "p:b"), b)


VISITS = """#pragma kernel(output = "a:r32f, b:rgba16f", repeat = "3", visits = "size.x - 1 - iteration, 2")
ivec2 visit(ivec2 cell) {
    if (cell.x == 3) return ivec2(-1);
    return ivec2(cell.x + 1 + iteration, cell.y * 4 + iteration);
}
bool visited(ivec2 texel) {
    int x = texel.x - 1 - iteration;
    return x >= 0 && x != 3 && (texel.y == iteration || texel.y == 4 + iteration);
}
void kernel(ivec2 texel, out float a, out vec4 b) {
    a = previous_a(texel);
    b = previous_b(texel);
    if (!visited(texel)) return;
    a = previous_a(texel - ivec2(0, 1)) + float(iteration + 1);
    b += vec4(1.0, 0.5, float(texel.x), 1.0);
}
"""


def test_visits_give_the_same_in_place_and_by_every_texel(engine, folder):
    sketch = folder.one(VISITS)
    a, b = np.zeros((17, 17)), np.zeros((17, 17, 4))
    for iteration in range(3):
        before = a.copy()
        for x in range(17):
            for y in (iteration, 4 + iteration):
                if x - 1 - iteration >= 0 and x - 1 - iteration != 3:
                    a[y, x] = before[max(y - 1, 0), x] + iteration + 1
                    b[y, x] += (1.0, 0.5, x, 1.0)
    np.testing.assert_array_equal(engine.read(sketch, "a:a"), a)
    np.testing.assert_array_equal(engine.read(sketch, "a:b"), b)


def test_steps_of_visits_go_on_in_place(engine, folder):
    sketch = folder.one(VISITS)
    whole = engine.read(sketch, "a:a").copy()
    values = [values for _, values in engine.steps(sketch, "a")]
    assert len(values) == 4
    np.testing.assert_array_equal(values[-1], whole)
    assert not values[0].any()


def test_a_repeat_that_reads_time_goes_on_and_starts_again(engine, folder):
    kernel = COUNT.replace('"count"', '"floor(time)"').replace("iterations", "1")
    sketch = folder.one(kernel)
    texels = []
    for time in (0.0, 3.0, 3.5, 7.0, 2.0):
        value = engine.read(sketch, "a", time=time)[0, 0]
        fresh = 0.0
        for iteration in range(int(time)):
            fresh = fresh * 2.0 + iteration + 0.25
        assert value == fresh
        texels.append(engine.record.texels // 17**2)
    assert texels == [1, 3, 0, 4, 2]


AT_ONCE = """#pragma kernel(output = "a:r32f", repeat = "count", at_once = "most")
uniform int count = 11; //! slider(0, 50)
uniform int most = 4; //! slider(0, 50)
float kernel(ivec2 texel) {
    float found = previous(texel);
    for (int i = iteration; i < until; i++) found = found * 1.5 + float(i) + 0.25 * float(iterations);
    return found;
}
"""


@pytest.mark.parametrize("most", [0, 1, 2, 4, 11, 50])
@pytest.mark.parametrize("stopped", [0, 1, 5, 11])
def test_iterations_taken_at_once_give_what_they_give_one_by_one(engine, folder, most, stopped):
    sketch = folder.one(AT_ONCE).with_values({"a.most": most})
    value = np.float32(0)
    for iteration in range(stopped):
        value = value * np.float32(1.5) + np.float32(iteration) + np.float32(0.25 * 11)
    result = engine.read(sketch, "a", steps={"a": stopped})
    np.testing.assert_array_equal(result, np.full((17, 17), value, np.float32))


@pytest.mark.parametrize(("most", "runs"), [(1, 11), (4, 3), (50, 1)])
def test_iterations_at_once_take_so_many_runs(engine, folder, monkeypatch, most, runs):
    started = []
    for name in ("fill", "run"):
        usual = getattr(Program, name)

        def counted(self, *groups, usual=usual):
            started.append("count" in self.uniforms or "iteration" in self.uniforms)
            usual(self, *groups)

        monkeypatch.setattr(Program, name, counted)
    engine.read(folder.one(AT_ONCE).with_values({"a.most": most}), "a")
    assert sum(started) == runs


def test_step_of_batched_iterations_continues_from_previous(engine, folder):
    sketch = folder.one(AT_ONCE).with_values({"a.most": 50})
    steps = [(iteration, values.copy()) for iteration, values in engine.steps(sketch, "a")]
    assert [iteration for iteration, _ in steps] == list(range(12))
    np.testing.assert_array_equal(steps[-1][1], engine.read(sketch, "a"))


# Every texel of an ever finer lattice is its south-western neighbour a stride away, plus the iteration.
LATTICE = """#pragma kernel(output = "a:r32f", repeat = "log2(size.x - 1) + 1", STRIDE
    visits = "2**iteration + 1, (size.y - 1) // (size.x - 1) * 2**iteration + 1")
int stride() { return (size.x - 1) >> iteration; }
ivec2 visit(ivec2 cell) {
    bool known = iteration > 0 && ((cell.x | cell.y) & 1) == 0;
    return known ? ivec2(-1) : cell * stride();
}
float kernel(ivec2 texel) {
    int s = stride();
    bool here = ((texel.x | texel.y) & (s - 1)) == 0;
    bool known = iteration > 0 && ((texel.x | texel.y) & (2 * s - 1)) == 0;
    if (!here || known) return previous(texel);
    ivec2 coarse = ivec2(~(2 * s - 1)) & texel;
    float before = iteration == 0 ? 0.0 : previous(coarse) * 0.5;
    return before + float(iteration + 1) + 0.001 * float(texel.x - coarse.x);
}
""".replace("STRIDE\n    ", "STRIDE")


@pytest.mark.parametrize("size", ["2", "17", "[17, 33]"])
def test_closing_lattice_gives_same_bits_with_and_without_stride(ctx, folder, size):
    result = []
    for stride, driver in (("", "fragment"), (' stride = "(size.x - 1) // 2**iteration",', "fragment")):
        text = LATTICE.replace("STRIDE", stride)
        with Engine(ctx, driver=driver) as engine:
            sketch = folder.one(text, size=f"size = {size}")
            iterations = [values.copy() for _, values in engine.steps(sketch, "a")]
        with Engine(ctx, driver=driver) as engine:
            iterations += [
                engine.read(sketch, "a", steps={"a": iteration}).copy()
                for iteration in (len(iterations) - 1, 1)
            ]
        with Engine(ctx, driver=driver) as engine:
            iterations.append(engine.read(sketch, "a").copy())
            result.append(iterations)
    assert len(result[0]) == len(result[1]) > 2
    for plain, strided in zip(*result, strict=True):
        np.testing.assert_array_equal(plain, strided)
    if ctx.version_code >= 430:
        with Engine(ctx, driver="compute") as engine:
            np.testing.assert_array_equal(engine.read(sketch, "a"), result[0][-1])


def test_a_stride_that_is_no_power_of_two_is_refused(ctx, folder):
    sketch = folder.one(LATTICE.replace("STRIDE", ' stride = "3",'))
    with Engine(ctx, driver="fragment") as engine, pytest.raises(PlaygroundError, match="power of two"):
        engine.read(sketch, "a")


@pytest.mark.parametrize("left", [1e9, 0.7, -3e38])
def test_iteration_ignores_stale_contents_of_its_texture(engine, folder, left):
    text = """#pragma kernel(output = "a:r32f", repeat = "4")
    float kernel(ivec2 texel) { return iteration < 2 ? LEFT : 0.123 + 0.0 * previous(texel); }
    """.replace("LEFT", f"{left:.1e}").replace("\n    ", "\n")
    result = engine.read(folder.one(text), "a")
    np.testing.assert_array_equal(result, np.full((17, 17), 0.123, np.float32))


def test_keyframes_may_lower_iteration_count_below_stop(any_engine):
    """In a film the count may fall below what was asked for at its beginning."""
    sketch = load("fault_formation")
    names = {"height.iterations": 12}
    frames = (Keyframe(0.0, values=tuple(names.items())), Keyframe(1.0, values=(("height.iterations", 4),)))
    moving = replace(sketch.with_values({"size": 33}), keyframes=frames)
    for seconds, runs in ((0.0, 8), (1.0, 4)):
        plan = any_engine.plan(moving, (16, 9), seconds, {"height.sum": 8})
        assert max(step.repeat for step in plan.walk() if step.path.startswith("height.sum")) == runs


# ── going on when the count grows ────────────────────────────────────────────

ADD = """#pragma kernel(output = "a:r32f, b:rg16f", repeat = "count")
uniform int count = 3;     //! slider(0, 50)
uniform float rate = 0.5;  //! slider(0, 1)
void kernel(ivec2 texel, out float a, out vec2 b) {
    a = previous_a(texel) * rate + float(iteration) + previous_a(texel + ivec2(1, 0));
    b = previous_b(texel) + vec2(1.0, a * 0.001);
}
"""


SUM = """#pragma kernel(output = "sum:r32f")
uniform sampler2D a; //! input
uniform sampler2D b; //! input
float kernel(ivec2 texel) { return texelFetch(a, texel, 0).r + texelFetch(b, texel, 0).r; }
"""


def test_more_iterations_go_on_from_those_that_are_cached(ctx, engine, folder):
    sketch = folder.one(ADD)
    taken = []
    for count in (3, 10, 11, 4, 20):
        result = engine.read(sketch.with_values({"a.count": count}), "a:a").copy()
        taken.append(engine.record.texels // 17**2)
        with Engine(ctx, driver=engine.driver) as fresh:
            np.testing.assert_array_equal(result, fresh.read(sketch.with_values({"a.count": count}), "a:a"))
    assert taken == [3, 7, 1, 4, 16]


def test_what_names_iterations_begins_again(engine, folder):
    sketch = folder.one(COUNT)
    for count in (3, 5):
        result = engine.read(sketch.with_values({"a.count": count}), "a")
        assert result[2, 3] == counted(count) and engine.record.texels == 17 * 17 * count


def test_another_value_begins_again(engine, folder):
    sketch = folder.one(ADD)
    engine.read(sketch, "a:a")
    engine.read(sketch.with_values({"a.count": 5, "a.rate": 0.25}), "a:a")
    assert engine.record.texels == 17 * 17 * 5


@pytest.mark.parametrize("text", ["VISITS", "AT_ONCE"])
def test_visits_and_iterations_at_once_go_on_as_well(ctx, engine, folder, text):
    kernel = {"VISITS": VISITS.replace('repeat = "3"', 'repeat = "count"'), "AT_ONCE": AT_ONCE}[text]
    kernel = kernel.replace("float(iterations)", "1.0")
    if text == "VISITS":
        kernel = kernel.replace("ivec2 visit(", "uniform int count = 3; //! slider(0, 50)\nivec2 visit(")
    sketch, ref = folder.one(kernel), "a:a"
    engine.read(sketch.with_values({"a.count": 2}), ref)
    result = engine.read(sketch.with_values({"a.count": 5}), ref).copy()
    assert engine.record.texels == 17 * 17 * 3
    with Engine(ctx, driver=engine.driver) as fresh:
        np.testing.assert_array_equal(result, fresh.read(sketch.with_values({"a.count": 5}), ref))


def test_a_stride_that_names_iterations_begins_again(ctx, folder):
    text = LATTICE.replace('repeat = "log2(size.x - 1) + 1"', 'repeat = "count"')
    text = text.replace("STRIDE", ' stride = "2 ** (iterations - 1 - iteration)",')
    text = text.replace("int stride()", "uniform int count = 3; //! slider(1, 5)\nint stride()")
    text = text.replace("(size.x - 1) >> iteration", "16 >> iteration")
    with Engine(ctx, driver="fragment") as engine:
        sketch = folder.one(text).with_values({"a.count": 2})
        with contextlib.suppress(PlaygroundError):
            engine.read(sketch, "a")
        engine.read(sketch.with_values({"a.count": 5}), "a")
        assert engine.record.texels == 17 * 17 * 5


def test_earlier_result_is_reused_and_copied_if_read_elsewhere(engine, folder):
    folder.write("one.glsl", ADD)
    folder.write("sum.glsl", SUM)
    both = folder.sketch(passes(a="./one", b="./one", sum=("./sum", 'inputs = { a = "a:a", b = "b:a" }')))
    engine.read(both, "sum")
    assert engine.record.ran == ["a", "sum"], "both are the same"
    before = engine.read(both, "b:a").copy()
    result = engine.read(both.with_values({"a.count": 8}), "sum").copy()
    assert engine.record.ran == ["a", "sum"] and engine.record.texels == 17 * 17 * (5 + 1)
    np.testing.assert_array_equal(engine.read(both, "b:a"), before)
    assert engine.record.ran == []
    alone = engine.read(both.with_values({"a.count": 8}), "a:a") + before
    np.testing.assert_array_equal(result, alone)


def test_going_on_step_by_step_makes_no_more_textures(engine, folder):
    sketch = folder.one(ADD)
    for count in (3, 4, 5):
        engine.texture(sketch.with_values({"a.count": count}), "a:a")
    made = engine.runner.pool.made
    for count in range(6, 40):
        engine.texture(sketch.with_values({"a.count": count}), "a:a")
    assert engine.runner.pool.made == made


MEAN = """#pragma kernel(output = "mean:r32f")
uniform sampler2D a; //! input("linear", "mipmap")
float kernel(ivec2 texel) { return textureLod(a, vec2(0.5), 10.0).r; }
"""
VISITED = """#pragma kernel(output = "a:r32f", repeat = "count", visits = "size.x, size.y")
uniform int count = 5; //! slider(0, 50)
ivec2 visit(ivec2 cell) { return cell; }
float kernel(ivec2 texel) { return float(iteration) + 1.0; }
"""


@pytest.mark.parametrize(("kernel", "value"), [(COUNT, counted), (VISITED, float)], ids=["all", "visited"])
def test_resumed_iterations_rebuild_their_own_mipmaps(any_engine, folder, kernel, value):
    """Each stop is two iterations or more after the last, whose texture, mipmaps and all, is used again."""
    folder.write("one.glsl", kernel)
    folder.write("mean.glsl", MEAN)
    sketch = folder.sketch(passes(a="./one", mean="./mean"), size="size = 16").with_values({"a.count": 9})
    for stop in (1, 3, 9):
        result = any_engine.read(sketch, "mean", steps={"a": stop})
        expected = value(stop) if kernel is VISITED else value(stop, 9)
        np.testing.assert_allclose(result, expected, rtol=1e-6)


# ── A repeat that ends once a step changed nothing gives the bits of all its steps, and runs few too


UNTIL = ', until = "unchanged"'
WALLS = """#pragma kernel(output = "wall:r32f")
uniform int gap = 1; //! slider(1, 9)
float kernel(ivec2 texel) {
    int x = texel.x % 4;
    bool open = texel.y / 3 % 2 == 0 ? texel.y + gap >= size.y : texel.y < gap;
    bool gate = texel.x / 4 % 2 == 0 ? texel.y == 0 : texel.y == size.y - 1;
    return x == 3 && !gate ? 1.0 : 0.0;
}
"""
FLOOD = """#pragma kernel(output = "wet:r32f", repeat = "count", until = "unchanged")
uniform sampler2D wall; //! input
uniform int count = 4096; //! slider(0, 9999)
float kernel(ivec2 texel) {
    if (texelFetch(wall, texel, 0).r > 0.5) return 0.0;
    if (texel == ivec2(0, size.y - 1)) return 1.0;
    return max(previous(texel), max(max(previous(texel - ivec2(1, 0)), previous(texel + ivec2(1, 0))),
                                    max(previous(texel - ivec2(0, 1)), previous(texel + ivec2(0, 1)))));
}
"""
PASSES = '[[pass]]\nname = "wall"\nuse = "./walls"\n[[pass]]\nname = "a"\nuse = "./spread"\n'


def serpentine(ny: int, nx: int) -> np.ndarray:
    """Return after how many steps each texel of a folded corridor is wet; 0: never."""
    y, x = np.mgrid[0:ny, 0:nx]
    gate = np.where(x // 4 % 2 == 0, y == 0, y == ny - 1)
    free = ~((x % 4 == 3) & ~gate)
    wet = np.zeros((ny, nx), bool)
    steps = np.zeros((ny, nx), int)
    cross = ndimage.generate_binary_structure(2, 1)
    for step in range(1, ny * nx + 2):
        now = ndimage.binary_dilation(wet, cross, mask=free) if step > 1 else wet.copy()
        now[ny - 1, 0] = True
        if (now == wet).all():
            return steps
        steps[now & ~wet] = step
        wet = now
    raise AssertionError("it never settles")


@pytest.fixture
def flood(folder):
    folder.write("walls.glsl", WALLS)

    def sketch(text: str = FLOOD, size: str = "size = 33"):
        folder.write("spread.glsl", text)
        return folder.sketch(PASSES, size=size)

    return sketch


@pytest.mark.parametrize("waits", [True, False])
@pytest.mark.parametrize("size", ["1", "2", "33", "[29, 18]", "65"])
def test_a_flood_ends_few_steps_after_it_has_settled(engine, flood, size, waits):
    """A graphics card is not waited for: there an answer is read at the next comparison."""
    engine.runner.kernels.settling.waits = waits
    result = engine.read(flood(size=f"size = {size}"), "a")
    truth = serpentine(*result.shape)
    np.testing.assert_array_equal(result > 0, truth > 0)
    settled, ran = int(truth.max()), engine.record.iterations["a"]
    assert settled < ran <= settled + (1 if waits else 2) * (isqrt(settled) + 4)
    assert engine.record.results["a"].iterations == 4096
    assert engine.runner.kernels.settling.compared <= 2 * isqrt(ran) + 2


@pytest.mark.slow
def test_its_bits_are_those_of_every_step_run(ctx, engine, flood):
    blur = FLOOD.replace("max(previous(texel), max(", "max(0.5 * previous(texel), 0.999 * max(")
    result = engine.read(flood(blur), "a").copy()
    ran = engine.record.iterations["a"]
    with Engine(ctx, driver=engine.driver) as whole:
        np.testing.assert_array_equal(result, whole.read(flood(blur.replace(UNTIL, "")), "a"))
        assert ran < whole.record.iterations["a"] == 4096


@pytest.mark.parametrize("count", [0, 1, 2, 3, 7, 100])
def test_a_count_below_is_kept(ctx, engine, flood, count):
    sketch = flood().with_values({"a.count": count})
    result = engine.read(sketch, "a").copy()
    np.testing.assert_array_equal(result > 0, (serpentine(33, 33) <= count) & (serpentine(33, 33) > 0))
    assert engine.record.iterations["a"] == count


def test_a_settled_result_goes_on_without_a_step(engine, flood):
    sketch = flood()
    engine.read(sketch.with_values({"a.count": 1000}), "a")
    before = engine.read(sketch.with_values({"a.count": 1000}), "a").copy()
    np.testing.assert_array_equal(engine.read(sketch.with_values({"a.count": 5000}), "a"), before)
    assert engine.record.iterations["a"] == 0


def test_each_step_can_be_shown(engine, flood):
    truth = serpentine(33, 33)
    sketch = flood().with_values({"a.count": 40})
    for done, values in engine.steps(sketch, "a"):
        assert (values > 0).sum() == ((truth > 0) & (truth <= done)).sum()


def test_nan_that_stays_is_unchanged_and_minus_zero_is_not_zero(engine, folder):
    text = """#pragma kernel(output = "a:rg32f, b:r16f", repeat = "500", until = "unchanged")
    void kernel(ivec2 texel, out vec2 a, out float b) {
        float far = previous_b(texel - ivec2(1, 0));
        a = vec2(intBitsToFloat(0x7fc00000), previous_b(texel) > 0.0 ? -0.0 : 0.0);
        b = texel.x == 0 ? 1.0 : far;
    }
    """
    result = engine.read(folder.one(text.replace("\n    ", "\n")), "a:a")
    assert np.isnan(result[..., 0]).all()
    assert np.signbit(result[..., 1]).all()
    assert 18 <= engine.record.iterations["a"] <= 18 + 2 * (isqrt(18) + 3)


def test_an_output_that_changes_alone_is_seen(engine, folder):
    text = """#pragma kernel(output = "a:r32f, b:rgba8", repeat = "600", until = "unchanged")
    void kernel(ivec2 texel, out float a, out vec4 b) {
        a = 1.0;
        b = vec4(0.0, 0.0, 0.0, previous_b(texel).a + 1.0 / 255.0);
    }
    """
    result = engine.read(folder.one(text.replace("\n    ", "\n")), "a:b")
    assert (result[..., 3] == 1.0).all()
    assert 255 < engine.record.iterations["a"] < 300


@pytest.mark.slow
def test_in_a_loop_each_run_of_it_ends_by_itself(ctx, engine, folder, flood):
    flood()
    loop = '[[pass]]\nname = "again"\nuse = "./spread"\ninputs = { wall = "wall" }\nrepeat = 3\n'
    sketch = folder.sketch(PASSES + loop + 'feedback = { wall = "wet" }\n')
    result = engine.read(sketch, "again").copy()
    assert engine.record.iterations["again"] < 3 * 4096
    folder.write("spread.glsl", FLOOD.replace(UNTIL, ""))
    with Engine(ctx, driver=engine.driver) as whole:
        np.testing.assert_array_equal(
            result, whole.read(folder.sketch(PASSES + loop + 'feedback = { wall = "wet" }\n'), "again")
        )


# ── What a stopped run has not reached: interpolated in pictures, 0 in values, and never gone on fro


SIDE = 16
SKETCH = (
    "format = 1\nsize = 17\n" + passes(height=("generation/NAME", "set = { seed = 5 }")) + map_of("height")
)
NAMES = ("diamond_square", "midpoint_displacement", "triangle_subdivision")


def sketch_of(folder: Path, name: str) -> Sketch:
    (folder / "s.toml").write_text(SKETCH.replace("NAME", name), encoding="utf-8")
    return load(folder / "s.toml")


def in_triangle(position: tuple[float, float], corners: list[tuple[float, float, float]]) -> float | None:
    """Return the height at a place of a triangle's plane; None outside."""
    (ax, ay, ah), (bx, by, bh), (cx, cy, ch) = corners
    share = np.linalg.solve([[ax, bx, cx], [ay, by, cy], [1, 1, 1]], [*position, 1.0])
    return float(share @ [ah, bh, ch]) if share.min() > -1e-9 else None


def joined(raw: NDArray[np.float32], stride: int, form: str) -> NDArray[np.float64]:
    """Join the nodes of a lattice, texel by texel, square by square."""
    array = np.full(raw.shape, np.nan)
    side = 2 * stride if form == "centres" else stride
    for y in range(raw.shape[0]):
        for x in range(raw.shape[1]):
            west, south = min(x // side * side, SIDE - side), min(y // side * side, SIDE - side)
            nodes = [(west + i * side, south + j * side) for j in (0, 1) for i in (0, 1)]
            sw, se, nw, ne = ((float(i), float(j), float(raw[j, i])) for i, j in nodes)
            if form == "squares":
                u, v = (x - west) / side, (y - south) / side
                low, high = sw[2] + u * (se[2] - sw[2]), nw[2] + u * (ne[2] - nw[2])
                array[y, x] = low + v * (high - low)
                continue
            middle = (west + side / 2, south + side / 2, float(raw[south + side // 2, west + side // 2]))
            triangles = [[sw, se, middle], [se, ne, middle], [ne, nw, middle], [nw, sw, middle]]
            if form == "triangles":
                triangles = [[sw, se, ne], [sw, nw, ne]]
            heights = [h for t in triangles if (h := in_triangle((x, y), t)) is not None]
            assert heights and np.ptp(heights) < 1e-6
            array[y, x] = heights[0]
    return array


@pytest.mark.parametrize(
    ("name", "iterations", "stride", "form"),
    [
        ("diamond_square", 1, 16, "squares"),
        ("diamond_square", 2, 8, "centres"),
        ("diamond_square", 3, 8, "squares"),
        ("diamond_square", 6, 2, "centres"),
        ("diamond_square", 7, 2, "squares"),
        ("midpoint_displacement", 1, 8, "squares"),
        ("midpoint_displacement", 3, 2, "squares"),
        ("triangle_subdivision", 1, 16, "triangles"),
        ("triangle_subdivision", 3, 4, "triangles"),
    ],
)
def test_a_stopped_run_is_joined_up_between_what_is_known(
    engine: Engine, tmp_path: Path, name: str, iterations: int, stride: int, form: str
) -> None:
    sketch, steps = sketch_of(tmp_path, name), {"height.raw": iterations}
    raw = engine.read(sketch, "height.raw", steps=steps)
    shown = engine.read(sketch, "height.raw", steps=steps, interpolated=True)
    np.testing.assert_allclose(shown, joined(raw, stride, form), atol=2e-6)
    existing = raw != 0
    assert existing.sum() > 2
    np.testing.assert_array_equal(
        shown[existing], raw[existing], "what is known stays as it is, to the last bit"
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_is_interpolated_and_values_and_steps_are_not(
    engine: Engine, tmp_path: Path, name: str
) -> None:
    sketch, steps = sketch_of(tmp_path, name), {"height.raw": 2}
    smooth = engine.render(sketch, size=(17, 17), steps=steps).array
    engine.read(sketch, "height", steps=steps, interpolated=True)
    nails = engine.render(sketch, size=(17, 17), steps=steps, interpolated=False).array
    assert (smooth != nails).any()
    values = dict(engine.steps(sketch, "height.raw"))
    np.testing.assert_array_equal(values[2], engine.read(sketch, "height.raw", steps=steps))
    assert (values[2] == 0).sum() > 200


@pytest.mark.parametrize("name", NAMES)
def test_a_run_goes_on_from_what_it_knows_and_ends_the_same(
    engine: Engine, tmp_path: Path, name: str
) -> None:
    sketch = sketch_of(tmp_path, name)
    whole = engine.read(sketch, "height.raw")
    for iterations in range(1, 4):
        engine.render(sketch, size=(9, 9), steps={"height.raw": iterations})
        np.testing.assert_array_equal(
            engine.read(sketch, "height.raw", steps={"height.raw": iterations + 1}),
            dict(engine.steps(sketch, "height.raw"))[iterations + 1],
        )
    np.testing.assert_array_equal(engine.read(sketch, "height.raw"), whole)


def test_full_zero_or_unset_steps_are_not_interpolated(tmp_path: Path) -> None:
    sketch = sketch_of(tmp_path, "diamond_square")
    for steps in ({}, {"height.raw": 0}, {"height.raw": 9}):
        step = make_plan(sketch, PlanRequest(frame_size=(9, 9), steps=steps)).step("height.raw")
        assert step is not None and step.between is None


def test_interpolated_picture_has_its_own_fingerprint_and_hash(engine: Engine, tmp_path: Path) -> None:
    sketch, steps = sketch_of(tmp_path, "diamond_square"), {"height.raw": 3}
    engine.render(sketch, size=(9, 9), steps=steps)
    drawn = engine.drawn()
    engine.render(sketch, size=(9, 9), steps=steps, interpolated=False)
    assert engine.drawn() != drawn
