"""A lesson in a notebook: its blocks by name, with what can be dragged of them, and verdicts on works."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from typing import Any

from PIL import Image

from playground.course import model
from playground.course.book.html import traced_code, traced_steps
from playground.course.book.live import widget_page
from playground.course.judging import JudgeProcess
from playground.course.library import SOURCE, Labels, decimal, labels
from playground.course.measures import measured
from playground.course.model import Compare, Figure, Scene, Slider, Steps
from playground.course.read import read_lesson
from playground.course.scenes import broken, bug_region, draw, spelled_value, with_value
from playground.course.tasks import (
    SHARE,
    CheckResult,
    Match,
    Picture,
    Verdict,
    Work,
    checks_itself,
    difference_map,
    points_of,
    scene_of,
    sentences,
    share_differing,
    starter,
)
from playground.course.traces import TracedLines, number_in, trace_of, traced
from playground.engine.frame import Frame
from playground.errors import SketchError, nearest
from playground.markup import Markup, data_url, joined, tag, with_code
from playground.paths import GLSL
from playground.publish.notebook.engine_thread import on_engine
from playground.shader.parameter import is_whole
from playground.sketch.assign import resolve, value_of, values_of
from playground.sketch.model import Value
from playground.sketch.replace_technique import with_texts

_STEPS = 200  # positions of a slider whose parameter has no step


@dataclass(frozen=True)
class Control:
    """Something to drag or to choose."""

    key: str  # parameter path, with ":0" and ":1" for the parts of a direction; or "frame"
    label: str
    kind: str  # range | choice | checkbox
    value: float
    low: float = 0.0
    high: float = 1.0
    step: float = 1.0
    choices: tuple[str, ...] = ()  # of a choice: their names; of a frame: one for each
    unit: str = ""


def controls_of(block: Figure | Steps | Slider | Compare, language: str, label: Labels) -> list[Control]:
    """Return what can be dragged of a block."""
    if isinstance(block, Figure):
        assert block.scene is not None
        return [control for path in block.sliders for control in _parameter(block.scene, path, label)]
    if isinstance(block, Steps):
        name = label("step")
        names = tuple(label("iteration", n=number) for number in block.iterations)
    elif isinstance(block, Slider):
        name = block.label or block.parameter
        names = tuple(spelled_value(block, value, language) for value in block.values)
    else:
        return [Control("frame", label("show"), "choice", 0.0, choices=block.labels)]
    start = 0 if isinstance(block, Steps) else len(names) // 2
    return [Control("frame", name, "range", float(start), 0.0, len(names) - 1.0, 1.0, names)]


def scene_at(block: Figure | Steps | Slider | Compare, values: Mapping[str, float]) -> Scene:
    """Return the picture of a block for values of its controls; raise ``ParameterError`` for a bad one."""
    if not isinstance(block, Figure):
        last = len(block.scenes) - 1
        return block.scenes[min(max(round(values.get("frame", 0.0)), 0), last)]
    assert block.scene is not None
    scene = block.scene
    for path in block.sliders:
        if path in values:
            scene = with_value(scene, path, _value(scene, path, values[path]))
        elif any(key in values for key in _parts(path)):
            now = value_of(scene.sketch, path, values_of(scene.sketch))
            assert isinstance(now, tuple)
            both = zip(_parts(path), now, strict=True)
            scene = with_value(scene, path, tuple(float(values.get(key, part)) for key, part in both))
    return scene


def _parts(path: str) -> tuple[str, str]:
    """Return the keys of a direction's azimuth and elevation."""
    return f"{path}:0", f"{path}:1"


