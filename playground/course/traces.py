"""Trace a texel for a lesson: lines of a shader with their values beside them, and answers taken from these.

A lesson's numbers, traces and answers are computed together, by ``results_of``, when it is shown or built;
a reader needs no OpenGL. What a question asks for is left out of the figure that it is about.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from playground.course.measures import Number, numbers_of
from playground.course.model import Asked, Lesson, Question, Trace
from playground.course.scenes import excerpt
from playground.engine.trace import listing
from playground.engine.trace.model import Call, Event, Loop
from playground.engine.trace.model import Trace as TexelTrace
from playground.errors import PlaygroundError, SketchError, nearest
from playground.paths import GLSL

if TYPE_CHECKING:
    from playground.engine.engine import Engine

HIDDEN = "?"
"""What stands in place of a value that a question asks for."""

RETURN = "return"
"""The name of what a call returns."""

Key = tuple[str, int | None]
"""A variable, and the step that it is of: a value of the loop's variable; None for what is there once."""


@dataclass(frozen=True)
class Beside:
    """What a line gave one name: its value, or its values by the steps of the loop."""

    name: str  # a variable, the text of a condition, RETURN
    kind: str  # set | condition | return
    texts: tuple[str, ...]  # one; of a line in the loop one for each step, "" where it did not run
    is_looped: bool = False
    hidden: Mapping[int, str] = field(default_factory=dict)  # the question that asks for one, by its index

    def text(self, index: int, *, reveals: bool = False) -> str:
        """Return the value at a step of the loop, by its index; without ``reveals`` answers are hidden."""
        at = index if self.is_looped else 0
        return self.phrase(self.texts[at] if at not in self.hidden or reveals else HIDDEN)

    def on_paper(self, rows: Sequence[int]) -> str:
        """Return the values of some steps of the loop one after the other, or the only one."""
        if not self.is_looped:
            return self.text(0)
        listed = (HIDDEN if index in self.hidden else self.texts[index] for index in rows)
        return self.phrase(" | ".join(filter(None, listed)))

    def phrase(self, value: str) -> str:
        """Return a value as it stands beside the line: "sum = 3", "→ 3", "? true"; "" for none."""
        signs = {"condition": "? ", "return": "→ "}
        return f"{signs.get(self.kind, f'{self.name} = ')}{value}" if value else ""


@dataclass(frozen=True)
class TracedLine:
    """A line of a shader."""

    number: int  # in its file, from 1
    code: str  # without the indentation that all have
    values: tuple[Beside, ...] = ()


@dataclass(frozen=True)
class TracedLines:
    """Lines of a shader with the values of one texel: all that a medium needs to show of a trace."""

    name: str  # of the block
    file: str  # in glsl/
    texel: tuple[int, int]
    lines: tuple[TracedLine, ...]
    loop: str = ""  # variable of the loop that is stepped through
    steps: tuple[int, ...] = ()  # its values; numbers from 0 where it does not count
    is_counter: bool = True
    columns: tuple[str, ...] = ()
    rows: tuple[int, ...] = ()  # indices of the steps in the table
    values: Mapping[Key, Any] = field(default_factory=dict)
    hidden: Mapping[Key, str] = field(default_factory=dict)  # the question that asks for one
    digits: int = 4

    def cell(self, column: str, index: int) -> str:
        """Return a cell of the table, by its column and the index of its step; "" where nothing was set."""
        key = column, self.steps[index]
        if key in self.hidden:
            return HIDDEN
        return text_of(self.values[key], self.digits) if key in self.values else ""

    def label(self, index: int) -> str:
        """Return what a step is called: "i = 3"; "i #3" where the variable is no whole number."""
        return f"{self.loop} {'= ' if self.is_counter else '#'}{self.steps[index]}"

    def text(self) -> str:
        """Return the lines with their values as text: of a loop, those of the table's rows."""
        wide = max(len(line.code) for line in self.lines)
        rows = []
        for line in self.lines:
            values = "   ".join(each.on_paper(self.rows) for each in line.values)
            rows.append(f"{line.code:{wide}}  │ {values}".rstrip())
        return "\n".join(rows)

    def markdown(self) -> str:
        """Return the table of the loop as Markdown; "" without a loop."""
        if not self.steps:
            return ""
        head = f"| {self.loop} | {' | '.join(f'`{name}`' for name in self.columns)} |"
        rows = [
            f"| {self.steps[row]} | {' | '.join(self.cell(name, row) for name in self.columns)} |"
            for row in self.rows
        ]
        return "\n".join([head, "|---" * (len(self.columns) + 1) + "|", *rows])

    def answer(self, question: Question) -> Answer:
        """Return what a question asks for; raise ``SketchError`` for a value that there is not."""
        asked = question.of
        assert asked is not None
        where = f"question '{question.name}': trace '{self.name}'"
        try:
            value = self._number(asked)
        except SketchError as error:
            raise SketchError(f"{where} {error.diagnostics[0].message}", line=question.line) from None
        return Answer(value, text_of(value, self.digits), _tolerance(value, self.digits))

    def _number(self, asked: Asked) -> float:
        name, component = _split(asked.variable, {name for name, _ in self.values})
        steps = [step for of, step in self.values if of == name]
        if not steps:
            names = dict.fromkeys(name for name, _ in self.values)
            hint = nearest(asked.variable, names) or f"; it has {', '.join(names)}"
            raise SketchError(f"has no variable '{asked.variable}'{hint}")
        if asked.step not in steps:
            numbers = [step for step in steps if step is not None]
            if asked.step is None:
                raise SketchError(f"has a value of {name} for each step: give step = …, {_span(numbers)}")
            if not numbers:
                raise SketchError(f"has one value of {name} and no steps: leave step out")
            raise SketchError(f"has no {name} at step {asked.step}: expected {_span(numbers)}")
        value = self.values[name, asked.step]
        if component:
            value = value["xyzw".index(component)]
        if isinstance(value, bool) or not isinstance(value, int | float):
            hint = f", as {name}.x" if isinstance(value, tuple) else ""
            what = f"gives {asked.variable} no number, but {text_of(value, 3)}"
            raise SketchError(f"{what}: ask for a number{hint}")
        if not math.isfinite(value):
            raise SketchError(f"gives {asked.variable} the value {value}, which nobody can compute")
        return value


