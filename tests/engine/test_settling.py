"""A repeat that ends once a step changed nothing gives the bits of all its steps, and runs few too many.

The truth is the same kernel without ``until``, and for floods and their lengths SciPy.
"""

from __future__ import annotations

from math import isqrt

import numpy as np
import pytest
from scipy import ndimage

from playground.engine.engine import Engine

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
SPREAD = """#pragma kernel(output = "wet:r32f", repeat = "count", until = "unchanged")
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

    def sketch(text: str = SPREAD, size: str = "size = 33"):
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
    blur = SPREAD.replace("max(previous(texel), max(", "max(0.5 * previous(texel), 0.999 * max(")
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
    folder.write("spread.glsl", SPREAD.replace(UNTIL, ""))
    with Engine(ctx, driver=engine.driver) as whole:
        np.testing.assert_array_equal(
            result, whole.read(folder.sketch(PASSES + loop + 'feedback = { wall = "wet" }\n'), "again")
        )