def _parameter(scene: Scene, path: str, label: Labels) -> list[Control]:
    parameter = resolve(scene.sketch.graph, path)[0].parameter
    value = value_of(scene.sketch, path, values_of(scene.sketch))
    widget = parameter.widget
    if widget.kind == "menu" and isinstance(value, int):
        return [Control(path, parameter.title, "choice", float(value), choices=widget.choices)]
    if parameter.type == "bool":
        return [Control(path, parameter.title, "checkbox", float(bool(value)))]
    if widget.kind == "direction" and isinstance(value, tuple):
        azimuth, elevation = _parts(path)
        return [
            Control(azimuth, label("azimuth"), "range", value[0] % 360.0, 0.0, 360.0, 0.5, unit="°"),
            Control(elevation, label("elevation"), "range", float(value[1]), -90.0, 90.0, 0.5, unit="°"),
        ]
    if isinstance(value, tuple | str) or widget.low is None or widget.high is None:
        return []  # other vectors and files are set in code: with_values
    whole = is_whole(parameter.type)
    step = 1.0 if whole else parameter.step or (widget.high - widget.low) / _STEPS
    unit = parameter.unit
    return [Control(path, parameter.title, "range", float(value), widget.low, widget.high, step, unit=unit)]


def _value(scene: Scene, path: str, number: float) -> Value:
    parameter = resolve(scene.sketch.graph, path)[0].parameter
    if parameter.type == "bool":
        return bool(number)
    if is_whole(parameter.type):
        return round(number)
    return float(number)


_MARKS = {True: "✓", False: "✗"}
_COMPILERS = "list-style:none;white-space:pre-wrap;font:0.9em monospace"  # a compiler's words, as it has them
_WIDE = 200  # pixels of a picture on the page


@dataclass(frozen=True, eq=False)
class Checked:
    """A verdict that a notebook shows."""

    verdict: Verdict
    language: str

    def __str__(self) -> str:
        return "\n".join([points_of(self.verdict, self.language), *self.lines])

    @property
    def lines(self) -> list[str]:
        """A line for each check, with its mark."""
        passed = [result.passed for result in self.verdict.results] or [False] * len(self.verdict.diagnostics)
        said = sentences(self.verdict, self.language)
        return [f"{_MARKS[good]} {words}" for good, words in zip(passed, said, strict=True)]

    def _repr_html_(self) -> str:
        drawn = bool(self.verdict.results)
        style = "list-style:none" if drawn else _COMPILERS
        lines = [tag("li", with_code(line) if drawn else line, style=style) for line in self.lines]
        wrong = [result for result in self.verdict.visible if not result.passed]
        return joined(
            tag("p", tag("b", points_of(self.verdict, self.language))),
            tag("ul", *lines),
            *(_compared(result, self.language) for result in wrong if result.mine is not None),
        )


@dataclass(frozen=True, eq=False)
class Matched:
    """A score that a notebook shows, with the picture to match and one's own."""

    match: Match
    best: float
    language: str

    def __str__(self) -> str:
        if self.match.diagnostics:
            return "\n".join(map(str, self.match.diagnostics))
        say, match = labels("tasks", self.language), self.match
        said = say("score", score=int(match.score), best=int(self.best), goal=match.goal)
        return f"{said} {say['solved']}" if match.solved else said

    def _repr_html_(self) -> str:
        pictures = (("wanted", self.match.target), ("mine", self.match.mine))
        say = labels("tasks", self.language)
        shown = [_picture(picture, say[key]) for key, picture in pictures if picture is not None]
        return joined(tag("p", str(self)), tag("div", *shown))


def _compared(result: CheckResult, language: str) -> Markup:
    label = labels("tasks", language)
    mine, expected = result.mine, result.expected
    assert mine is not None and expected is not None
    shown = [_picture(mine, label["mine"]), _picture(expected, label["wanted"])]
    if mine.shape == expected.shape:
        shown.append(_picture(difference_map(mine, expected), label["differs"]))
    return tag("div", *shown)


def _picture(picture: Picture, name: str) -> Markup:
    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "PNG")
    image = tag("img", src=data_url("image/png", stream.getvalue()), alt=name, width=_WIDE)
    style = "display:inline-block;margin:0 .5em 0 0;text-align:center"
    return tag("figure", image, tag("figcaption", name), style=style)


def open_lesson(name: str, language: str = SOURCE) -> NotebookLesson:
    """Return a lesson for a notebook; raise ``SketchError`` for a name or language there is not."""
    return NotebookLesson(read_lesson(name, language))


@cache
def judge_process() -> JudgeProcess:
    """Return the one process that checks tasks, started at the first call."""
    return JudgeProcess()


