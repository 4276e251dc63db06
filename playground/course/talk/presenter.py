"""A lesson in front of a class, without a window: which beat is on, what covers it, what was drawn on it.

Keys, clickers and the page of notes all end here. Pictures are shown by who owns them: see
``stage.PresentedPictures``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from playground.course.model import Lesson
from playground.course.talk.beats import Beat, beats_of, first_of_page
from playground.errors import ParameterError
from playground.shader.parameter import write
from playground.sketch.model import Parameter, Value
from playground.studio.panel.values import unit_of, value_fraction

TYPED = 3.0
"""[s] after its last digit that a typed number is forgotten."""

Point = tuple[float, float]
"""A place on the picture: shares of its width and its height, from the upper left corner."""


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
class TalkClock:
    """How long the talk has taken; ``now`` gives seconds."""

    now: Callable[[], float]
    running: bool = True
    _before: float = 0.0
    _since: float = 0.0

    def __post_init__(self) -> None:
        self._since = self.now()

    @property
    def started_at(self) -> float:
        """The moment that it would have begun at, without a pause [s]; it stays while it runs."""
        return self._since - self._before

    @property
    def elapsed(self) -> float:
        """Seconds since the beginning, pauses aside."""
        return self._before + (self.now() - self._since if self.running else 0.0)

    def toggle(self) -> None:
        """Pause, or go on."""
        self._before, self._since = self.elapsed, self.now()
        self.running = not self.running

    def reset(self) -> None:
        """Begin at 0."""
        self._before, self._since = 0.0, self.now()


@dataclass
class Presenter:
    """The state of a presentation.

    ``show`` puts a beat's picture into the view; ``left`` is called with the last beat when it is over.
    """

    show: Callable[[Beat], None]
    left: Callable[[Beat], None] = lambda beat: None
    now: Callable[[], float] = lambda: 0.0
    lesson: Lesson | None = None
    beats: tuple[Beat, ...] = ()
    at: int = 0  # which beat is on, from 0
    on: bool = False
    blank: str = ""  # "black", "white": what covers the screen
    helps: bool = False  # the keys are shown
    laser: bool = False
    pen: bool = False
    slider: int = -1  # which of the beat's sliders the arrows move
    typed: str = ""  # digits so far, of a beat's number
    notice: str = ""  # a sentence for the teacher, until the next key
    strokes: dict[int, list[list[Point]]] = field(default_factory=dict)  # by beat

    def __post_init__(self) -> None:
        self.clock = TalkClock(self.now)
        self._typed_at = 0.0

    # ── beginning and end ────────────────────────────────────────────────────

    def begin(self, lesson: Lesson, *, beat: int | None = None, page: int = 0) -> None:
        """Begin at a beat, from 0, else at the first of a page; raise as ``beats_of`` does."""
        beats = beats_of(lesson)
        if lesson != self.lesson:
            self.strokes.clear()
        self.lesson, self.beats = lesson, beats
        self.blank, self.typed, self.notice = "", "", ""
        self.helps = self.laser = self.pen = False
        self.on, self.slider = True, -1
        self.clock = TalkClock(self.now)
        first_beat = first_of_page(beats, page) if beat is None else beat
        self.at = min(max(first_beat, 0), len(beats) - 1)
        self.show(self.beat)

    def end(self) -> None:
        """Leave the presentation."""
        if self.on:
            self.on = False
            self.left(self.beat)

    # ── beats ────────────────────────────────────────────────────────────────

    @property
    def beat(self) -> Beat:
        """The beat that is on."""
        return self.beats[self.at]

    @property
    def following(self) -> Beat | None:
        """The beat after it; None at the end."""
        return self.beats[self.at + 1] if self.at + 1 < len(self.beats) else None

    def next(self) -> None:
        """Go to the next beat; a blank screen comes back first."""
        self._turn(1)

    def back(self) -> None:
        """Go to the beat before; a blank screen comes back first."""
        self._turn(-1)

    def go(self, beat: int) -> None:
        """Go to a beat, from 0; at the ends it stays there."""
        beat_index = min(max(beat, 0), len(self.beats) - 1)
        self.blank, self.helps, self.typed, self.notice = "", False, "", ""
        if beat_index != self.at:
            self.at, self.slider = beat_index, -1
            self.show(self.beat)

    def _turn(self, by: int) -> None:
        if self.blank or self.helps:
            self.blank, self.helps = "", False
        else:
            self.go(self.at + by)

    # ── what covers it ───────────────────────────────────────────────────────

    def cover(self, colour: str) -> None:
        """Make the screen black or white, or show it again."""
        self.blank = "" if self.blank == colour else colour

    def escape(self) -> None:
        """Take away a blank screen, else the help, else a typed number; without these, leave."""
        if self.blank:
            self.blank = ""
        elif self.helps:
            self.helps = False
        elif self.typed:
            self.typed = ""
        else:
            self.end()

    def obey(self, wishes: Mapping[str, Any]) -> None:
        """Do what the page of notes asks for; raise ``ParameterError`` for what nobody knows."""
        if not self.on:
            raise ParameterError("the presentation is over")
        acts: dict[tuple[str, object], Callable[[], None]] = {
            ("go", "next"): self.next,
            ("go", "back"): self.back,
            ("go", "first"): partial(self.go, 0),
            ("go", "last"): partial(self.go, len(self.beats) - 1),
            ("cover", "black"): partial(self.cover, "black"),
            ("cover", "white"): partial(self.cover, "white"),
            ("clock", "pause"): self.clock.toggle,
            ("clock", "reset"): self.clock.reset,
        }
        for key in ("go", "cover", "clock"):
            wish = wishes.get(key)
            if key == "go" and type(wish) is int:
                return self.go(wish - 1)
            if isinstance(wish, str) and (key, wish) in acts:
                return acts[key, wish]()
        raise ParameterError('expected {"go": "next"}, {"cover": "black"} or {"clock": "pause"}')

    # ── numbers ──────────────────────────────────────────────────────────────

    def type(self, digit: str) -> None:
        """Take a digit: of a beat's number, and the slider that the arrows move."""
        if self.now() - self._typed_at > TYPED:
            self.typed = ""
        self.typed, self._typed_at = (self.typed + digit)[-4:], self.now()
        if len(self.typed) == 1 and digit != "0":
            slider_index = int(digit) - 1
            if slider_index < len(self.beat.sliders):
                self.slider = slider_index

    def enter(self) -> str:
        """Go to the beat whose number was typed; return why not, as a key of the labels, or ""."""
        number, self.typed = int(self.typed or 0), ""
        if not number:
            return ""
        if number > len(self.beats):
            return "no_beat"
        self.go(number - 1)
        return ""

    def forget_typed(self) -> None:
        """Forget digits that no Enter followed."""
        if self.typed and self.now() - self._typed_at > TYPED:
            self.typed = ""

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        return max(TYPED - (self.now() - self._typed_at), 0.05) if self.typed else 1.0

    # ── spot and pen ─────────────────────────────────────────────────────────

    def toggle_laser(self) -> None:
        """Show a spot at the mouse, or no longer."""
        self.laser, self.pen = not self.laser, False

    def toggle_help(self) -> None:
        """Show the keys, or no longer."""
        self.helps = not self.helps

    def toggle_pen(self) -> None:
        """Take the pen, or put it down."""
        self.pen, self.laser = not self.pen, False

    def press(self, position: Point) -> None:
        """Begin a stroke of this beat."""
        self.strokes.setdefault(self.at, []).append([position])

    def draw(self, position: Point) -> None:
        """Draw on to a place."""
        mine = self.strokes.get(self.at)
        if mine and mine[-1][-1] != position:
            mine[-1].append(position)

    def erase(self) -> None:
        """Erase all that was drawn on this beat."""
        self.strokes.pop(self.at, None)
