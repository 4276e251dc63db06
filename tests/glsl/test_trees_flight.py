"""A flight of 240 frames over the woods of `october`: no tree comes, goes or changes but as it fades."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from playground.engine.camera import look
from playground.engine.engine import Engine

from ..loading import load

FRAMES, STEP = 240, 2.0  # [m] a frame: 120 m/s
WHOLE, REACH, TALLEST = 500.0, 1500.0, 21.0
GROWN = TALLEST * (REACH / WHOLE) ** 0.8  # [m] no tree is larger (trees/level)


@pytest.mark.slow
def test_no_tree_pops_along_a_flight_of_240_frames(ctx: moderngl.Context) -> None:
    """Of a tree d metres away the share that is kept changes by 2 v / d, over a fade of a fifth: ten times.

    It grows by 0.8 v / d at most, and over the last tenth of the reach it goes by v over that.
    """
    set_to: dict[str, object] = {"whole": WHOLE, "reach": REACH, "trees": 200_000, "place.all_round": True}
    sketch = load("october").with_values({f"view.{name}": value for name, value in set_to.items()})
    camera = sketch.camera
    assert camera.target is not None
    most, fading = 0.0, 0
    before = np.zeros(0, complex), np.zeros((0, 4), np.float32)
    with Engine(ctx, cache_bytes=64 * 2**20) as engine:
        for frame in range(FRAMES):
            east, north, up = camera.target
            moved = replace(camera, target=(east - STEP * frame, north, up))
            now = sketch.with_camera(moved)
            plan = engine.plan(now, (96, 54), ref="view.place:tree")
            ground = plan.terrain
            assert ground.extent is not None and ground.relief is not None
            eye = np.array(look(moved, ground.extent, ground.relief, (96, 54)).position)
            tree = engine.texture_of(plan, plan.flat.ref("view.place:tree", now.name))
            rows = np.frombuffer(tree.read(alignment=1), np.float32).reshape(-1, 4)
            rows = rows[rows[:, 3] > 0]
            places = rows[:, 0] + 1j * rows[:, 1]
            if frame:
                every = np.union1d(places, before[0])
                sizes = []
                for existing, trees in ((before[0], before[1]), (places, rows)):
                    size = np.zeros((len(every), 2))
                    size[np.searchsorted(every, existing)] = trees[:, [3, 2]]
                    sizes.append(size)
                change = np.abs(sizes[0][:, 0] - sizes[1][:, 0])
                foot = np.column_stack([every.real, every.imag, np.maximum(sizes[0][:, 1], sizes[1][:, 1])])
                away = np.maximum(np.linalg.norm(foot - eye, axis=1) - STEP, WHOLE)
                bound = GROWN * STEP * (10.8 / away + 1.0 / (0.1 * REACH))
                most, fading = max(most, float((change / bound).max())), fading + int((change > 0).sum())
            before = places, rows
    assert fading > 10_000, "trees fade"
    assert most <= 1.0
