"""A trace as text: values formatted, and the author's lines with what they gave beside them.

What shows a trace differs in medium, not in words: the terminal, a notebook, a lesson, an editor's hints and
the window take these lines.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from playground.engine.trace.model import Call, Event, Loop, Trace, Value

_DIGITS = 7  # of a float that stands alone: what tells each float32 of its neighbours, nearly
_SHORT = 4  # of several in a line
_MAX_GAP = 3  # lines without values between two with, that are shown
_MAX_CONDITIONS = 60


@dataclass(frozen=True, slots=True)
class AnnotatedLine:
    """A line of an author's file, and what it gave."""

    number: int  # from 1
    code: str
    note: str  # "sum = 1 | 3 | 6"; "" for a line that gave nothing
    events: tuple[Event, ...]
    is_finite: bool  # whether no value of it is NaN or infinite


def text_of(value: Value, *, short: bool = False) -> str:
    """Return a value as a person reads it: "(0.5, 1)", "true", "NaN", "{place = (1, 2), count = 3}".

    Of an array the elements that were recorded; a matrix by columns. ``short``: four digits, else seven.
    """
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case float():
            if math.isnan(value):
                return "NaN"
            if math.isinf(value):
                return "infinity" if value > 0 else "-infinity"
            return f"{value:.{_SHORT if short else _DIGITS}g}"
        case dict():
            return "{" + ", ".join(f"{k} = {text_of(v, short=short)}" for k, v in value.items()) + "}"
        case list():
            return "[" + ", ".join(text_of(part, short=short) for part in value) + "]"
    return "(" + ", ".join(text_of(part, short=short) for part in value) + ")"


def event_text(event: Event) -> str:
    """Return an event as a person reads it: "lit = 0.5", "free < 1.0 is true", "march returns 0.25"."""
    match event.kind:
        case "enter" | "leave" | "discard":
            return f"{event.kind} {event.name}".rstrip()
        case "return":
            return f"{event.name} returns {text_of(event.value)}"
        case "condition":
            return f"{event.name} is {text_of(event.value)}"
    return f"{event.name} = {text_of(event.value)}" if event.name else event.kind


def heading(trace: Trace) -> str:
    """Return what a trace is of, how much it recorded, and whether its result is the texel's."""
    file = Path(next(iter(trace.files), "")).name
    at = f" in iteration {', '.join(map(str, trace.iteration))}" if trace.iteration else ""
    values = f"{len(trace.events)} values in {len(trace.calls)} call{'s' if len(trace.calls) != 1 else ''}"
    if trace.is_discarded:
        result = "the fragment is discarded"
    elif trace.is_exact:
        result = "the result is the texel's, bit for bit"
    else:
        pairs = [
            f"{name} = {text_of(trace.outputs[name])} for {text_of(texel)}"
            for name, texel in trace.texel_values.items()
            if trace.outputs.get(name) != texel
        ]
        result = f"the result differs from the texel's in the last bits: {'; '.join(pairs)}"
    cut = "" if trace.is_complete else f"; the first of {trace.count}"
    return f"{trace.step} ({file}), texel {trace.texel}{at}: {values}{cut}; {result}"


def annotated(
    trace: Trace,
    path: str,
    call: Call | int | None = None,
    *,
    at: Mapping[int, int] | None = None,
    most: int = 5,
) -> list[AnnotatedLine]:
    """Return the lines of a file that gave values, with those between them that are near.

    ``call``: of that call alone, all of its function's lines. ``at``: by the line of a loop's head, the
    iteration whose values are shown; of other loops those of all iterations, ``most`` at most.
    """
    events = trace.lines(path, call)
    if at:
        events = {line: [event for event in here if _is_at(event, at)] for line, here in events.items()}
    code = trace.files.get(path, ())
    shown: set[int] = set()
    previous = 0
    for line in sorted(events):
        shown.update(range(line if line - previous > _MAX_GAP else previous, line + 1))
        previous = line
    if call is not None:
        of_call = trace.calls[call] if isinstance(call, int) else call
        if of_call.path == path:
            shown.update(range(of_call.line, of_call.end_line + 1))
    lines = []
    for number in sorted(shown - {0}):
        here = tuple(events.get(number, ()))
        text = code[number - 1] if number <= len(code) else ""
        note = note_of(here, most=most)
        lines.append(AnnotatedLine(number, text, note, here, all(event.is_finite for event in here)))
    return lines


