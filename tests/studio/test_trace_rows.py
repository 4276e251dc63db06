"""A trace as rows: values behind lines, sliders, sparklines, calls, two traces beside each other."""

from __future__ import annotations

import math

from playground.engine.trace.model import Trace
from playground.studio.trace.rows import (
    FunctionHead,
    Item,
    LoopHead,
    Row,
    Selection,
    TraceView,
    matching_lines,
)

from .hand_traces import FAR, FILE, HEAD_OF_KERNEL, HEAD_OF_MARCH, HIT, RAYS, STEPS, SUM, TEXT, march_trace

KERNEL, MARCH = (FILE, "kernel", HEAD_OF_KERNEL), (FILE, "march", HEAD_OF_MARCH)


def row(view: TraceView, line: int) -> Row:
    return view.rows(FILE)[line - 1]


def texts(view: TraceView, line: int) -> list[tuple[str, str]]:
    return [(item.name, item.text) for item in row(view, line).items]


def loop(view: TraceView, line: int) -> LoopHead:
    (head,) = row(view, line).loops
    return head


def head(view: TraceView, line: int) -> FunctionHead:
    found = row(view, line).head
    assert found is not None
    return found


def item(view: TraceView, line: int, name: str) -> Item:
    return next(item for item in row(view, line).items if item.name == name)


def test_a_line_has_what_its_last_iteration_gave() -> None:
    view = TraceView(march_trace())
    assert loop(view, RAYS).chosen == 2 and loop(view, RAYS).count == 3
    assert texts(view, RAYS) == [("ray", "2")]
    assert head(view, HEAD_OF_MARCH).number == 3, "the call that this iteration made"
    assert texts(view, FAR) == [("far", "32")]  # 1 * 2^5: the first above 20
    assert texts(view, HIT) == [("?", "true"), ("→", "32")]


def test_choosing_an_iteration_chooses_the_calls_it_made() -> None:
    view = TraceView(march_trace())
    view.choose_iteration(loop(view, RAYS), 0)
    assert texts(view, HEAD_OF_MARCH) == [("start", "-1")]
    assert loop(view, STEPS).count == 9 and texts(view, FAR) == [("far", "-512")]
    view.choose_iteration(loop(view, STEPS), 2)
    assert texts(view, STEPS) == [("i", "2")] and texts(view, FAR) == [("far", "-8")]
    assert texts(view, SUM) == [("sum", "NaN")], "the caller's iteration stays"


def test_choosing_a_call_chooses_the_iteration_that_made_it() -> None:
    view = TraceView(march_trace())
    view.choose_call(MARCH, 1)
    assert loop(view, RAYS).chosen == 1
    assert head(view, HEAD_OF_MARCH).number == 2 and head(view, HEAD_OF_MARCH).is_linked
    assert texts(view, HEAD_OF_MARCH) == [("start", "0")]


def test_a_sparkline_shows_the_last_float_that_changes() -> None:
    view = TraceView(march_trace())
    assert loop(view, STEPS).plotted == "far"
    assert loop(view, STEPS).series == tuple(2.0**n for n in range(1, 6))
    view.selection.plotted[loop(view, STEPS).key] = "i"
    view.choose_call(MARCH, 0)
    assert loop(view, STEPS).series == tuple(float(n) for n in range(9))


def test_what_is_chosen_holds_for_the_next_trace() -> None:
    selection = Selection()
    view = TraceView(march_trace(), selection)
    view.choose_call(MARCH, 0)
    view.choose_iteration(loop(view, STEPS), 2)
    again = TraceView(march_trace(factor=3.0), selection)
    assert texts(again, FAR) == [("far", "-27")]
    moved = TraceView(march_trace(factor=3.0, text=["", *TEXT], shift=1), selection)
    assert texts(moved, FAR + 1) == [("far", "-27")], "its function has moved down a line"


def test_a_choice_beyond_the_end_is_the_last() -> None:
    selection = Selection(calls={MARCH: 70}, iterations={(KERNEL, RAYS - HEAD_OF_KERNEL): 70})
    view = TraceView(march_trace(), selection)
    assert head(view, HEAD_OF_MARCH).number == 3 and loop(view, RAYS).chosen == 2


