"""What goes to Node and back is what was given."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .node import Node, NodeError

SAME = "(value) => value"


@pytest.mark.parametrize(
    "value", [0.1, -0.0, math.inf, -math.inf, 1e-320, 2**53, "é\u2028\n", None, True, [1, [2.5]], {"a": {}}]
)
def test_a_value_comes_back_as_it_was(node: Node, value: object):
    result = node.run(SAME, value)
    assert result == value and type(result) is type(value)
    assert not isinstance(value, float) or math.copysign(1, result) == math.copysign(1, value)


def test_numbers_that_are_none_come_back(node: Node):
    assert math.isnan(node.run(SAME, math.nan))


@pytest.mark.parametrize("kind", ["f4", "f8", "i1", "u1", "i4", "u2", "u4"])
def test_arrays_are_typed_arrays_there(node: Node, kind: str):
    array = np.array([0, 1, 2, 100], kind)
    assert node.run("(value) => ArrayBuffer.isView(value) && value.length", array) == 4
    result = node.run(SAME, array)
    assert result.dtype == array.dtype and result.tolist() == array.tolist()


def test_maps_and_sets_come_back(node: Node):
    assert node.run("() => new Map([['a', 1], [[1, 2], new Float32Array([0.5])]])") == {"a": 1, (1, 2): [0.5]}
    assert node.run("(value) => new Set([...value, 'b'])", {"a"}) == {"a", "b"}


def test_what_is_thrown_is_raised_with_what_it_carries(node: Node):
    with pytest.raises(NodeError, match=r"^no\b") as caught:
        node.run("() => { throw Object.assign(new Error('no'), { line: 3 }); }")
    assert caught.value.message == "no"
    assert caught.value.details == {"line": 3}
    assert node.run(SAME, 1) == 1
