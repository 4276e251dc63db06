"""A presentation in the window: its pictures, keys and mouse, what is written over the picture, the notes.

What typesets slides is imported with the first of them: most windows show none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from imgui_bundle import ImVec2, imgui

from playground.course.library import labels
from playground.course.model import Break, Compare, Exercise, Slider, Steps
from playground.course.scenes import with_bug
from playground.course.talk.beats import Beat, Still, texts_of_beat, with_texts
from playground.course.talk.notes import Notes, notes_message
from playground.course.talk.presenter import Point, Presenter, Row
from playground.course.tasks import path_of, starter_text
from playground.course.window.bugs import file_of
from playground.course.window.reader import Reader
from playground.course.window.tasks import BEGUN
from playground.errors import DataError, ParameterError, PlaygroundError
from playground.shader.parameter import is_whole
from playground.sketch.assign import range_of, resolve
from playground.sketch.model import Parameter, Value
from playground.studio.bench import Workbench
from playground.studio.draw import Area, letters
from playground.studio.panel.parameter_list import items_of, shown_values
from playground.studio.panel.values import with_fraction

if TYPE_CHECKING:
    import moderngl
    from PIL.Image import Image

    from playground.course.talk.slide import Sizes
    from playground.course.window.page import Pixels, Textures

_PARTS = 40
"""Presses of an arrow from one end of a slider to the other."""


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


_INK = 0xFF3CC8FF  # a warm yellow, as imgui packs it
_EDGE = 0xB0101010
_SPOT = 0xFF2020FF


@dataclass
class Pen:
    """The pen of one window."""

    down: bool = False  # it draws

    def act(self, presenter: Presenter, area: Area) -> None:
        """Draw while the left button is down."""
        if not imgui.is_mouse_down(0):
            self.down = False
            return
        position = _place(area)
        if imgui.is_mouse_clicked(0):
            self.down = all(0.0 <= side <= 1.0 for side in position)
            if self.down:
                presenter.press(position)
        elif self.down:
            presenter.draw(position)

    def draw(self, presenter: Presenter, area: Area, scale: float) -> None:
        """Draw the strokes of the beat, which are as large as the picture in ``area`` makes them."""
        paint = imgui.get_background_draw_list()
        for stroke in presenter.strokes.get(presenter.at, []):
            points: list[ImVec2 | tuple[int | float, int | float] | list[int | float]] = [
                ImVec2(area[0] + x * area[2], area[1] + y * area[3]) for x, y in stroke
            ]
            if len(points) == 1:
                paint.add_circle_filled(points[0], 6 * scale, _EDGE)
                paint.add_circle_filled(points[0], 4.5 * scale, _INK)
                continue
            paint.add_polyline(points, _EDGE, 9 * scale, 0)
            paint.add_polyline(points, _INK, 6 * scale, 0)

    def draw_spot(self, scale: float) -> None:
        """Draw the spot at the mouse."""
        position, paint = imgui.get_mouse_pos(), imgui.get_foreground_draw_list()
        for radius, alpha in ((30.0, 0x30), (20.0, 0x60), (12.0, 0xFF)):
            paint.add_circle_filled(position, radius * scale, (_SPOT & 0x00FFFFFF) | alpha << 24)
        paint.add_circle_filled(position, 5 * scale, 0xFFE0E0FF)


def _place(area: Area) -> Point:
    mouse = imgui.get_mouse_pos()
    return (mouse.x - area[0]) / area[2], (mouse.y - area[1]) / area[3]


_CLICK = 5.0  # units that the mouse may move while it is pressed, and it is a click all the same
_HIDES = 2.5  # [s] without a move after which the mouse is hidden


@dataclass(frozen=True)
class Presenting:
    """How a presentation is to begin: at which beat, from 1 (0: at the open page), and with notes or not."""

    beat: int = 0
    notes: bool = True
    say: Callable[[str], None] = lambda text: None  # to the terminal: where the notes are


class Stage:
    """The presentation of one window; ``wake`` ends the window's sleep, from any thread."""

    name = "the presentation"

    def __init__(self, bench: Workbench, reader: Reader, wake: Callable[[], None]) -> None:
        self.bench, self.reader = bench, reader
        self.pictures = PresentedPictures(reader)
        self.presenter: Presenter = Presenter(self._show, self._left, bench.notices.now)
        self.notes: Notes | None = None
        self._wake = wake
        self._told: object = None  # what the page of notes was told last
        self._textures: Textures | None = None
        self._pen = Pen()
        self._was_full = False
        self._moved = 0.0  # when the mouse moved last [s]
        self._turned = False  # to another beat, in this frame
        self._due: Beat | None = None  # whose words are on the screen, and whose picture is not shown yet

    # ── beginning and end ────────────────────────────────────────────────────

    @property
    def on(self) -> bool:
        """Whether a lesson is presented."""
        return self.presenter.on

    @property
    def beat_number(self) -> int:
        """The number of the beat that is presented, from 1; 0 while none is."""
        return self.presenter.at + 1 if self.on else 0

    def begin(self, options: Presenting = Presenting()) -> None:
        """Present the lesson that is open, or the one read last; fills the screen."""
        reader, notices = self.reader, self.bench.notices
        if reader.lesson is None and not reader.open(show=False):
            return
        lesson = reader.lesson
        if lesson is None:
            return
        reader.progress.shown = True
        reader.tasks.leave()
        reader.bugs.close_all()
        self.pictures.shown = None
        reader.numbers.want(lesson, lesson.blocks)
        try:
            self.presenter.begin(lesson, beat=options.beat - 1 if options.beat else None, page=reader.index)
        except PlaygroundError as error:
            notices.say(str(error))
            return
        if options.beat > len(self.presenter.beats):
            self.note("no_beat", options.beat, len(self.presenter.beats))
        try:
            self.notes = self.notes or (Notes(self.presenter.obey, self._wake) if options.notes else None)
        except DataError as error:
            self.note("no_notes", error)
        if self.notes is not None:
            options.say(self._say("notes_at", self.notes.url))
        self._was_full = self.bench.window.is_full()
        if not self._was_full:
            self.bench.window.toggle_full()

    def _left(self, beat: Beat) -> None:
        """Go back to the window: the lesson's panel, at the page of the last beat."""
        if self.bench.window.is_full() and not self._was_full:
            self.bench.window.toggle_full()
        self.reader.playing, self._due = "", None
        self.reader.go(beat.page, show=False)
        if self.reader.figure.scene is not None and beat.kind in ("broken", "hint"):
            self.reader.figure.set_texts({})
        self._tell()

    def release(self) -> None:
        """Release what was made in the session's context."""
        if self._textures is not None:
            self._textures.release()

    def close(self) -> None:
        """Close the page of notes."""
        if self.notes is not None:
            self.notes.close()
            self.notes = None

    def _tell(self) -> None:
        """Tell the page of notes what is on, where that is new."""
        presenter = self.presenter
        if self.notes is None or presenter.lesson is None or not presenter.beats:
            return
        clock, beat = presenter.clock, self._filled(presenter.beat)
        coming = self._filled(presenter.following) if presenter.following is not None else None
        key = presenter.on, presenter.at, beat, presenter.blank, clock.running, clock.started_at
        if key != self._told:
            self._told = key
            self.notes.tell(notes_message(presenter, beat, coming, self.reader.language))

    # ── frames ───────────────────────────────────────────────────────────────

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        if (self.notes is not None and self.notes.waits) or self._due is not None:
            return 0.0
        if not self.on:
            return 1.0
        return 0.1 if self.bench.notices.now() - self._moved < _HIDES else self.presenter.patience

    def turned(self) -> bool:
        """Return whether another beat is on since the last call."""
        turned, self._turned = self._turned, False
        return turned

    def take(self) -> None:
        """Do what the page of notes asked for."""
        if self.notes is not None:
            self.notes.take()

    def area(self, pixels: tuple[int, int]) -> tuple[int, int, int, int]:
        """Return where the picture is: x, y from below, width, height [pixels]."""
        from playground.course.talk.slide import Sizes

        sizes = Sizes(*pixels)
        return 0, sizes.height - sizes.picture[1], *sizes.picture

    def act(self, area: Area) -> bool:
        """Act on keys and mouse; return whether the mouse is for the picture, which is in ``area``."""
        presenter, io = self.presenter, imgui.get_io()
        self._show_due()
        self._follow_mouse()
        act_on_presentation_keys(self)
        presenter.forget_typed()
        if not presenter.on or presenter.blank:
            return False
        if self._slide_by_wheel(io.mouse_wheel):
            return False
        if presenter.pen:
            self._pen.act(presenter, area)
            return False
        held = self.bench.inspection.compare.held
        if imgui.is_mouse_released(0) and io.mouse_drag_max_distance_sqr[0] < _CLICK**2 and not held:
            presenter.next()
            return False
        return not presenter.laser and not presenter.beat.has_board

    def draw(self, pixels: tuple[int, int], density: float, area: Area) -> None:
        """Draw what is over the picture, which is in ``area``, and the strip below it."""
        from playground.course.talk.slide import Sizes

        presenter, sizes = self.presenter, Sizes(*pixels)
        if not presenter.on:
            return
        draw = imgui.get_background_draw_list()
        rows = self.pictures.sliders(presenter.beat)
        images = self._images(sizes, rows)

        def put(name: str, x: float, y: float) -> None:
            if (texture := images[name]) is not None:
                high = ImVec2(x + texture.size[0] / density, y + texture.size[1] / density)
                draw.add_image(imgui.ImTextureRef(texture.glo), ImVec2(x, y), high)

        line = self._line(area)
        if line is not None:
            top, bottom = ImVec2(line, area[1]), ImVec2(line, area[1] + area[3])
            draw.add_line(top, bottom, 0xE0FFFFFF, 3 * sizes.scale / density)
        margin = 24 * sizes.scale / density
        put("board", area[0], area[1])
        self._pen.draw(presenter, area, sizes.scale / density)
        offers = presenter.beat.kind in ("figure", "sweep") or presenter.slider >= 0
        if offers and not presenter.beat.has_board:
            put("gauges", area[0] + margin, area[1] + margin)
        put("strip", area[0], area[1] + area[3])
        put("help", area[0], area[1])
        put("typed", area[0] + margin, area[1] + area[3] / 2)
        if presenter.laser and not presenter.blank:
            self._pen.draw_spot(sizes.scale / density)
        if presenter.blank:
            room = imgui.get_main_viewport().size
            colour = 0xFF000000 if presenter.blank == "black" else 0xFFFFFFFF
            imgui.get_foreground_draw_list().add_rect_filled(ImVec2(0, 0), ImVec2(room.x, room.y), colour)
        self._tell()

    def _images(self, sizes: Sizes, rows: list[Row]) -> dict[str, moderngl.Texture | None]:
        """Return the images of what is written, by name; made where another is due."""
        from playground.course.talk.slide import board_of, gauges_of, help_of, plate_of, strip_of
        from playground.course.window.page import Textures

        presenter, ctx = self.presenter, self.bench.session.engine.ctx
        if self._textures is None or self._textures.ctx is not ctx:
            self._textures = Textures(ctx)
        beat = self._filled(presenter.beat)
        position = presenter.at + 1, len(presenter.beats)
        keys = help_rows(self.reader.language)
        prepares = self._say("prepares") if presenter.at == 0 and self.reader.numbers.pending else ""
        says = f"→ {presenter.typed}" if presenter.typed else presenter.notice or prepares
        images: dict[str, tuple[object, Callable[[], Image | None]]] = {
            "strip": ((beat, position), lambda: strip_of(beat, position, sizes)),
            "board": (beat, lambda: board_of(beat, sizes)),
            "gauges": ((rows, presenter.slider), lambda: gauges_of(rows, presenter.slider, sizes)),
            "help": (presenter.helps, lambda: help_of(keys, sizes) if presenter.helps else None),
            "typed": (says, lambda: plate_of(says, sizes)),
        }
        return {
            name: self._textures.get(name, partial(_pixels, make), (key, sizes))
            for name, (key, make) in images.items()
        }

    def _filled(self, beat: Beat) -> Beat:
        """Return a beat with the numbers that are measured by now in its texts."""
        lesson = self.presenter.lesson
        if lesson is None or not any("{{" in text for text in texts_of_beat(beat)):
            return beat
        return with_texts(beat, lambda text: self.reader.numbers.fill(text, lesson))

    def _line(self, area: Area) -> float | None:
        """Return where the line between two pictures is, from the left; None where there is none."""
        compare = self.bench.inspection.compare
        shown = compare.on and compare.picture is not None and len(self.presenter.beat.names) == 2
        return area[0] + compare.split * area[2] if shown else None

    def _follow_mouse(self) -> None:
        """Hide the mouse while it rests, and under the spot."""
        io, now = imgui.get_io(), self.bench.notices.now()
        if io.mouse_delta.x or io.mouse_delta.y:
            self._moved = now
        if now - self._moved >= _HIDES or self.presenter.laser:
            imgui.set_mouse_cursor(imgui.MouseCursor_.none)

    # ── what keys do ─────────────────────────────────────────────────────────

    def enter(self) -> None:
        """Go to the beat whose number was typed."""
        number = self.presenter.typed
        if why := self.presenter.enter():
            self.note(why, number, len(self.presenter.beats))

    def type(self, digit: str) -> None:
        """Take a digit, of a beat's number or of a slider."""
        self.presenter.notice = ""
        self.presenter.type(digit)

    def slide(self, by: float) -> None:
        """Move the slider that was chosen, or the first."""
        rows = self.pictures.sliders(self.presenter.beat)
        if rows and not self.presenter.blank:
            self.presenter.slider = min(max(self.presenter.slider, 0), len(rows) - 1)
            self.presenter.typed = ""
            self.pictures.slide(rows[self.presenter.slider], by)

    def _slide_by_wheel(self, turns: float) -> bool:
        """Move the chosen slider by the wheel; return whether it is the slider's."""
        if self.presenter.slider < 0 or not turns:
            return False
        self.slide(turns)
        return True

    def toggle_laser(self) -> None:
        """Show a spot at the mouse, or no longer."""
        self.presenter.toggle_laser()
        self.note("laser_on" if self.presenter.laser else "")

    def toggle_pen(self) -> None:
        """Take the pen, or put it down."""
        self.presenter.toggle_pen()
        self.note("pen_on" if self.presenter.pen else "")

    def note(self, key: str, *values: object) -> None:
        """Show a label as a notice, or no longer where it is shown already."""
        sentence = self._say(key, *values) if key else ""
        self.presenter.notice = "" if sentence == self.presenter.notice else sentence

    def _show(self, beat: Beat) -> None:
        """Show a beat's words in this frame; its sketch is loaded in the next one."""
        self._due, self._turned = beat, True

    def _show_due(self) -> None:
        """Show the picture of the beat whose words have been drawn."""
        if self._due is not None and not self._turned:
            beat, self._due = self._due, None
            self.pictures.show(beat)

    def _say(self, key: str, *arguments: object) -> str:
        return labels("talk", self.reader.language)(key, *arguments)


