"""Calls, iterations and values from a flat list of leaves, against a run written out by hand in Python."""

import math
import struct

import pytest

from playground.engine.trace.model import (
    LEAF_TYPES,
    LENGTH,
    MARK,
    Leaf,
    Place,
    Trace,
    first_difference,
    rebuild,
)

FILE = "/author/march.glsl"


def place(kind, name, line, type_="float", *, function="march", loops=()):
    return Place(kind, name, function, type_, FILE, line, 5, line + 1, 9, loops)


PLACES = [
    place("enter", "march", 1, ""),
    place("argument", "far", 1),
    place("iteration", "i", 2, "int"),  # 2
    place("iteration", "j", 3, "int", loops=(2,)),  # 3
    place("set", "sum", 4, loops=(2, 3)),  # 4
    place("condition", "sum > 3.0", 5, "bool", loops=(2,)),  # 5
    place("return", "march", 6),  # 6
    place("enter", "kernel", 10, "", function="kernel"),  # 7
    place("set", "rows", 11, "vec2[20]", function="kernel"),  # 8
    place("set", "turn", 12, "mat2", function="kernel"),  # 9
    place("set", "found", 13, "Hit", function="kernel"),  # 10
    place("return", "kernel", 14, function="kernel"),  # 11
    place("set", "table", 15, "float[2][2]", function="kernel"),  # 12
]
STRUCTS = {"Hit": (("turn", "mat2"), ("far", "float[3]"), ("inner", "Inner")), "Inner": (("is_set", "bool"),)}


def leaf(number, kind, *values):
    forms = {"f": "f", "v": "f", "i": "i", "u": "I", "b": "I"}
    data = struct.pack("<" + forms[kind[0]] * len(values), *values).ljust(16, b"\0")
    return Leaf(number, LEAF_TYPES.index(kind), struct.unpack("<4I", data))


def mark(number):
    return Leaf(number, MARK, (0, 0, 0, 0))


def length(number, whole, recorded):
    return Leaf(number, LENGTH, (whole, recorded, 0, 0))


def trace_of(leaves):
    calls, events = rebuild(PLACES, STRUCTS, leaves)
    return Trace(
        step="height", texel=(0, 0), iteration=(), outputs={}, texel_values={}, is_exact=True, calls=calls,
        events=events, is_complete=True, count=len(leaves), functions=(), others=(), files={},
    )  # fmt: skip


def march_leaves(far):
    """Record what ``march`` does, as a traced shader would."""
    leaves, total = [mark(0), leaf(1, "float", far)], 0.0
    for i in range(2):
        leaves.append(leaf(2, "int", i))
        for j in range(i + 1):
            leaves.append(leaf(3, "int", j))
            total += far
            leaves.append(leaf(4, "float", total))
        leaves.append(leaf(5, "bool", total > 3.0))
    return [*leaves, leaf(6, "float", total)]


def test_calls_know_their_callers_and_iterations_their_loops():
    run = trace_of([mark(7), *march_leaves(2.0), *march_leaves(1.0), leaf(11, "float", 9.0)])
    assert [(c.function, c.caller, c.depth) for c in run.calls] == [
        ("kernel", None, 0),
        ("march", 0, 1),
        ("march", 0, 1),
    ]
    first = run.calls[1]
    sets = [event for event in first.events if event.name == "sum"]
    assert [(event.iterations, event.value) for event in sets] == [
        ((0, 0), 2.0),
        ((1, 0), 4.0),
        ((1, 1), 6.0),
    ]
    assert sets[0].loops == (2, 3)
    assert first.values("sum > 3.0") == [False, True]
    assert first["far"] == 2.0 and first.result == 6.0 and run.calls[0].result == 9.0
    assert [event.call for event in run.events[-1:]] == [0]
    with pytest.raises(KeyError, match="far"):
        first["fur"]


def test_each_run_of_an_inner_loop_has_rows_of_its_own():
    outer, once, twice = trace_of(march_leaves(2.0)).loops()
    assert outer.variable == "i" and [row["sum"] for row in outer.rows] == [2.0, 6.0]
    assert [row["sum > 3.0"] for row in outer.rows] == [False, True]
    assert (once.iterations, once.rows) == ((0,), [{"j": 0, "sum": 2.0}])
    assert (twice.iterations, twice.rows) == ((1,), [{"j": 0, "sum": 4.0}, {"j": 1, "sum": 6.0}])


def test_arrays_matrices_and_structs_are_joined_from_leaves():
    matrix = [(0, 1), (2, 3)]
    run = trace_of([
        mark(7),
        length(8, 20, 2), leaf(8, "vec2", 1, 2), leaf(8, "vec2", 3, 4),
        *(leaf(9, "vec2", *column) for column in matrix),
        *(leaf(10, "vec2", *column) for column in matrix),
        length(10, 3, 3), *(leaf(10, "float", v) for v in (5, 6, 7)), leaf(10, "bool", 1),
        mark(12),
    ])  # fmt: skip
    call = run.calls[0]
    assert call["rows"] == [(1.0, 2.0), (3.0, 4.0)]
    assert call["turn"] == ((0.0, 1.0), (2.0, 3.0))
    assert call["found"] == {"turn": call["turn"], "far": [5.0, 6.0, 7.0], "inner": {"is_set": True}}
    assert call["table"] is None


def test_a_value_that_the_limit_cuts_is_left_out():
    whole = [mark(7), length(8, 20, 2), leaf(8, "vec2", 1, 2), leaf(8, "vec2", 3, 4)]
    assert [len(trace_of(whole[:n]).events) for n in range(5)] == [0, 1, 1, 1, 2]


def test_a_value_with_nan_or_infinity_is_not_finite():
    run = trace_of([mark(7), leaf(9, "vec2", 0, 1), leaf(9, "vec2", math.inf, 1), *march_leaves(math.nan)])
    assert run.first_not_finite().name == "turn"
    assert [event.is_finite for event in run.events[:4]] == [True, False, True, False]


def test_first_difference_is_where_values_or_paths_part():
    one, same, other = trace_of(march_leaves(2.0)), trace_of(march_leaves(2.0)), trace_of(march_leaves(1.0))
    assert first_difference(one, same) is None
    assert [event.name for event in first_difference(one, other)] == ["far", "far"]
    parted = first_difference(one, other, values=False)
    assert [(event.name, event.value) for event in parted] == [("sum > 3.0", True), ("sum > 3.0", False)]
    nan = trace_of(march_leaves(math.nan))
    assert first_difference(nan, trace_of(march_leaves(math.nan))) is None
    shorter = trace_of(march_leaves(2.0)[:-1])
    assert first_difference(one, shorter) == (one.events[-1], None)
