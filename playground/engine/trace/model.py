"""What a trace is: the events of one run of a kernel, in calls and iterations, with their values.

A traced shader records leaves: numbers with up to four components. ``rebuild`` joins them into events by
the table of places that ``instrument`` writes beside the shader. Nothing here needs OpenGL.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, NamedTuple

LEAF_TYPES = (
    *("float", "vec2", "vec3", "vec4", "int", "ivec2", "ivec3", "ivec4"),
    *("uint", "uvec2", "uvec3", "uvec4", "bool", "bvec2", "bvec3", "bvec4"),
)
"""Types that one leaf holds; a leaf's code is the index here."""
LENGTH = len(LEAF_TYPES)
"""Code of a leaf before the elements of an array: its length, and how many of them are recorded."""
MARK = LENGTH + 1
"""Code of a leaf without a value."""
MAX_ELEMENTS = 16
"""Elements of an array that are recorded."""
MAX_EVENTS = 2**16
"""Leaves of a run that are recorded unless a caller says otherwise: nine in ten runs have below 6,200."""
MATRICES = {f"mat{c}x{r}": (c, r) for c in (2, 3, 4) for r in (2, 3, 4)} | {
    f"mat{n}": (n, n) for n in (2, 3, 4)
}
"""Columns and rows of each matrix type."""

Value = Any
"""float | int | bool | tuple of them | tuple of columns | list (array) | dict (struct) | None."""


class Leaf(NamedTuple):
    """What a traced shader records at once."""

    place: int  # index into the table of places
    code: int  # of its type: an index into LEAF_TYPES, LENGTH or MARK
    bits: tuple[int, int, int, int]  # of each component, as unsigned numbers


@dataclass(frozen=True, slots=True)
class Place:
    """Where and what a traced shader records: an entry of the table beside it."""

    kind: str  # enter | argument | set | iteration | condition | return | leave | discard
    name: str  # as written: "sum", "rows[i]", a condition; at enter, return and leave the function
    function: str
    type: str  # in GLSL: "vec3", "float[4]", "March"; "" where it has no value
    path: str  # absolute, of the author's file
    line: int  # from 1
    column: int  # from 1, of the name or expression
    end_line: int  # of a function at enter, else of the expression
    end_column: int  # behind its last letter
    loops: tuple[int, ...] = ()  # the iteration places of the loops around it, outermost first