def _work(task: model.Task, text: str | Mapping[str, Value]) -> Work:
    """Return what a student gives as a work; raise ``SketchError`` for a text where values are asked for."""
    if isinstance(text, str) and not task.file:
        what = ", ".join(f'"{path}": …' for path in task.sliders)
        raise SketchError(f"'{task.name}' asks for values: {{{what}}}")
    return Work(text) if isinstance(text, str) else Work(values=dict(text))


@dataclass(frozen=True, eq=False)
class Fixed(Frame):
    """The picture that edited lines make, with a verdict: whether the bug is fixed."""

    verdict: str = ""

    def _repr_html_(self) -> str:
        source = data_url("image/png", self._repr_png_())
        return tag("p", self.verdict) + tag("img", src=source, alt=self.verdict)


_STYLE = (
    ".traced :is(th,td){text-align:left;vertical-align:top}"
    ".traced .beside :is(td,th){font-family:monospace}"
    ".traced .beside code{white-space:pre-wrap;background:none}"
    ".traced .beside td:last-child>span{display:block}"
)
_TO_STEP = (
    "const f=this.closest('figure');"
    "for(const e of f.querySelectorAll('[data-at]'))e.textContent=JSON.parse(e.dataset.at)[this.value];"
    "const t=JSON.parse(f.dataset.steps)[this.value];"
    "f.querySelector('output').textContent=t;this.setAttribute('aria-valuetext',t)"
)
"""What a slider does in a notebook's page, which has no script of its own."""


@dataclass(frozen=True, eq=False)
class Traced:
    """Lines of a shader with a texel's values, that a notebook shows with a slider over their loop."""

    lines: TracedLines
    label: Labels

    def __str__(self) -> str:
        return "\n\n".join(filter(None, (self.lines.text(), self.lines.markdown())))

    def _repr_html_(self) -> str:
        lines = self.lines
        if not lines.steps:
            return tag(
                "figure", tag("style", Markup(_STYLE)), traced_code(lines, self.label), class_="traced"
            )
        labels = [lines.label(index) for index in range(len(lines.steps))]
        slider = tag(
            "input",
            type="range",
            min=0,
            max=len(labels) - 1,
            value=0,
            oninput=_TO_STEP,
            aria_label=lines.loop,
            style="width:20em;vertical-align:middle",
        )
        control = tag("label", slider, Markup(" "), tag("output", labels[0]))
        return tag(
            "figure",
            tag("style", Markup(_STYLE)),
            traced_code(lines, self.label, at=0),
            control,
            traced_steps(lines, self.label),
            class_="traced",
            data_steps=json.dumps(labels, ensure_ascii=False),
        )


