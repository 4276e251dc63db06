"""Reaction and diffusion against one step in float64, and by what diffusion and reaction keep."""

import numpy as np
import pytest

from ..sketch_texts import passes

PASSES = passes(made=("simulation/gray_scott", "set = {{ {values} }}"))
FED, KILLED, SPREAD = 0.037, 0.06, 0.209


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(48, 37), **values):
        text = ", ".join(f"{name} = {value}" for name, value in values.items())
        return make_sketch(PASSES.format(values=text), size=list(size))

    return make


def amounts(engine, sketch, frame):
    return engine.read(sketch, "made:amounts", time=frame / 60).astype(np.float64)


def stepped(result, feed=FED, kill=KILLED, spread=SPREAD):
    """Return U and V one step later, in float64, on a torus."""
    u, v = result[..., 0], result[..., 1]

    def bend(a):
        return sum(np.roll(a, shift, axis) for shift in (-1, 1) for axis in (0, 1)) - 4 * a

    taken = u * v * v
    return np.stack(
        [
            u + spread * bend(u) + feed * (1 - u) - taken,
            v + spread / 2 * bend(v) + taken - (feed + kill) * v,
        ],
        -1,
    )


@pytest.mark.parametrize("size", [(48, 37), (31, 64)], ids=str)
def test_a_frame_is_a_step_of_the_equations(engine, sketch_of, size):
    sketch = sketch_of(size, steps=1, spots=2)
    for frame in (0, 1, 30, 150):
        before, after = amounts(engine, sketch, frame), amounts(engine, sketch, frame + 1)
        # Numbers up to 1, sums up to 4 of them, a dozen roundings of at most 2**-24 of that, and of the
        # three parameters, which are float32 as well.
        np.testing.assert_allclose(after, stepped(before), atol=16 * 4 * 2**-24)
    assert np.ptp(after[..., 1]) > 0.1, "and something happens"


def test_steps_in_a_frame_are_steps(engine, sketch_of):
    sketch, four = sketch_of(steps=1), sketch_of(steps=4)
    for frame in (0, 2, 9):
        np.testing.assert_array_equal(amounts(engine, four, frame), amounts(engine, sketch, 4 * frame + 3))


def test_first_gray_scott_frame_steps_from_seed_squares(engine, sketch_of):
    sketch = sketch_of((64, 64), steps=1, spots=1, seed=3)
    u, v = np.moveaxis(engine.read(sketch, "made.start").astype(float), -1, 0)
    assert (v == 0.25).sum() == (u == 0.5).sum() == 9 * 9
    assert set(np.unique(v)) == {0.0, 0.25} and set(np.unique(u)) == {0.5, 1.0}
    np.testing.assert_allclose(
        amounts(engine, sketch, 0), stepped(np.stack([u, v], -1)), atol=16 * 4 * 2**-24
    )


def test_diffusion_alone_damps_a_wave_as_it_must(engine, make_sketch):
    wave = """#pragma kernel(output = "wave:rg32f")
vec2 kernel(ivec2 texel) {
    return vec2(0.5 + 0.25 * cos(6.283185307 * 3.0 * float(texel.x) / float(size.x)), 0.0);
}
"""
    text = passes(
        wave="./wave",
        made=(
            "simulation/gray_scott/step",
            'inputs = { initial = "wave" }\nrepeat = "frames"\nfeedback = { initial = "amounts" }',
            "set = { feed = 0.0, kill = 0.0, steps = 5 }",
        ),
    )
    sketch = make_sketch(text, size=[48, 16], wave=wave)
    size = np.abs(np.fft.fft(amounts(engine, sketch, 3)[5, :, 0]))[3] / 24
    factor = 1 - 2 * SPREAD * (1 - np.cos(2 * np.pi * 3 / 48))
    np.testing.assert_allclose(size, 0.25 * factor**20, rtol=1e-5)


def test_the_height_is_the_second_substance(engine, sketch_of):
    sketch = sketch_of(full=0.2)
    result = engine.read(sketch, "made:height", time=1.0)
    np.testing.assert_allclose(result, np.clip(amounts(engine, sketch, 60)[..., 1] / 0.2, 0, 1), rtol=1e-6)
    assert 0 < result.max() <= 1
