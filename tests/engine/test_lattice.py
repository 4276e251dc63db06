"""What a stopped run has not reached: interpolated in pictures, 0 in values, and never gone on from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.sketch.model import Sketch

from ..loading import load
from ..sketch_texts import map_of, passes

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