@dataclass(frozen=True)
class Answer:
    """A number that a question asks for."""

    value: float
    text: str  # to the digits that the figure prints
    tolerance: float  # 0 for a whole number, else a unit of the last of these digits

    def accepts(self, text: str) -> bool:
        """Return whether a reader's text is the number; a comma may stand for the point."""
        number = number_in(text)
        return number is not None and abs(number - self.value) <= self.tolerance * (1 + 1e-9)


def number_in(text: str) -> float | None:
    """Return the number that a reader has written, with a point or a comma; None for anything else."""
    plain = re.sub(r"[\s_\u202f\u00a0]", "", text).replace("−", "-").replace(",", ".")
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", plain) or len(plain) > 40:
        return None
    number = float(plain)
    return number if math.isfinite(number) else None


@dataclass(frozen=True)
class Results:
    """What is computed of a lesson when it is shown: its numbers, its traces, its questions' answers."""

    numbers: Mapping[str, Number] = field(default_factory=dict)
    traces: Mapping[str, TracedLines] = field(default_factory=dict)
    answers: Mapping[str, Answer] = field(default_factory=dict)


def results_of(engine: Engine, lesson: Lesson) -> Results:
    """Compute all results of a lesson; raise ``PlaygroundError`` for one that there is not."""
    numbers = numbers_of(engine, lesson)
    blocks = [block for block in lesson.blocks if isinstance(block, Trace)]
    traces = {block.name: traced(engine, lesson, block) for block in blocks}
    numbers |= numbers_with_answers(lesson, traces)
    return Results(numbers, traces, answers_in(lesson, traces))


def answers_in(lesson: Lesson, traces: Mapping[str, TracedLines]) -> dict[str, Answer]:
    """Return the answers to the questions about some traces, by name; raise as ``TracedLines.answer``."""
    questions = [block for block in lesson.blocks if isinstance(block, Question) and block.of is not None]
    return {
        question.name: traces[question.of.trace].answer(question)
        for question in questions
        if question.of is not None and trace_of(lesson, question).name in traces
    }


def trace_of(lesson: Lesson, question: Question) -> Trace:
    """Return the trace that a question is about; raise ``SketchError`` for one that there is not."""
    assert question.of is not None
    names = {block.name: block for block in lesson.blocks if isinstance(block, Trace)}
    if question.of.trace not in names:
        hint = nearest(question.of.trace, names) or "; the lesson has none"
        message = f"question '{question.name}': no trace '{question.of.trace}'{hint}"
        raise SketchError(message, line=question.line)
    return names[question.of.trace]


def numbers_of_traces(engine: Engine, lesson: Lesson, names: Iterable[str]) -> dict[str, Number]:
    """Return those of some numbers that come from a lesson's traces; raise as ``traced``."""
    traces: dict[str, TracedLines] = {}
    for block in traces_named(lesson, names):
        traces[block.name] = traced(engine, lesson, block)
    return numbers_with_answers(lesson, traces)


def traces_named(lesson: Lesson, names: Iterable[str]) -> list[Trace]:
    """List the traces that some numbers come from: "march:ray:3", or a question about one."""
    needed = {name.partition(":")[0] for name in names}
    for block in lesson.blocks:
        if isinstance(block, Question) and block.of is not None and block.name in needed:
            needed.add(block.of.trace)
    return [block for block in lesson.blocks if isinstance(block, Trace) and block.name in needed]