def _pixels(make: Callable[[], Image | None]) -> Pixels | None:
    image = make()
    return None if image is None else np.asarray(image)


_K = imgui.Key


@dataclass(frozen=True)
class PresentKey:
    """Keys that do one thing; ``label``: of their name and meaning, "" where the help has neither."""

    label: str
    keys: tuple[imgui.Key, ...]
    act: Callable[[Stage], None]
    typed: str = ""  # letters that do it too, wherever the keyboard has them
    repeats: bool = False


KEYS: tuple[PresentKey, ...] = (
    PresentKey("next", (_K.right_arrow, _K.space, _K.page_down), lambda stage: stage.presenter.next()),
    PresentKey("back", (_K.left_arrow, _K.page_up, _K.backspace), lambda stage: stage.presenter.back()),
    PresentKey("first", (_K.home,), lambda stage: stage.presenter.go(0)),
    PresentKey("last", (_K.end,), lambda stage: stage.presenter.go(len(stage.presenter.beats))),
    PresentKey("enter", (_K.enter, _K.keypad_enter), lambda stage: stage.enter()),
    PresentKey("black", (_K.b, _K.period), lambda stage: stage.presenter.cover("black"), typed="."),
    PresentKey("white", (_K.w,), lambda stage: stage.presenter.cover("white")),
    PresentKey("slide", (_K.up_arrow,), lambda stage: stage.slide(1.0), repeats=True),
    PresentKey("", (_K.down_arrow,), lambda stage: stage.slide(-1.0), repeats=True),
    PresentKey("laser", (_K.p,), lambda stage: stage.toggle_laser()),
    PresentKey("pen", (_K.d,), lambda stage: stage.toggle_pen()),
    PresentKey("erase", (_K.e,), lambda stage: stage.presenter.erase()),
    PresentKey(
        "notes", (_K.n,), lambda stage: stage.note("notes_at", stage.notes.url if stage.notes else "–")
    ),
    PresentKey("full", (_K.f, _K.f11), lambda stage: stage.bench.window.toggle_full()),
    PresentKey("help", (_K.h,), lambda stage: stage.presenter.toggle_help(), typed="?"),
    PresentKey("leave", (_K.escape,), lambda stage: stage.presenter.escape()),
)


def help_rows(language: str) -> tuple[tuple[str, str], ...]:
    """Return the keys and their meanings, in a language."""
    say = labels("talk_keys", language)
    return tuple((say[f"{key.label}_key"], say[key.label]) for key in KEYS if key.label)


def act_on_presentation_keys(stage: Stage) -> None:
    """Act on the keys pressed since the last frame."""
    io = imgui.get_io()
    if (io.key_ctrl or io.key_super) and imgui.is_key_pressed(_K.q, repeat=False):
        stage.bench.window.quit()
        return
    if io.key_ctrl or io.key_alt or io.key_super:
        return
    typed = letters()
    for digit in filter(str.isdecimal, typed):
        stage.type(digit)
    for key in KEYS:
        pressed = any(imgui.is_key_pressed(key_code, repeat=key.repeats) for key_code in key.keys)
        if pressed or (key.typed and key.typed in typed):
            key.act(stage)
            if not stage.presenter.on:
                return
