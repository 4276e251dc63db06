"""A trace as rows of code: which call and which iteration is chosen, and what each line gave there.

No screen and no OpenGL: ``TraceView`` turns a trace and a selection into rows, sliders and sparklines. A
selection outlives its trace, so that another texel, another time or an edited text shows the same call and
the same iteration where it has them. What is shown belongs to one moment as far as there is one: to choose an
iteration chooses the calls that it made, and to choose a call the iteration that made it.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from functools import cached_property

from playground.engine.trace.listing import text_of
from playground.engine.trace.model import Call, Event, Loop, Trace, Value, first_difference
from playground.studio.language import tr

FunctionKey = tuple[str, str, int]
"""A function: its file, its name, the line of its head."""
LoopKey = tuple[FunctionKey, int]
"""A loop: its function, and how many lines below the function's head it begins."""

LAST = -1
"""The last iteration of a loop, however many it has."""
_MAX_VALUES = 4  # of one name on one line in one moment


@dataclass
class Selection:
    """What a person chose; it holds for any trace."""

    calls: dict[FunctionKey, int] = field(default_factory=dict)  # its number among those of the function
    iterations: dict[LoopKey, int] = field(default_factory=dict)
    plotted: dict[LoopKey, str] = field(default_factory=dict)  # the name that a sparkline shows


@dataclass(frozen=True)
class Item:
    """What one name gave on a line."""

    name: str  # "far", "→" of what is returned, "?" of a condition
    text: str  # short
    full: str  # as the author wrote the name, with all digits and all values
    is_finite: bool
    event: Event  # the last one
    other: str = ""  # what it gave in the other trace, where that is something else
    parts: bool = False  # here the two traces part


@dataclass(frozen=True)
class LoopHead:
    """A loop at its head: the slider, and what the sparkline shows."""

    key: LoopKey
    place: int  # see ``Event.place``
    count: int  # iterations
    chosen: int  # from 0
    plotted: str  # the name of the series; "" where no name has numbers
    names: tuple[str, ...]  # that can be plotted
    series: tuple[float | None, ...]  # a number an iteration; None where it gave none


@dataclass(frozen=True)
class FunctionHead:
    """A function at its head: which of its calls is shown."""

    key: FunctionKey
    call: int  # index into ``Trace.calls``
    number: int  # from 1, among the calls of the function
    count: int
    is_linked: bool  # whether the chosen iterations of its caller made it


@dataclass(frozen=True)
class Row:
    """One line of a file."""

    number: int  # from 1
    code: str
    items: tuple[Item, ...] = ()
    loops: tuple[LoopHead, ...] = ()
    head: FunctionHead | None = None
    is_reached: bool = True  # False: within a function that ran, and the chosen moment gave nothing there