def test_lines_that_the_moment_did_not_reach_are_marked() -> None:
    view = TraceView(march_trace())
    assert not row(view, 7).is_reached, "only a march of nine steps comes to its end"
    view.choose_call(MARCH, 0)
    assert row(view, 7).is_reached and texts(view, 7) == [("→", "-512")]
    assert row(view, 9).is_reached, "an empty line gives nothing anywhere"


def test_the_first_not_finite_event_is_gone_to() -> None:
    trace = march_trace()
    view, event = TraceView(trace), trace.first_not_finite()
    assert event is not None and event.line == SUM
    view.go_to(event)
    assert loop(view, RAYS).chosen == 0 and not item(view, SUM, "sum").is_finite
    assert math.isnan(item(view, SUM, "sum").event.value)


def test_values_stand_beside_those_of_another_trace() -> None:
    view = TraceView(march_trace(), other=march_trace(factor=3.0))
    view.choose_call(MARCH, 0)
    view.choose_iteration(loop(view, STEPS), 1)
    assert item(view, FAR, "far").text == "-4" and item(view, FAR, "far").other == "-9"
    assert item(view, HEAD_OF_MARCH, "start").other == "", "the same in both"


def test_the_first_event_that_differs_is_marked() -> None:
    view = TraceView(march_trace(), other=march_trace(factor=3.0))
    assert view.difference is not None and view.difference[0] is not None
    view.go_to(view.difference[0])
    assert [line for line in range(1, 17) if any(i.parts for i in row(view, line).items)] == [FAR]
    assert texts(view, FAR) == [("far", "-2")] and item(view, FAR, "far").other == "-3"
    assert TraceView(march_trace(), other=march_trace()).difference is None


def test_two_texels_part_where_their_runs_take_different_paths() -> None:
    other = march_trace(factor=3.0)
    other.texel = 4, 5
    view = TraceView(march_trace(), other=other)
    assert view.difference is not None and view.difference[0] is not None
    # Of the march from 1: 2, 4, 8, 16 against 3, 9, 27, which is above 20.
    view.go_to(view.difference[0])
    assert view.difference[0].line == HIT and loop(view, RAYS).chosen == 2 and loop(view, STEPS).chosen == 2


def test_a_trace_of_an_edited_text_is_compared_line_by_line() -> None:
    edited = [*TEXT[:3], "        far = far * 3.0;", *TEXT[4:]]
    before = march_trace(factor=3.0, text=["// new", *edited], shift=1)
    view = TraceView(march_trace(), other=before)
    view.choose_call(MARCH, 2)
    view.choose_iteration(loop(view, STEPS), 0)
    assert item(view, FAR, "far").other == "3", "that line stands where the edited one does"


def test_matching_lines_pair_what_is_the_same_and_what_replaces() -> None:
    assert matching_lines("a b c d".split(), "a x c d".split()) == {1: 1, 2: 2, 3: 3, 4: 4}
    assert matching_lines("a b c".split(), "new a b c".split()) == {1: 2, 2: 3, 3: 4}
    assert matching_lines("a b c".split(), "a c".split()) == {1: 1, 3: 2}


def test_a_vector_is_plotted_by_its_components() -> None:
    trace = march_trace()
    for call in trace.calls_of("march"):
        for at, event in enumerate(call.events):
            if event.name == "far":
                object.__setattr__(event, "value", (event.value, 7.0))
                call.events[at] = event
    view = TraceView(trace)
    assert {"far.x", "far.y"} <= set(loop(view, STEPS).names)
    view.selection.plotted[loop(view, STEPS).key] = "far.x"
    view.choose_call(MARCH, 2)
    assert loop(view, STEPS).series[:2] == (2.0, 4.0)


def test_a_trace_without_events_shows_the_text_alone() -> None:
    empty = Trace("height", (0, 0), (), {}, {}, True, [], [], True, 0, (), (), {FILE: tuple(TEXT)})
    rows = TraceView(empty).rows(FILE)
    assert [row.code for row in rows] == TEXT and not any(row.items or row.loops for row in rows)