Structs = Mapping[str, Sequence[tuple[str, str]]]
"""The (member, type) pairs of each struct whose members are recorded, by name."""


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that a run did: it entered a function, set a variable, tested a condition, and so on."""

    index: int  # in Trace.events
    kind: str  # enter | argument | set | iteration | condition | return | leave | discard
    name: str  # what is set or tested, as written: "sum", "p.xy", "rows[i]"; the function of a call
    type: str  # in GLSL: "vec3", "float[4]", "March"; "" for none
    value: Value
    path: str  # absolute, of the author's file
    line: int  # from 1
    column: int  # from 1
    end_column: int  # behind its last letter, on the line where the expression ends
    call: int  # index into Trace.calls
    iterations: tuple[int, ...]  # of each loop around it, from 0, outermost first
    loops: tuple[int, ...]  # the line of each of these loops
    place: int  # what the same place of the text records has the same number
    around: tuple[int, ...] = ()  # the places of the iterations of these loops

    @property
    def is_finite(self) -> bool:
        """Whether no number of its value is NaN or infinite."""
        return all(math.isfinite(number) for number in numbers_of(self.value))


@dataclass(slots=True)
class Call:
    """One call of a function: its events, without those of the calls in it."""

    index: int
    function: str
    path: str  # absolute, of the author's file
    line: int  # of its head, from 1
    end_line: int  # of its closing bracket
    caller: int | None  # index of the recorded call that it was made from
    depth: int  # 0: nothing recorded is around it
    events: list[Event] = field(default_factory=list)

    def __getitem__(self, name: str) -> Value:
        """Return the last value of a variable, argument or condition, as the text writes it.

        Raises ``KeyError`` with the names that there are.
        """
        values = self.values(name)
        if not values:
            names = ", ".join(dict.fromkeys(event.name for event in self._valued()))
            raise KeyError(f"{self.function} gives '{name}' no value; it gives {names or 'none'}")
        return values[-1]

    def values(self, name: str) -> list[Value]:
        """Return all values of a variable, argument or condition in this call, in order."""
        return [event.value for event in self._valued() if event.name == name]

    @property
    def result(self) -> Value:
        """What it returned; None of a void function, and where its end is not recorded."""
        return next((event.value for event in reversed(self.events) if event.kind == "return"), None)

    def _valued(self) -> Iterator[Event]:
        return (e for e in self.events if e.kind in ("argument", "set", "iteration", "condition") and e.name)


@dataclass(frozen=True, slots=True)
class Loop:
    """One run of a loop: what each of its iterations gave."""

    line: int  # of its head, from 1
    variable: str  # "" for a loop without
    path: str  # absolute, of the author's file
    call: int  # index into Trace.calls
    iterations: tuple[int, ...]  # where it is in the loops around it, outermost first
    rows: list[dict[str, Value]]  # the last value of each name, an iteration each
    place: int  # of its iterations, see Event.place


@dataclass(slots=True)
class Trace:
    """Every recorded value of one run of a pass's shader for one texel.

    ``playground.trace`` and ``Engine.trace`` return one:

        trace = playground.trace("l_dot_n", "product", texel=(10, 20))
        assert trace.is_exact and isinstance(trace, playground.Trace)
    """

    step: str  # path of the pass: "height.detail"
    texel: tuple[int, int]  # column and row, from the south-west
    iteration: tuple[int, ...]  # of the loops and the repeat around it, from 0, outermost first
    outputs: dict[str, tuple[float, ...]]  # by the traced run
    texel_values: dict[str, tuple[float, ...]]  # of the untraced shader
    is_exact: bool  # whether these agree bit for bit
    calls: list[Call]
    events: list[Event]
    is_complete: bool  # else the limit of events cut it
    count: int  # leaves of the whole run, recorded or not
    functions: tuple[str, ...]  # those that are recorded
    others: tuple[str, ...]  # those that could be
    files: dict[str, tuple[str, ...]]  # the lines of the author's files, by path, the kernel's own first
    is_discarded: bool = False  # whether the run ended in a discard
    # How a notebook shows it; None: as its text.
    as_html: Callable[[Trace], str] | None = field(default=None, repr=False, compare=False)

    def calls_of(self, function: str) -> list[Call]:
        """Return the calls of a ``function``, in order.

        For example:

            trace = playground.trace("l_dot_n", "product", texel=(10, 20))
            print(trace.calls_of("kernel")[0]["slope"])
        """
        return [call for call in self.calls if call.function == function]

    def lines(self, path: str, call: Call | int | None = None) -> dict[int, list[Event]]:
        """Return the events of the file at ``path`` by line, of one ``call`` or of all, in order.

        For example:

            trace = playground.trace("l_dot_n", "product", texel=(10, 20))
            for line, events in trace.lines(trace.events[0].path).items():
                print(line, [event.value for event in events])
        """
        result: dict[int, list[Event]] = {}
        for event in self.events if call is None else self._call(call).events:
            if event.path == path:
                result.setdefault(event.line, []).append(event)
        return result

    def loops(self, call: Call | int | None = None) -> list[Loop]:
        """Return the runs of all loops, of one ``call`` or of all, in the order in which they begin.

        For example:

            trace = playground.trace("diamond_square", "height.raw", texel=(96, 96), iteration=7)
            for loop in trace.loops():
                print(loop.variable, [row["total"] for row in loop.rows])
        """
        calls = self.calls if call is None else [self._call(call)]
        return [loop for each in calls for loop in _loops(each)]

    def first_not_finite(self) -> Event | None:
        """Return the first event that has NaN or an infinity, if there is one.

        For example:

            trace = playground.trace("l_dot_n", "product", texel=(10, 20))
            assert trace.first_not_finite() is None
        """
        return next((event for event in self.events if not event.is_finite), None)

    def table(self) -> Any:
        """Return all events as a ``DataFrame`` of pandas, a row each; without pandas as a list of rows.

        A row has ``kind``, ``name``, ``type``, ``value``, ``function``, ``call``, ``iterations``, ``line``
        and ``path``.

            table = playground.trace("l_dot_n", "product", texel=(10, 20)).table()
            print(len(table))
        """
        rows = [
            {
                "kind": event.kind,
                "name": event.name,
                "type": event.type,
                "value": event.value,
                "function": self.calls[event.call].function,
                "call": event.call,
                "iterations": event.iterations,
                "line": event.line,
                "path": event.path,
            }
            for event in self.events
        ]
        try:
            pandas = import_module("pandas")
        except ImportError:
            return rows
        return pandas.DataFrame(rows)

    def _repr_html_(self) -> str | None:
        return None if self.as_html is None else self.as_html(self)

    def _call(self, call: Call | int) -> Call:
        return self.calls[call] if isinstance(call, int) else call


def _loops(call: Call) -> list[Loop]:
    """Return the runs of the loops of one call."""
    result: list[Loop] = []
    open_loops: dict[int, Loop] = {}  # by place
    for event in call.events:
        for place in [place for place in open_loops if place not in (*event.around, event.place)]:
            del open_loops[place]
        if event.kind == "iteration":
            loop = open_loops.get(event.place)
            if loop is None or event.iterations[-1] == 0:
                around = event.iterations[:-1]
                loop = Loop(event.line, event.name, event.path, call.index, around, [], event.place)
                open_loops[event.place] = loop
                result.append(loop)
            loop.rows.append({event.name: event.value} if event.name else {})
        elif event.name and event.kind in ("set", "condition", "argument"):
            for place in event.around:
                if place in open_loops:
                    open_loops[place].rows[-1][event.name] = event.value
    return result


def first_difference(
    one: Trace, other: Trace, *, values: bool = True
) -> tuple[Event | None, Event | None] | None:
    """Return the first events at which two traces part, by kind, name, function and value; None for nowhere.

    One of them is None where its trace ends before. Lines do not count, so a trace may be compared with
    that of an edited text. Without ``values``, it is where the runs take different paths.
    """
    for index in range(max(len(one.events), len(other.events))):
        first, second = (t.events[index] if index < len(t.events) else None for t in (one, other))
        if first is None or second is None or _facts(one, first, values) != _facts(other, second, values):
            return first, second
    return None


def _facts(trace: Trace, event: Event, values: bool) -> tuple[object, ...]:
    """Return what two runs are compared by; NaN equals NaN, and 0 is not -0."""
    decides = values or event.kind == "condition"
    function = trace.calls[event.call].function
    return event.kind, event.name, function, event.type, repr(event.value) if decides else None


def numbers_of(value: Value) -> Iterator[float]:
    """Yield each number of a value."""
    if isinstance(value, int | float):
        yield value
    elif isinstance(value, dict):
        for part in value.values():
            yield from numbers_of(part)
    elif value is not None:
        for part in value:
            yield from numbers_of(part)


# ── from leaves to events ────────────────────────────────────────────────────


def rebuild(
    places: Sequence[Place], structs: Structs, leaves: Iterable[Leaf]
) -> tuple[list[Call], list[Event]]:
    """Join the leaves of a run into events, and find for each its call and its iterations.

    What is left of a value whose last leaves are missing, since the limit cut the run, is left out.
    """
    return _Rebuild(places, structs).run(leaves)


class _Cut(Exception):
    """The leaves end within a value."""


class _Rebuild:
    def __init__(self, places: Sequence[Place], structs: Structs) -> None:
        self.places, self.structs = places, structs
        self.calls: list[Call] = []
        self.events: list[Event] = []
        self._stack: list[int] = []  # calls that are not left
        self._counts: list[dict[int, int]] = []  # of each of them: the iteration, by its place
        self._lines = [place.line for place in places]

    def run(self, leaves: Iterable[Leaf]) -> tuple[list[Call], list[Event]]:
        """Return the calls and events of a run."""
        rest = iter(leaves)
        for leaf in rest:
            place = self.places[leaf.place]
            try:
                value = self._value(place.type, leaf, rest)
            except _Cut:
                break
            self._add(leaf.place, place, value)
        return self.calls, self.events

    def _add(self, number: int, place: Place, value: Value) -> None:
        if place.kind == "enter" or not self._stack:
            # Without one to enter it, a run that begins in the middle: see the limit of events.
            caller = self._stack[-1] if self._stack else None
            depth = len(self._stack)
            index = len(self.calls)
            call = Call(index, place.function, place.path, place.line, place.end_line, caller, depth)
            self.calls.append(call)
            self._stack.append(index)
            self._counts.append({})
        counts = self._counts[-1]
        if place.kind == "iteration":
            for inner in [inner for inner in counts if inner not in place.loops and inner != number]:
                del counts[inner]
            counts[number] = counts.get(number, -1) + 1
        around = (*place.loops, number) if place.kind == "iteration" else place.loops
        for ended in [loop for loop in counts if loop not in around]:
            del counts[ended]
        event = Event(
            index=len(self.events),
            kind=place.kind,
            name=place.name,
            type=place.type,
            value=value,
            path=place.path,
            line=place.line,
            column=place.column,
            end_column=place.end_column,
            call=self._stack[-1],
            iterations=tuple([counts.get(loop, 0) for loop in around]),
            loops=tuple([self._lines[loop] for loop in around]),
            place=number,
            around=around,
        )
        self.events.append(event)
        self.calls[event.call].events.append(event)
        if place.kind in ("return", "leave"):
            self._stack.pop()
            self._counts.pop()

    def _value(self, kind: str, leaf: Leaf, rest: Iterator[Leaf]) -> Value:
        """Return the value of a type that begins with a leaf."""
        if leaf.code == MARK:
            return None
        if leaf.code == LENGTH:
            element = kind.partition("[")[0]
            return [self._value(element, self._next(rest), rest) for _ in range(leaf.bits[1])]
        if kind in MATRICES:
            columns = [leaf, *(self._next(rest) for _ in range(MATRICES[kind][0] - 1))]
            return tuple([number_of(column.code, column.bits) for column in columns])
        if kind in self.structs:
            members, first = {}, leaf
            for index, (name, member) in enumerate(self.structs[kind]):
                members[name] = self._value(member, first if index == 0 else self._next(rest), rest)
            return members
        return number_of(leaf.code, leaf.bits)

    @staticmethod
    def _next(rest: Iterator[Leaf]) -> Leaf:
        leaf = next(rest, None)
        if leaf is None:
            raise _Cut
        return leaf


_FORMS = {"f": "<4f", "i": "<4i", "u": "<4I"}


def number_of(code: int, bits: Sequence[int]) -> Value:
    """Return the number or the tuple of numbers that a leaf holds."""
    name = LEAF_TYPES[code]
    count = int(name[-1]) if name[-1].isdigit() else 1
    if name.startswith("b"):
        numbers: tuple[Any, ...] = tuple([bit != 0 for bit in bits[:count]])
    else:
        form = _FORMS["f" if name.startswith(("float", "vec")) else name[0]]
        numbers = struct.unpack(form, struct.pack("<4I", *bits))[:count]
    return numbers[0] if count == 1 else numbers