class NotebookLesson:
    """A lesson whose blocks can be shown one by one."""

    def __init__(self, lesson: model.Lesson) -> None:
        self.lesson = lesson
        self.label = labels("book", lesson.language)
        self._best: dict[str, float] = {}  # score, by challenge

    def show(self, name: str) -> Any:
        """Return what a notebook shows of a block: a picture, with sliders where it has some.

        Raises ``SketchError`` for a block there is not, or one without a picture.
        """
        block = self._block(name)
        if isinstance(block, model.Figure | model.Steps | model.Slider | model.Compare):
            return self._dragged(block)
        if isinstance(block, model.Break):
            return self._frame(broken(block))
        if isinstance(block, model.Exercise | model.Challenge) and block.scene:
            return self._frame(block.scene)
        raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' has no picture")

    def measure(self, name: str) -> float:
        """Return the number of a measure, computed now."""
        block = self._block(name)
        if not isinstance(block, model.Measure):
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' measures nothing")
        return on_engine(lambda engine: measured(engine, block)).value

    def trace(self, name: str) -> Traced:
        """Return lines of a shader with the values of one texel, traced now.

        Raises ``SketchError`` for a block that is no trace.
        """
        block = self._block(name)
        if not isinstance(block, model.Trace):
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' is no trace")
        return Traced(on_engine(lambda engine: traced(engine, self.lesson, block)), self.label)

    def answer(self, name: str, number: str | float) -> str:
        """Return whether a number is what a question asks for, in the lesson's language.

        Raises ``SketchError`` for a block that asks for no number.
        """
        block = self._block(name)
        if not isinstance(block, model.Question) or block.of is None:
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' asks for no number")
        if number_in(str(number)) is None:
            return self.label("no_number")
        expected = self.trace(trace_of(self.lesson, block).name).lines.answer(block)
        if not expected.accepts(str(number)):
            return self.label("wrong_number")
        return self.label("right_number", value=decimal(expected.text, self.lesson.language))

    def fix(self, name: str, lines: str) -> Fixed:
        """Return the picture that a shader makes with other lines in place of those with the bug.

        Raises ``ShaderError`` naming what is wrong with the lines.
        """
        block = self._block(name)
        if not isinstance(block, model.Break) or block.scene is None:
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' is no bug to fix")
        text = bug_region(block).with_lines(lines)
        path = str((GLSL / block.file).resolve())
        sketch = block.scene.sketch.plainly()  # what is compared is the text, not a fast variant
        tried = replace(block.scene, sketch=with_texts(sketch, {path: text}), plain=False)
        frame, correct = self._frame(tried), self._frame(replace(block.scene, sketch=sketch))
        fixed = share_differing(frame.array, correct.array) <= SHARE
        return Fixed(frame.array, frame.sketch, frame.time, self.label("fixed" if fixed else "not_yet"))

    def exercise(self, name: str) -> Frame:
        """Return the picture that an exercise or a challenge begins from.

        Raises ``SketchError`` for a block there is not, or one that does not check itself.
        """
        task = self._task(name)
        return self._frame(scene_of(task, starter(task)))

    def check(self, name: str, work: str | Mapping[str, Value]) -> Checked:
        """Return the verdict on an exercise: of the text of its kernel, or of values by parameter path.

        The work is judged in a process of its own. Raises ``SketchError`` for a block that is no exercise, or
        one that does not check itself.
        """
        task = self._task(name)
        if not isinstance(task, model.Exercise):
            raise SketchError(f"block '{name}' is a picture to match: lesson.match scores it")
        verdict = judge_process().check(task, _work(task, work))
        assert isinstance(verdict, Verdict)
        return Checked(verdict, self.lesson.language)

    def match(self, name: str, work: str | Mapping[str, Value]) -> Matched:
        """Return how near a work is to the picture of a challenge, and the best score; else as ``check``."""
        task = self._task(name)
        if not isinstance(task, model.Challenge):
            raise SketchError(f"block '{name}' is no picture to match: lesson.check checks it")
        match = judge_process().check(task, _work(task, work))
        assert isinstance(match, Match)
        self._best[name] = max(match.score, self._best.get(name, 0.0))
        return Matched(match, self._best[name], self.lesson.language)

    def _task(self, name: str) -> model.Exercise | model.Challenge:
        block = self._block(name)
        if not checks_itself(block):
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' does not check itself")
        return block

    def _block(self, name: str) -> model.Named:
        named = self.lesson.named
        if name not in named:
            raise SketchError(f"lesson '{self.lesson.name}' has no block '{name}'{nearest(name, named)}")
        return named[name]

    def _frame(self, scene: model.Scene) -> Frame:
        return on_engine(lambda engine: draw(engine, scene))

    def _dragged(self, block: model.Figure | model.Steps | model.Slider | model.Compare) -> Any:
        controls = controls_of(block, self.lesson.language, self.label)

        def png(values: Mapping[str, float]) -> bytes:
            return self._frame(scene_at(block, values))._repr_png_()

        if not controls:
            return self._frame(scene_at(block, {}))
        try:
            from playground.course.notebook.widget import PictureWidget
        except ModuleNotFoundError:
            return self._frame(scene_at(block, {control.key: control.value for control in controls}))
        labels = controls[0].choices if not isinstance(block, model.Figure) else ()
        page = on_engine(lambda engine: widget_page(block, engine))
        language = self.lesson.language
        rows = [asdict(control) for control in controls]
        return PictureWidget(png, rows, block.alt, page=page, labels=labels, language=language)
