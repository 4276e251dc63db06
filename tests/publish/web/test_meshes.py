"""Meshes and the pieces of tiles are the engine's: every vertex, every index, in the same order."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine import lod, meshes
from playground.errors import SketchError

from ...cases import each
from .node import Node, NodeError

GRIDS = (2, 3, 4, 5, 17, 50, 129, 257)
CASES = [
    *(("grid", {"grid": n}) for n in GRIDS),
    ("sheet", {}),
    *(("triangles", {"count": n}) for n in (1, 2, 7, 1000)),
    *(("land", {"detail": 0, "grid": n}) for n in GRIDS[:5]),
    ("land", {"detail": 1, "grid": 9}),
    ("land", {"detail": 2, "grid": 9}),
]


@each("case", CASES)
def test_a_mesh_has_the_same_vertices_and_indices(node: Node, case: tuple[str, dict[str, int]]):
    name, values = case
    expected = meshes.build_mesh(name, meshes.mesh_key(name, values))
    result = node.call("draws.js", "buildMesh", name, values)
    assert result["attributes"].keys() == expected.attributes.keys() == {"corner"}
    corner = result["attributes"]["corner"]
    assert corner["data"].dtype == np.float32 and result["indices"].dtype == np.uint32
    assert corner["data"].tobytes() == expected.attributes["corner"].tobytes()
    assert corner["size"] == expected.attributes["corner"].shape[1]
    assert np.array_equal(result["indices"], expected.indices)


def test_every_mesh_is_there(node: Node):
    assert {name for name, _ in CASES} == meshes.MESHES.keys()
    assert node.call("draws.js", "meshKey", "land", {"detail": 2, "grid": 4097, "tolerance": 1.5}) == (
        "land, detail 2, grid 4097"
    )
    for name, (_, reads) in meshes.MESHES.items():
        for parameter, (low, high) in reads.items():
            values = {each: most for each, (_, most) in reads.items()}
            for value in (low, high):
                node.call("draws.js", "meshKey", name, {**values, parameter: value})
            for value in (low - 1, high + 1, 1.5, None):
                wrong = {**values, parameter: value}
                with pytest.raises(SketchError) as expected:
                    meshes.mesh_key(name, wrong)
                with pytest.raises(NodeError) as result:
                    node.call("draws.js", "meshKey", name, wrong)
                assert result.value.message == expected.value.diagnostics[0].message


def test_a_mesh_that_is_not_there_is_named(node: Node):
    with pytest.raises(NodeError, match=r"^there is no mesh 'lands'"):
        node.call("draws.js", "meshKey", "lands", {})


def test_pieces_of_a_tile_are_joined_as_the_engine_joins_them(node: Node):
    result = node.call("detail.js", "pieces")
    assert list(result) == [" ".join(map(str, piece)) for piece in lod.pieces()]
    for piece, indices in lod.pieces().items():
        assert result[" ".join(map(str, piece))] == indices.tolist(), piece
    ranges = node.call("detail.js", "ranges")
    assert ranges == {" ".join(map(str, piece)): list(both) for piece, both in lod.ranges().items()}


def test_mesh_choosers_read_same_inputs_as_engine(node: Node):
    result = node.run("async (load) => (await load('detail.js')).CHOSEN_BY")
    assert result == {name: list(chooser.inputs) for name, chooser in lod.CHOOSERS.items()}
