"""A fluid: each stage against NumPy in float64, what the projection leaves of the divergence, the dye."""

import numpy as np
import pytest

from ..sketch_texts import passes

SIZE = (40, 28)
ROUNDS = 12
FRAMES = (1, 20, 75)
STIRRERS = "simulation/fluid/stirrers.glsl"


@pytest.fixture
def sketch(make_sketch):
    use = "simulation/fluid", f"set = {{ rounds = {ROUNDS}, radius = 0.1 }}"
    return make_sketch(passes(fluid=use), size=list(SIZE))


def state(engine, sketch, inside, frame):
    return engine.read(sketch, f"fluid.frame.{inside}", time=frame / 60).astype(np.float64)


def on_torus(field, x, y):
    """Return a field between its texels, bilinearly; whole numbers are texels."""
    west, south = np.floor(x).astype(int), np.floor(y).astype(int)
    rows, columns = field.shape
    result = 0.0
    for dy in (0, 1):
        for dx in (0, 1):
            weight = (dx * (x - west) + (1 - dx) * (1 - x + west)) * (
                dy * (y - south) + (1 - dy) * (1 - y + south)
            )
            result = result + weight * field[(south + dy) % rows, (west + dx) % columns]
    return result


def stirrer(k, time):
    speed, out = (-1.1 if k == 1 else 0.7 + 0.35 * k), 0.16 + 0.07 * k
    turn = speed * time + 2 * np.pi / 3 * k
    position = 0.5 + out * np.cos(turn), 0.5 + out * np.sin(turn)
    return position, (-speed * out * np.sin(turn), speed * out * np.cos(turn))


def near(x, y, position, radius=0.1):
    """Return how near points are to a stirrer, the nearest of its copies around the torus."""
    copies = [(x - position[0] + i) ** 2 + (y - position[1] + j) ** 2 for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.clip(1 - np.min(copies, 0) / radius**2, 0, 1) ** 2


def divergence(flow):
    u, v = flow[..., 0], flow[..., 1]
    return np.roll(u, -1, 1) - u + np.roll(v, -1, 0) - v


def five_points(p):
    return sum(np.roll(p, shift, axis) for shift in (-1, 1) for axis in (0, 1)) - 4 * p


def fine(*fields):
    """Return what float32 may make of a stage: places to 2**-18 of a cell, times the steepest change."""
    steepest = max(np.abs(np.diff(f, axis=a)).max() for f in fields for a in (0, 1))
    return 16 * (2**-18 * steepest + 2**-24 * max(np.abs(f).max() for f in fields))


def test_a_stirrers_motion_is_the_derivative_of_its_place(on_gpu):
    times, step = np.linspace(0, 20, 41), 1e-3
    for k in range(3):
        result = on_gpu(STIRRERS, f"stirrer_motion({k}, t)", t=times.astype(np.float32))
        ahead, behind = stirrer(k, times + step)[0], stirrer(k, times - step)[0]
        slope = (np.stack(ahead, -1) - np.stack(behind, -1)) / (2 * step)
        np.testing.assert_allclose(result, slope, atol=1e-5)


@pytest.mark.parametrize("frame", FRAMES)
def test_the_velocity_is_carried_by_itself_and_stirred(engine, sketch, frame):
    before = state(engine, sketch, "projected", frame - 1)
    u, v = before[..., 0], before[..., 1]
    result = state(engine, sketch, "carried", frame)
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]].astype(float)
    for axis, (right, up) in enumerate(((0.0, 0.5), (0.5, 0.0))):
        x, y = columns + right, rows + up

        def flow(x, y):
            return on_torus(u, x, y - 0.5), on_torus(v, x - 0.5, y)

        along, across = flow(x, y)
        expected = flow(x - along / 60, y - across / 60)[axis]
        for k in range(3):
            position, motion = stirrer(k, frame / 60)
            share = near(x / SIZE[0], y / SIZE[1], position)
            expected = (1 - share) * expected + share * motion[axis] * SIZE[axis]
        np.testing.assert_allclose(result[..., axis], expected, atol=fine(before, result))
    assert np.abs(result).max() > 5, "it moves"


