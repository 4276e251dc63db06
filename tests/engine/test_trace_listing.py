"""A trace as text: what a person reads of each value, and which lines and iterations are shown."""

import math

import pytest

from playground.engine.trace.listing import annotated, heading, listing, loop_table, note_of, text_of
from playground.engine.trace.model import LEAF_TYPES, MARK, Leaf, Place, Trace, rebuild

FILE = "/glsl/lighting/march.glsl"
CODE = (
    "float march(int count) {",
    "    int far = 0;",
    "    for (int i = 0; i < count; i++)",
    "        far += i;",
    "    // Nothing happens here,",
    "    // nor here,",
    "    // nor here,",
    "    // nor here.",
    "    return far;",
    "}",
)


def place(kind, name, line, type_="int", loops=()):
    return Place(kind, name, "march", type_, FILE, line, 5, 10, 9, loops)


PLACES = [
    place("enter", "march", 1, ""),
    place("argument", "count", 1),
    place("iteration", "i", 3),
    place("set", "far", 4, loops=(2,)),
    place("return", "march", 9),
]


@pytest.fixture
def trace():
    """A run of the code above for a count of 20."""
    leaves = [Leaf(0, MARK, (0, 0, 0, 0)), leaf(1, 20)]
    far = 0
    for i in range(20):
        far += i
        leaves += [leaf(2, i), leaf(3, far)]
    calls, events = rebuild(PLACES, {}, [*leaves, leaf(4, far)])
    texel = {"picture": (190.0,)}
    return Trace(
        step="light.march", texel=(3, 4), iteration=(7,), outputs=texel, texel_values=texel, is_exact=True,
        calls=calls, events=events, is_complete=True, count=43, functions=("march",), others=(),
        files={FILE: CODE},
    )  # fmt: skip


def leaf(number, value):
    return Leaf(number, LEAF_TYPES.index("int"), (value, 0, 0, 0))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "true"),
        (-3, "-3"),
        (0.1 + 0.2, "0.3"),
        (16777217.0, "1.677722e+07"),
        (math.nan, "NaN"),
        (-math.inf, "-infinity"),
        ((0.5, 1.0), "(0.5, 1)"),
        (((1.0, 0.0), (0.0, 1.0)), "((1, 0), (0, 1))"),
        ([1, 2], "[1, 2]"),
        ({"far": 2.5, "cell": (1, 2)}, "{far = 2.5, cell = (1, 2)}"),
        (None, ""),
    ],
)
def test_a_value_is_written_as_a_person_reads_it(value, text):
    assert text_of(value) == text


def test_lines_have_the_values_of_all_iterations_or_of_one(trace):
    notes = {line.number: line.note for line in annotated(trace, FILE, 0)}
    assert list(notes) == list(range(1, 11)), "of one call, all of its function's lines"
    assert notes[1] == "count = 20" and notes[9] == "→ 190" and notes[2] == notes[10] == ""
    assert notes[4] == "far = 0 | 1 | 3 | … 16 … | 190"
    at = {line.number: line.note for line in annotated(trace, FILE, 0, at={3: 5})}
    assert (at[3], at[4], at[9]) == ("i = 5", "far = 15", "→ 190")


def test_far_lines_without_values_are_left_out(trace):
    text = listing(trace)
    assert text[0] == "── lighting/march.glsl"
    assert [line[:4].strip() for line in text[1:]] == ["1", "2", "3", "4", "⋮", "9"]
    assert all(len(line) <= 40 for line in listing(trace, width=40))


def test_conditions_of_many_iterations_are_signs(trace):
    event = trace.events[2]
    tests = [type(event)(**{**fields(event), "kind": "condition", "value": v}) for v in (True, False, True)]
    assert note_of(tests) == "? +-+" and note_of(tests[:1]) == "? true"


def fields(event):
    return {name: getattr(event, name) for name in event.__dataclass_fields__}


def test_a_long_loop_is_a_table_of_its_first_and_last_iterations(trace):
    table = loop_table(trace.loops()[0], rows=6)
    assert [line.split() for line in table] == [
        ["i", "far"], ["0", "0"], ["1", "1"], ["2", "3"], ["⋮", "⋮"], ["18", "171"], ["19", "190"],
    ]  # fmt: skip


def test_the_heading_says_whether_the_texel_has_the_same_bits(trace):
    assert {"light.march", "march.glsl", "(3, 4)", "iteration 7", "bit for bit"} <= parts(heading(trace))
    trace.is_exact, trace.outputs = False, {"picture": (190.5,)}
    assert "differs" in heading(trace) and "190.5" in heading(trace)
    trace.is_complete = False
    assert "of 43" in heading(trace)


def parts(text):
    return {
        part for part in ("light.march", "march.glsl", "(3, 4)", "iteration 7", "bit for bit") if part in text
    }