class TraceView:
    """One trace, as it is shown; ``other`` is a second one beside it, whose selection is the same."""

    def __init__(self, trace: Trace, selection: Selection | None = None, other: Trace | None = None) -> None:
        self.trace = trace
        self.selection = selection or Selection()
        self._functions: dict[FunctionKey, list[Call]] = {}
        for call in trace.calls:
            self._functions.setdefault((call.path, call.function, call.line), []).append(call)
        self._adopt()
        self._indexes = [[event.index for event in call.events] for call in trace.calls]
        self._loops: dict[int, dict[tuple[int, tuple[int, ...]], Loop]] = {}
        self._rows: dict[str, tuple[Row, ...]] = {}
        self._line_maps: dict[str, Mapping[int, int]] = {}
        self._other = TraceView(other) if other is not None else None
        self._linked: frozenset[FunctionKey] = frozenset()
        self._link()

    @property
    def paths(self) -> list[str]:
        """The files with recorded calls, the kernel's own first."""
        called = {call.path for call in self.trace.calls}
        return [path for path in self.trace.files if path in called] or list(self.trace.files)[:1]

    @cached_property
    def difference(self) -> tuple[Event | None, Event | None] | None:
        """The first events at which this trace and the other part; None for nowhere, or no other.

        Two texels differ in their arguments already: of them it is where their runs take different paths.
        """
        if self._other is None:
            return None
        one, other = self.trace, self._other.trace
        parted = first_difference(one, other, values=False) if one.texel != other.texel else None
        return parted or first_difference(one, other)

    def rows(self, path: str) -> tuple[Row, ...]:
        """Return the lines of a file, with what they gave in the chosen moment."""
        if path not in self._rows:
            self._rows[path] = tuple(self._rows_of(path))
        return self._rows[path]

    def stack(self) -> list[Call]:
        """Return the chosen calls, outermost first, down to the first one chosen at each depth."""
        shown = [calls[self._number(key)] for key, calls in self._functions.items()]
        return sorted(shown, key=lambda call: (call.depth, call.index))

    def calls_of(self, key: FunctionKey) -> list[Call]:
        """Return the calls of a function, in order."""
        return self._functions.get(key, [])

    # ── choosing ─────────────────────────────────────────────────────────────

    def choose_call(self, key: FunctionKey, number: int) -> None:
        """Show a call of a function, by its number from 0, and the iterations of its callers that made it."""
        calls = self.calls_of(key)
        if calls:
            self._choose(calls[min(max(number, 0), len(calls) - 1)])
            self._link()

    def choose_iteration(self, head: LoopHead, number: int) -> None:
        """Show an iteration of a loop, from 0, and the calls that it made."""
        self.selection.iterations[head.key] = LAST if number >= head.count - 1 else max(number, 0)
        self._link()

    def plot(self, head: LoopHead, name: str) -> None:
        """Show another name in a loop's sparkline."""
        self.selection.plotted[head.key] = name
        self._rows.clear()

    def go_to(self, event: Event) -> None:
        """Show the call and the iterations in which an event was."""
        call = self.trace.calls[event.call]
        self._choose(call)
        self._choose_iterations(call, event)
        self._link()

    def _choose(self, call: Call) -> None:
        """Choose a call, and those around it with the iterations that made them."""
        self.selection.calls[_key_of(call)] = self._functions[_key_of(call)].index(call)
        if call.caller is not None:
            caller = self.trace.calls[call.caller]
            self._choose(caller)
            moment = self._moment(call)
            if moment is not None:
                self._choose_iterations(caller, moment)

    def _choose_iterations(self, call: Call, event: Event) -> None:
        loops = self._loops_of(call)
        for depth, place in enumerate(event.around):
            loop = loops.get((place, event.iterations[:depth]))
            if loop is not None:
                number = event.iterations[depth]
                key = (_key_of(call), loop.line - call.line)
                self.selection.iterations[key] = LAST if number >= len(loop.rows) - 1 else number

    def _moment(self, call: Call) -> Event | None:
        """Return what the caller did last before it made a call."""
        if call.caller is None or not call.events:
            return None
        at = bisect_left(self._indexes[call.caller], call.events[0].index)
        return self.trace.calls[call.caller].events[at - 1] if at else None

    def _link(self) -> None:
        """Choose, of each function, a call that the chosen moments of others made, if there is one."""
        self._rows.clear()
        chosen: dict[int, bool] = {}  # by index of a chosen call: whether its moment is the chosen one
        linked = set()
        for key, calls in sorted(self._functions.items(), key=lambda item: item[1][0].index):
            fits = [call for call in calls if self._fits(call, chosen)]
            now = calls[self._number(key)]
            if fits and now not in fits:
                now = fits[0]
                self.selection.calls[key] = calls.index(now)
            chosen[now.index] = now in fits
            if now in fits:
                linked.add(key)
        self._linked = frozenset(linked)
        if self._other is not None:
            self._mirror(self._other)

    def _mirror(self, other: TraceView) -> None:
        """Choose in the other trace what is chosen in this one, function by function."""
        chosen = other.selection = Selection()
        for key in self._functions:
            at = self._lines_in_other(key[0]).get(key[2], 0)
            chosen.calls[*key[:2], at] = self._number(key)
        for (key, below), number in self.selection.iterations.items():
            lines = self._lines_in_other(key[0])
            at = lines.get(key[2], 0)
            chosen.iterations[(*key[:2], at), lines.get(key[2] + below, at) - at] = number
        other._link()

    def _fits(self, call: Call, chosen: Mapping[int, bool]) -> bool:
        if call.caller is None:
            return True
        if call.caller not in chosen:
            return False
        moment = self._moment(call)
        return moment is None or self._is_chosen(self.trace.calls[call.caller], moment)

    def _adopt(self) -> None:
        """Keep what is chosen of functions that have moved to other lines of their files."""
        chosen = self.selection
        lines: dict[tuple[str, str], list[int]] = {}
        for path, name, line in self._functions:
            lines.setdefault((path, name), []).append(line)
        moved: dict[FunctionKey, FunctionKey] = {}
        for key in {*chosen.calls, *(k for k, _ in chosen.iterations), *(k for k, _ in chosen.plotted)}:
            here = lines.get(key[:2], [])
            if key not in self._functions and len(here) == 1:
                moved[key] = (*key[:2], here[0])
        chosen.calls = {moved.get(key, key): number for key, number in chosen.calls.items()}
        chosen.iterations = {(moved.get(k, k), at): n for (k, at), n in chosen.iterations.items()}
        chosen.plotted = {(moved.get(k, k), at): name for (k, at), name in chosen.plotted.items()}

    # ── what is chosen ───────────────────────────────────────────────────────

    def _number(self, key: FunctionKey) -> int:
        """Return which of a function's calls is chosen, from 0."""
        return min(self.selection.calls.get(key, 0), len(self._functions[key]) - 1)

    def _loops_of(self, call: Call) -> dict[tuple[int, tuple[int, ...]], Loop]:
        if call.index not in self._loops:
            loops = self.trace.loops(call)
            self._loops[call.index] = {(loop.place, loop.iterations): loop for loop in loops}
        return self._loops[call.index]

    def _iteration(self, call: Call, loop: Loop) -> int:
        number = self.selection.iterations.get((_key_of(call), loop.line - call.line), LAST)
        last = len(loop.rows) - 1
        return last if number == LAST else min(number, last)

    def _is_chosen(self, call: Call, event: Event) -> bool:
        """Return whether an event is in the chosen iteration of each loop around it."""
        loops = self._loops_of(call)
        for depth, place in enumerate(event.around):
            loop = loops.get((place, event.iterations[:depth]))
            if loop is not None and event.iterations[depth] != self._iteration(call, loop):
                return False
        return True

    # ── rows ─────────────────────────────────────────────────────────────────

    def _rows_of(self, path: str) -> Iterator[Row]:
        items: dict[int, list[Item]] = {}
        loops: dict[int, list[LoopHead]] = {}
        heads: dict[int, FunctionHead] = {}
        inside: dict[int, bool] = {}  # lines of functions that ran: whether the moment gave something there
        for key, calls in self._functions.items():
            call = calls[self._number(key)]
            if key[0] == path:
                linked = key in self._linked
                heads[key[2]] = FunctionHead(key, call.index, self._number(key) + 1, len(calls), linked)
                events = [event for each in calls for event in each.events if event.value is not None]
                silent = {event.line for event in events if event.path == path}
                inside |= dict.fromkeys(silent, False)
            for line, more in self._items(call, path).items():
                items.setdefault(line, []).extend(more)
                inside[line] = True
            for line, heads_of_loops in self._heads(call, path).items():
                loops.setdefault(line, []).extend(heads_of_loops)
        for number, code in enumerate(self.trace.files.get(path, ()), 1):
            mine = tuple(items.get(number, ()))
            yield Row(
                number,
                code,
                self._compared(path, number, mine),
                tuple(loops.get(number, ())),
                heads.get(number),
                inside.get(number, True),
            )

    def _items(self, call: Call, path: str) -> dict[int, list[Item]]:
        """Return what the lines of a file gave in a call, in the chosen iterations."""
        events: dict[int, dict[tuple[str, str], list[Event]]] = {}
        for event in call.events:
            valued = event.value is not None or event.kind == "discard"
            if event.path == path and valued and self._is_chosen(call, event):
                name = (event.kind, event.name)
                events.setdefault(event.line, {}).setdefault(name, []).append(event)
        return {
            line: [_item(kind, name, mine) for (kind, name), mine in by_name.items()]
            for line, by_name in events.items()
        }

    def _heads(self, call: Call, path: str) -> dict[int, list[LoopHead]]:
        """Return the loops of a call that the chosen moment has, by line."""
        heads: dict[int, list[LoopHead]] = {}
        around = {event.place: event.around[:-1] for event in call.events if event.kind == "iteration"}
        for (place, outer), loop in self._loops_of(call).items():
            if loop.path != path:
                continue
            whole = zip(around.get(place, ()), range(len(outer)), strict=False)
            shown = [(self._loops_of(call).get((p, outer[:depth])), outer[depth]) for p, depth in whole]
            if any(other is not None and self._iteration(call, other) != n for other, n in shown):
                continue
            key = (_key_of(call), loop.line - call.line)
            names = plottable(loop.rows)
            plotted = self.selection.plotted.get(key, "")
            plotted = plotted if plotted in names else default_series(loop, names)
            chosen = self._iteration(call, loop)
            series = tuple(number_in(row, plotted) for row in loop.rows) if plotted else ()
            head = LoopHead(key, place, len(loop.rows), chosen, plotted, names, series)
            heads.setdefault(loop.line, []).append(head)
        return heads

    # ── beside another trace ─────────────────────────────────────────────────

    def _compared(self, path: str, number: int, items: tuple[Item, ...]) -> tuple[Item, ...]:
        """Return the items of a line with what they are in the other trace."""
        if self._other is None or not items:
            return items
        other = {(i.event.kind, i.event.name): i for i in self._other_items(path, number)}
        first = self.difference[0] if self.difference is not None else None
        result = []
        for item in items:
            beside = other.get((item.event.kind, item.event.name))
            text = tr("none") if beside is None else beside.text if beside.full != item.full else ""
            parts = first is not None and item.event.index == first.index
            result.append(Item(item.name, item.text, item.full, item.is_finite, item.event, text, parts))
        return tuple(result)

    def _other_items(self, path: str, number: int) -> Sequence[Item]:
        assert self._other is not None
        at, rows = self._lines_in_other(path).get(number, 0), self._other.rows(path)
        return rows[at - 1].items if 0 < at <= len(rows) else ()

    def _lines_in_other(self, path: str) -> Mapping[int, int]:
        """Return the line of the other trace's text for each line of a file that has one."""
        assert self._other is not None
        if path not in self._line_maps:
            here, there = (trace.files.get(path, ()) for trace in (self.trace, self._other.trace))
            self._line_maps[path] = matching_lines(here, there)
        return self._line_maps[path]