def numbers_with_answers(lesson: Lesson, traces: Mapping[str, TracedLines]) -> dict[str, Number]:
    """Return the numbers that texts may name of some traces and of the questions about them."""
    numbers: dict[str, Number] = {}
    for lines in traces.values():
        numbers |= numbers_in(lines)
    answers = answers_in(lesson, traces).items()
    return numbers | {name: Number(answer.value, answer.text) for name, answer in answers}


def traced(engine: Engine, lesson: Lesson, block: Trace) -> TracedLines:
    """Trace the texel of a block, and return its lines; raise ``SketchError`` that names the block."""
    scene = block.scene
    assert scene is not None
    try:
        trace = engine.trace(
            scene.sketch,
            block.path,
            texel=block.texel,
            iteration=block.iteration or None,
            function=block.function or None,
            size=scene.pixels,
            time=scene.time,
        )
    except PlaygroundError as error:
        raise SketchError(f"trace '{block.name}': {error.diagnostics[0].message}", line=block.line) from None
    return lines_of(trace, block, lesson.asked(block.name))


def lines_of(trace: TexelTrace, block: Trace, asked: Mapping[Key, str] = MappingProxyType({})) -> TracedLines:
    """Return the lines of a block with what a trace gave them.

    ``asked`` are the values that questions ask for, with their names. Raises ``SketchError`` for a
    function, a call, a loop, a variable, an iteration or an anchor that there is not, for a run that was
    cut short, and for one whose result differs from the texel's in the digits that are shown.
    """
    try:
        return _lines_of(trace, block, asked)
    except SketchError as error:
        raise SketchError(f"trace '{block.name}': {error.diagnostics[0].message}", line=block.line) from None


def _lines_of(trace: TexelTrace, block: Trace, asked: Mapping[Key, str]) -> TracedLines:
    _check_run(trace, block)
    shown = excerpt(block.file, block.anchor)
    call = _call(trace, block)
    if _file_of(call.path) != block.file:
        raise SketchError(f"{call.function} is in {_file_of(call.path)}, not in {block.file}")
    if not any(call.line <= number <= call.end_line for number in shown.numbers):
        raise SketchError(f"anchor '{block.anchor}' lies outside of {call.function}; set function")
    loop = _loop(trace, call, block)
    steps, is_counter = _steps(loop) if loop else ((), True)
    values = dict(_values(call, loop, steps))
    names = dict.fromkeys(name for name, _ in values)
    for variable in block.variables:
        if variable not in names:
            hint = nearest(variable, names) or f"; it has {', '.join(names)}"
            raise SketchError(f"{call.function} gives '{variable}' no value{hint}")
    hidden = {(_split(name, names)[0], step): question for (name, step), question in asked.items()}
    by_line: dict[int, list[Event]] = {}
    for event in call.events:
        if event.path == call.path and event.kind in ("argument", "set", "iteration", "condition", "return"):
            by_line.setdefault(event.line, []).append(event)
    lines = tuple(
        TracedLine(number, code, tuple(_beside(by_line.get(number, []), loop, steps, hidden, block.digits)))
        for number, code in shown.lines
    )
    return TracedLines(
        name=block.name,
        file=block.file,
        texel=trace.texel,
        lines=lines,
        loop=block.loop,
        steps=steps,
        is_counter=is_counter,
        columns=block.variables,
        rows=_rows(block, steps),
        values=values,
        hidden=hidden,
        digits=block.digits,
    )


def _check_run(trace: TexelTrace, block: Trace) -> None:
    if not trace.is_complete:
        message = f"the run has {trace.count} values, and {len(trace.events)} events were recorded"
        raise SketchError(f"{message}: choose a texel or parameters with fewer iterations")
    for name, texel in trace.texel_values.items():
        here, there = (text_of(value, block.digits) for value in (trace.outputs[name], texel))
        if here != there:
            raise SketchError(
                f"the traced run gives {name} = {here}, the texel has {there}: show fewer digits"
            )


def _call(trace: TexelTrace, block: Trace) -> Call:
    function = block.function or trace.calls[0].function
    calls = trace.calls_of(function)
    if not calls:
        hint = nearest(function, (*trace.functions, *trace.others))
        raise SketchError(f"the texel's run does not call '{function}'{hint}")
    if block.call > len(calls):
        raise SketchError(f"call = {block.call}: {function} is called {_times(len(calls))}")
    return calls[block.call - 1]


def _loop(trace: TexelTrace, call: Call, block: Trace) -> Loop | None:
    if not block.loop:
        return None
    loops = {loop.variable: loop for loop in reversed(trace.loops(call)) if loop.variable}
    if block.loop not in loops:
        names = f"; it runs one over {', '.join(loops)}" if loops else "; it runs none"
        hint = nearest(block.loop, loops) or names
        raise SketchError(f"{call.function} runs no loop over '{block.loop}'{hint}")
    return loops[block.loop]


