"""The pictures of a presentation, in the window's own view: figures, steps, sweeps, bugs; and its sliders."""

from __future__ import annotations

from dataclasses import dataclass, replace

from playground.course.figure_renders import with_bug
from playground.course.model import Break, Compare, Exercise, Slider, Steps
from playground.course.talk.beat import Beat, Still
from playground.course.tasks.work import path_of, starter_text
from playground.course.window.bugs import file_of
from playground.course.window.reader import Reader
from playground.course.window.tasks import BEGUN
from playground.errors import ParameterError, PlaygroundError
from playground.shader.parameter import is_whole, write
from playground.sketch.assign import range_of, resolve
from playground.sketch.model import Parameter, Value
from playground.studio.panel.parameter_list import items_of, shown_values
from playground.studio.panel.values import unit_of, value_fraction, with_fraction

_PARTS = 40
"""Presses of an arrow from one end of a slider to the other."""


@dataclass(frozen=True)
class Row:
    """A slider of the picture that is shown."""

    path: str
    title: str
    parameter: Parameter
    value: Value

    @property
    def share(self) -> float:
        """Where in its range its value is, 0 to 1."""
        try:
            return value_fraction(self.parameter, self.value)
        except (TypeError, ZeroDivisionError):
            return 0.0

    @property
    def text(self) -> str:
        """Its value, short, with its unit."""
        unit = unit_of(self.parameter)
        if isinstance(self.value, tuple):  # a direction's two angles have their units
            between = f"{unit}, " if unit == "°" else ", "
            return between.join(f"{part:.3g}" for part in self.value) + unit
        if isinstance(self.value, float):
            return f"{self.value:.4g}{unit}"
        return write(self.parameter, self.value).strip('"') + unit


@dataclass
class PresentedPictures:
    """Shows the beats of one reader's lesson in the view."""

    reader: Reader
    shown: Still | None = None

    def show(self, beat: Beat) -> None:
        """Show a beat's picture, unless it is shown and unchanged; a sweep plays from its beginning."""
        reader, still = self.reader, beat.still
        if still is None or reader.lesson is None:
            return
        block = reader.lesson.named.get(still.block)
        sweeps = beat.kind == "sweep"
        if still == self.shown and not sweeps and reader.figure.key is not None:
            return
        reader.playing = ""
        self.shown = still
        if isinstance(block, Break):
            self._bug(block, still)
        elif isinstance(block, Exercise) and still.started:
            self._begun(block)
        elif isinstance(block, Compare):
            reader.choose(block, still.index)
        elif isinstance(block, Steps | Slider):
            reader.move(block, still.index)
            if sweeps and isinstance(block, Slider):
                reader.at[block.name] = 0
                reader.play_or_pause(block)
                self.shown = replace(still, index=len(block.scenes) - 1)
        elif block is not None:
            reader.show(block)

    def sliders(self, beat: Beat) -> list[Row]:
        """Return the sliders that a beat's picture offers, as they are set; none while it is coming."""
        draft = self.reader.bench.session.shown
        if draft is None or self.reader.figure.busy or not beat.sliders:
            return []
        values = shown_values(draft)
        items = {item.leaf: item for item in items_of(draft).values()}
        rows = []
        for path in beat.sliders:
            try:
                item = items.get(resolve(draft.base.graph, path)[0].path)
            except ParameterError:
                item = None
            if item is not None:
                rows.append(Row(item.path, item.title, item.parameter, values.of[item.path]))
        return rows

    def slide(self, row: Row, by: float) -> None:
        """Move a slider by presses of an arrow, or turns of a wheel; a menu by its choices."""
        self.reader.playing = ""
        parameter, value = row.parameter, row.value
        if parameter.type == "bool":
            new: Value = by > 0
        elif parameter.widget.kind == "menu" and isinstance(value, int):
            new = min(max(value + (1 if by > 0 else -1), 0), len(parameter.widget.choices) - 1)
        else:
            new = with_fraction(parameter, value, row.share + by * _step(parameter))
        if new != value:
            self.reader.bench.session.drafts.set(row.path, new)

    def _bug(self, block: Break, still: Still) -> None:
        """Show a picture with or without its bug, and no editor for it."""
        if block.scene is None:
            return
        self._leave()
        try:
            texts = {str(file_of(block)): with_bug(block)} if still.broken else {}
        except PlaygroundError as error:
            self.reader.bench.notices.say(str(error))
            return
        self.reader.figure.show(block.scene, (block.name, still.index), texts)

    def _begun(self, block: Exercise) -> None:
        """Show what a student begins from, and no editor for it."""
        if block.begin is None:
            return
        self._leave()
        texts = {str(path_of(block)): starter_text(block)} if block.file else {}
        self.reader.figure.show(block.begin, (block.name, BEGUN), texts)

    def _leave(self) -> None:
        self.reader.tasks.leave()
        self.reader.bugs.leave()


def _step(parameter: Parameter) -> float:
    """Return the fraction of a slider's range that one press moves it by."""
    low, high = range_of(parameter) or (0.0, 1.0)
    if is_whole(parameter.type) and high > low:
        return max(round((high - low) / _PARTS), 1) / (high - low)
    return 1 / _PARTS