def _key_of(call: Call) -> FunctionKey:
    return call.path, call.function, call.line


def _item(kind: str, name: str, events: Sequence[Event]) -> Item:
    shown = {"return": "→", "condition": "?", "discard": ""}.get(kind, name)
    if kind == "discard":
        return Item("", "discard", tr("the run ends here: discard"), True, events[-1])
    short = [text_of(event.value, short=True) for event in events]
    if len(short) > _MAX_VALUES:
        short = [*short[: _MAX_VALUES - 2], "…", short[-1]]
    full = " | ".join(text_of(event.value) for event in events)
    title = tr("returns {value}", value=full) if kind == "return" else f"{name} = {full}"
    finite = all(event.is_finite for event in events)
    return Item(shown, " | ".join(short), title, finite, events[-1])


# ── series ────────────────────────────────────────────────────────────────────


def plottable(rows: Sequence[Mapping[str, Value]]) -> tuple[str, ...]:
    """Return the names of a loop that have numbers; of a vector each component: "p.x"."""
    names: dict[str, None] = {}
    for row in rows:
        for name, value in row.items():
            if isinstance(value, int | float):
                names[name] = None
            elif isinstance(value, tuple) and value and not isinstance(value[0], tuple):
                names |= dict.fromkeys(f"{name}.{part}" for part, _ in zip("xyzw", value, strict=False))
    return tuple(names)