def _steps(loop: Loop) -> tuple[tuple[int, ...], bool]:
    """Return the number of each iteration, and whether it is the loop's variable: else it counts from 0."""
    values = [row.get(loop.variable) for row in loop.rows]
    if all(type(value) is int for value in values) and len(set(values)) == len(values):
        return tuple(value for value in values if value is not None), True
    return tuple(range(len(values))), False


def _rows(block: Trace, steps: Sequence[int]) -> tuple[int, ...]:
    """Return the indices of the steps in the table."""
    for row in block.rows:
        if row not in steps:
            raise SketchError(f"rows: the loop over {block.loop} has no step {row}: expected {_span(steps)}")
    return tuple(steps.index(row) for row in block.rows)


def _values(call: Call, loop: Loop | None, steps: Sequence[int]) -> Iterator[tuple[Key, Any]]:
    """Yield each variable's last value: of a step where it is set in the loop, else of the call."""
    for event in call.events:
        if event.kind == "return":
            yield (RETURN, None), event.value
        elif event.name and event.kind in ("argument", "set", "iteration", "condition"):
            number = _number_in(event, loop)
            yield (event.name, None if number is None else steps[number]), event.value


def _number_in(event: Event, loop: Loop | None) -> int | None:
    """Return in which iteration of a run of a loop an event is; None for one outside of it."""
    if loop is None or loop.place not in event.around:
        return None
    depth = event.around.index(loop.place)
    return event.iterations[depth] if event.iterations[:depth] == loop.iterations else None


def _beside(
    events: Sequence[Event], loop: Loop | None, steps: Sequence[int], hidden: Mapping[Key, str], digits: int
) -> Iterator[Beside]:
    """Yield what stands beside a line: each name once, with its last value, or that of each step."""
    by_name: dict[tuple[str, str], list[Event]] = {}
    for event in events:
        kind = event.kind if event.kind in ("condition", "return") else "set"
        by_name.setdefault((RETURN if kind == "return" else event.name, kind), []).append(event)
    for (name, kind), ours in by_name.items():
        numbers = [_number_in(event, loop) for event in ours]
        is_looped = any(number is not None for number in numbers)
        if is_looped:
            texts = [""] * len(steps)
            for event, number in zip(ours, numbers, strict=True):
                if number is not None:
                    texts[number] = text_of(event.value, digits)
            keys: dict[int, Key] = {index: (name, step) for index, step in enumerate(steps)}
            keys = dict.fromkeys(keys, (RETURN, None)) if kind == "return" else keys
        else:
            texts = [text_of(ours[-1].value, digits)]
            keys = {0: (name, None)}
        if any(texts):
            asked = {index: hidden[key] for index, key in keys.items() if key in hidden}
            yield Beside(name, kind, tuple(texts), is_looped, asked)


def _file_of(path: str) -> str:
    file = Path(path).resolve()
    return file.relative_to(GLSL.resolve()).as_posix() if file.is_relative_to(GLSL.resolve()) else file.name


def _split(variable: str, names: Iterable[str]) -> tuple[str, str]:
    """Return a variable and the component that is asked for; "" for all of it."""
    name, dot, component = variable.rpartition(".")
    if variable in names or not dot or len(component) != 1 or name not in names:
        return variable, ""
    index = max(letters.find(component) for letters in ("xyzw", "rgba"))
    return (name, "xyzw"[index]) if index >= 0 else (variable, "")


def _span(steps: Sequence[int]) -> str:
    return f"{min(steps)} to {max(steps)}"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _tolerance(value: float, digits: int) -> float:
    """Return a unit of the last of so many significant digits of a number; 0 for a whole one."""
    if isinstance(value, int):
        return 0.0
    power = math.floor(math.log10(abs(value))) if value else 0
    return 10.0 ** (power - digits + 1)


def numbers_in(lines: TracedLines) -> dict[str, Number]:
    """Return the numbers that a text may name: ``march:ray:3``, ``march:gain`` for what is there once."""
    numbers = {}
    for (name, step), value in lines.values.items():
        if isinstance(value, int | float) and math.isfinite(value):
            key = f"{lines.name}:{name}" if step is None else f"{lines.name}:{name}:{step}"
            numbers[key] = Number(float(value), text_of(value, lines.digits).replace("-", "−"))
    return numbers


def text_of(value: Any, digits: int = 4) -> str:
    """Return a value as it stands beside the code, its numbers to significant digits."""
    return listing.text_of(_rounded(value, digits))


def _rounded(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    if isinstance(value, dict):
        return {name: _rounded(part, digits) for name, part in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(_rounded(part, digits) for part in value)
    return value
