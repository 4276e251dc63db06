"""Levels of detail are chosen as the engine chooses them: the same pieces, the same places, bit for bit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from playground.engine import camera as cameras
from playground.engine import lod
from playground.sketch.model import Camera

from ...elevations import spans_of_tiles
from .node import Node, NodeError

FAR = lod.FAR
CHOOSE = """async (cases, load) => {
  const { choose } = await load("detail.js");
  return cases.map(({ detail, tolerance, spans, errors, view }) =>
    choose("land", { detail, tolerance }, () => ({ spans, errors }), view));
}"""


@dataclass(frozen=True)
class Case:
    detail: int
    tolerance: float
    spans: np.ndarray
    errors: np.ndarray
    camera: Camera
    extent: tuple[float, float]
    relief: float
    size: tuple[int, int]

    @property
    def view(self) -> lod.View:
        eye = cameras.look(self.camera, self.extent, self.relief, self.size)
        matrix = eye.clip_from_world.astype(np.float64)
        return lod.View(matrix, eye.position, self.extent, self.relief, self.size)

    @property
    def arguments(self) -> dict[str, Any]:
        view = {"eye": self.view.eye, "extent": self.extent, "relief": self.relief, "size": self.size}
        view["clipFromWorld"] = self.view.clip_from_world.T.astype(np.float32)
        size = self.spans.shape[1::-1]
        tables = {name: {"size": size, "data": getattr(self, name)} for name in ("spans", "errors")}
        return {"detail": self.detail, "tolerance": self.tolerance, "view": view, **tables}

    @property
    def expected(self) -> lod.Chosen:
        values = {"detail": self.detail, "tolerance": self.tolerance}
        with np.errstate(all="ignore"):
            return lod.choose_terrain(values, lambda: {"spans": self.spans, "errors": self.errors}, self.view)


def random_case(rng: np.random.Generator, detail: int) -> Case:
    """Return a terrain of up to 40 by 40 tiles, flat, rough, with holes, upside down, from anywhere."""
    ny, nx = (int(n) for n in rng.choice([1, 1, 2, 3, 5, 8, 13, 33, 40], 2))
    spans = np.sort(rng.uniform(-0.2, 1.2, (ny, nx, 2)), axis=-1)
    errors = np.sort(10.0 ** rng.uniform(-6, 0, (ny, nx, 4)), axis=-1)
    flat, hole = (rng.random((ny, nx)) < rng.choice([0.0, 0.2, 1.0], p=[0.5, 0.4, 0.1]) for _ in range(2))
    errors[flat] = 0.0
    errors[hole, rng.integers(0, 4) :] = FAR
    spans[hole] = [(-FAR, FAR), (0.0, FAR), (0.5, 0.5)][rng.integers(0, 3)]
    extent = tuple(10 ** rng.uniform(1, 5, 2))
    relief = float(rng.choice([0.0, -1.0, 1.0], p=[0.1, 0.2, 0.7])) * 10 ** rng.uniform(-1, 4)
    target = (*(rng.uniform(0, 1, 2) * extent), rng.uniform(0, 1) * relief) if rng.random() < 0.7 else None
    distance = 0.0 if rng.random() < 0.2 else max(extent) * 10 ** rng.uniform(-2, 1)
    camera = Camera(
        rng.choice([rng.uniform(0, 360), 90.0 * rng.integers(0, 4)]),
        rng.choice([rng.uniform(-89, 89), 0.0, 89.0, 90.0]),
        distance,
        target,
        rng.uniform(10, 120),
    )
    tolerance = float(rng.choice([0.0, 0.5, 2.0, 16.0, 10 ** rng.uniform(-3, 4)]))
    size = (int(rng.integers(1, 3000)), int(rng.integers(1, 2000)))
    spans, errors = spans_of_tiles(spans), errors.astype(np.float32)
    spans[:, -1, 2] = spans[-1, :, 3] = 1.0
    cut = rng.uniform(0.1, 1.0, 2)  # of the last tiles, which may have fewer cells
    spans[:, :-1, 2] *= nx / (nx - 1 + cut[0])
    spans[:-1, :, 3] *= ny / (ny - 1 + cut[1])
    case = Case(detail, tolerance, spans, errors, camera, extent, relief, size)
    return case if rng.random() < 0.7 else coming_in(rng, case)


def coming_in(rng: np.random.Generator, case: Case) -> Case:
    """Return a case with one error for all, at whose distance, or a little nearer, its nearest tile is."""
    error, view = 10 ** rng.uniform(-6, 0), case.view
    with np.errstate(all="ignore"):
        nearest = lod.boxes_of(case.spans, view).distances(view.eye)[0].min()
    length = error * abs(case.relief) * view.pixels * view.stretch
    tolerance = float(length / (rng.uniform(0.75, 1.0) * nearest)) if nearest else 1.0
    return replace(case, errors=np.full_like(case.errors, error), tolerance=tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("detail", [1, 2], ids=["geomipmap", "morph"])
def test_random_terrain_from_random_eyes(node: Node, detail: int):
    rng = np.random.default_rng(detail)
    cases = [random_case(rng, detail) for _ in range(200)]
    pieces, some, all_ = set(), 0, 0
    for case, result in zip(cases, node.run(CHOOSE, [case.arguments for case in cases]), strict=True):
        expected = case.expected
        assert result["runs"] == [[" ".join(map(str, piece)), count] for piece, count in expected.runs], case
        assert result["places"].tobytes() == expected.places.tobytes(), case
        pieces |= {piece for piece, count in expected.runs if count}
        some += 0 < len(expected.places)
        all_ += len(expected.places) >= case.spans[..., 0].size
    assert some > 130 and all_ > 30, "views see little, or everything"
    assert len(pieces) > (50 if detail == 1 else 8), "too few kinds of pieces to say anything"


def test_a_full_grid_is_drawn_whole_and_reads_nothing_back(node: Node):
    script = "async (load) => (await load('detail.js')).choose('land', { detail: 0 }, () => { throw 'read' })"
    result = node.run(script)
    assert result["runs"] == [["whole 0 0", 1]] and result["places"].tolist() == [0, 0, 0, 0]


def test_nothing_is_chosen_of_a_mesh_that_is_drawn_whole(node: Node):
    with pytest.raises(NodeError, match="nothing is chosen of mesh 'grid'"):
        node.call("detail.js", "choose", "grid", {}, None, None)