def number_in(row: Mapping[str, Value], name: str) -> float | None:
    """Return a number that an iteration gave, by a name of ``plottable``; None where it gave none."""
    value = row.get(name)
    if value is None:
        base, _, part = name.rpartition(".")
        vector = row.get(base)
        at = "xyzw".find(part) if len(part) == 1 else -1
        value = vector[at] if isinstance(vector, tuple) and 0 <= at < len(vector) else None
    return float(value) if isinstance(value, int | float) else None


def default_series(loop: Loop, names: Sequence[str]) -> str:
    """Return the name that a loop's sparkline shows first: the last float that changes, not the counter."""
    best = ""
    for name in names:
        numbers = [row.get(name) for row in loop.rows]
        floats = [n for n in numbers if isinstance(n, float)]
        if name != loop.variable and len(set(map(repr, floats))) > 1:
            best = name
    return best or next(iter(names), "")


def matching_lines(one: Sequence[str], other: Sequence[str]) -> dict[int, int]:
    """Return the line of another version of a text for each line that has one, both from 1.

    Lines that were edited stand for each other where as many are in their place.
    """
    if one == other:
        return {number: number for number in range(1, len(one) + 1)}
    pairs: dict[int, int] = {}
    matcher = SequenceMatcher(None, one, other, autojunk=False)
    for what, a, b, c, d in matcher.get_opcodes():
        if what == "equal" or (what == "replace" and b - a == d - c):
            pairs |= {a + n + 1: c + n + 1 for n in range(b - a)}
    return pairs