def _is_at(event: Event, at: Mapping[int, int]) -> bool:
    pairs = zip(event.loops, event.iterations, strict=True)
    return all(at.get(line, iteration) == iteration for line, iteration in pairs)


def note_of(events: Sequence[Event], *, most: int = 5) -> str:
    """Return what some events of one line gave: "sum = 1 | 3 | 6", "→ 0.5", "? +-+"."""
    by_name: dict[str, list[Event]] = {}
    for event in events:
        if event.kind == "discard":
            by_name.setdefault("discarded", []).append(event)
        elif event.value is not None:
            name = {"return": "→", "condition": "?"}.get(event.kind, event.name)
            by_name.setdefault(name, []).append(event)
    return "   ".join(_values_note(name, some, most) for name, some in by_name.items())


def _values_note(name: str, events: Sequence[Event], most: int) -> str:
    if name == "discarded":
        return name
    several = len(events) > 1
    if name == "?" and several and all(isinstance(event.value, bool) for event in events):
        marks = "".join("+" if event.value else "-" for event in events)
        return f"? {marks[:_MAX_CONDITIONS]}{'…' if len(marks) > _MAX_CONDITIONS else ''}"
    texts = [text_of(event.value, short=several) for event in events]
    if len(texts) > most:
        texts = [*texts[: most - 2], f"… {len(texts) - most + 1} …", texts[-1]]
    return f"{name} {'' if name in ('→', '?') else '= '}{' | '.join(texts)}"


def listing(
    trace: Trace,
    call: Call | int | None = None,
    *,
    at: Mapping[int, int] | None = None,
    width: int = 150,
    most: int = 5,
) -> list[str]:
    """Return the files that gave values as lines of text, the kernel's own first; see ``annotated``.

    ``width``: letters of a line at most, of which the source takes half.
    """
    result: list[str] = []
    paths = dict.fromkeys([*trace.files, *(event.path for event in trace.events)])
    room = max(width // 2 - 5, 20)
    for path in paths:
        lines = annotated(trace, path, call, at=at, most=most)
        if not lines:
            continue
        result.append(f"── {short_path(path)}")
        before = lines[0].number - 1
        for line in lines:
            if line.number > before + 1:
                result.append("   ⋮")
            before = line.number
            code = line.code.expandtabs(4)
            code = code if len(code) <= room else code[: room - 1] + "…"
            text = f"{line.number:4} {code:{room}} │ {line.note}".rstrip()
            result.append(text if len(text) <= width else text[: width - 1] + "…")
    return result


def short_path(path: str) -> str:
    """Return a file as a title names it: below ``glsl/`` if it is there, else its name."""
    _, inside, rest = path.rpartition("/glsl/")
    return rest if inside else Path(path).name


def loop_table(loop: Loop, *, rows: int = 12) -> list[str]:
    """Return what a loop's iterations gave as a table: a line of names, then one an iteration.

    Of more than ``rows`` the first and the last two. A loop without a variable has a column of numbers.
    """
    names = list(dict.fromkeys(name for row in loop.rows for name in row))
    table = [[text_of(row.get(name), short=True) for name in names] for row in loop.rows]
    if not loop.variable:
        names.insert(0, "")
        table = [[str(number), *row] for number, row in enumerate(table)]
    if len(table) > rows:
        table = [*table[: rows - 3], ["⋮" for _ in names], *table[-2:]]
    table.insert(0, names)
    widths = [max(len(row[column]) for row in table) for column in range(len(names))]
    return ["  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in table]