@pytest.mark.parametrize("frame", FRAMES)
def test_the_divergence_is_what_flows_out_of_each_cell(engine, sketch, frame):
    carried = state(engine, sketch, "carried", frame)
    result = state(engine, sketch, "divergence", frame)
    np.testing.assert_allclose(result, divergence(carried), atol=4 * 2**-24 * 4 * np.abs(carried).max())


@pytest.mark.parametrize("frame", FRAMES)
def test_divergence_modes_decay_as_jacobi_iteration_predicts(engine, sketch, frame):
    pressure = state(engine, sketch, "solved", frame - 1)
    carried = state(engine, sketch, "carried", frame)
    left = divergence(carried) - five_points(pressure)
    ky, kx = np.meshgrid(*(2 * np.pi * np.fft.fftfreq(n) for n in left.shape), indexing="ij")
    remains = (1 - 2 / 3 * (1 - (np.cos(kx) + np.cos(ky)) / 2)) ** ROUNDS
    expected = np.fft.ifft2(remains * np.fft.fft2(left)).real
    result = divergence(state(engine, sketch, "projected", frame))
    solved = state(engine, sketch, "solved", frame)
    # Each round rounds the pressure half a dozen times, which the five points make 8 of.
    rounding = 8 * ROUNDS * 6 * 2**-24 * np.abs(solved).max() + 16 * 2**-24 * np.abs(carried).max()
    np.testing.assert_allclose(result, expected, atol=rounding)
    assert np.linalg.norm(result) < 0.5 * np.linalg.norm(divergence(carried))


@pytest.mark.parametrize("frame", FRAMES)
def test_the_dye_is_carried_fades_and_is_added_at_the_stirrers(engine, sketch, frame):
    before, result = (state(engine, sketch, "dyed", n)[..., :3] for n in (frame - 1, frame))
    flow = state(engine, sketch, "projected", frame)
    middle = 0.5 * (flow + np.stack([np.roll(flow[..., 0], -1, 1), np.roll(flow[..., 1], -1, 0)], -1))
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]].astype(float)
    x, y = columns - middle[..., 0] / 60, rows - middle[..., 1] / 60
    expected = (1 - 0.003) * np.stack([on_torus(before[..., c], x, y) for c in range(3)], -1)
    colours = (0.9, 0.25, 0.05), (0.05, 0.35, 0.9), (0.95, 0.75, 0.2)
    for k, colour in enumerate(colours):
        share = 0.4 * near((columns + 0.5) / SIZE[0], (rows + 0.5) / SIZE[1], stirrer(k, frame / 60)[0])
        expected = expected + share[..., None] * (np.array(colour) - expected)
    np.testing.assert_allclose(result, expected, atol=fine(before, result))


@pytest.mark.slow
def test_there_is_never_more_dye_anywhere_than_was_put_in(engine, sketch):
    for frame in (0, 10, 60, 300):
        dye = state(engine, sketch, "dyed", frame)[..., :3]
        assert dye.min() >= 0
        assert (dye.max((0, 1)) <= np.float32([0.95, 0.75, 0.9]) * (1 + 2**-20)).all()
    assert dye.mean() > 0.05


def test_a_steady_flow_carries_dye_around_the_torus(engine, make_sketch):
    """A cell a frame: nothing is interpolated, so that after as many frames as cells it is back."""
    flow = (
        '#pragma kernel(output = "velocity:rg32f")\nvec2 kernel(ivec2 texel) { return vec2(60.0, -60.0); }\n'
    )
    blob = """#pragma kernel(output = "dye:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(fract(vec3(texel.x * 7 + texel.y * 5) * vec3(0.1, 0.2, 0.3)), 1.0); }
"""
    made = (
        "simulation/fluid/dyed",
        'inputs = { velocity = "flow", dye = "blob" }\nset = { rate = 0.0, fade = 0.0 }',
        'repeat = "frames"\nfeedback = { dye = "dye" }',
    )
    sketch = make_sketch(passes(flow="./flow", blob="./blob", made=made), size=[16, 16], flow=flow, blob=blob)
    first = engine.read(sketch, "blob")
    for frame in (0, 4, 15):
        result = engine.read(sketch, "made", time=frame / 60)
        moved = np.roll(first, (-(frame + 1), frame + 1), (0, 1))
        # 60 times float32's 1 / 60 is 1 to 2**-24, which a frame mixes in of the neighbour.
        np.testing.assert_allclose(result, moved, atol=(frame + 1) * 2**-20)
