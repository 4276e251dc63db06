"""A presentation in the window: its keys and mouse, what is written over the picture, the teacher's notes.

What typesets slides is imported with the first of them: most windows show none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.course.language import labels
from playground.course.talk.beat import Beat, texts_of_beat, with_texts
from playground.course.talk.notes import NotesLink
from playground.course.talk.presented_pictures import PresentedPictures, Row
from playground.course.talk.presenter import Point, Presenter
from playground.course.window.reader import Reader
from playground.errors import PlaygroundError
from playground.studio.bench import Workbench
from playground.studio.draw import Area
from playground.studio.input.text_field import letters

if TYPE_CHECKING:
    import moderngl
    from PIL.Image import Image

    from playground.course.talk.slide import Sizes


@dataclass
class Overlays:
    """The images of one context, by name."""

    _known: dict[str, tuple[object, moderngl.Texture | None]] = field(default_factory=dict)

    def knows(self, name: str, key: object) -> bool:
        """Return whether the image of that name is the one for a key."""
        return name in self._known and self._known[name][0] == key

    def put(self, name: str, key: object, image: Image | None, ctx: moderngl.Context) -> None:
        """Take an image for a key, in place of the one before; None: nothing is shown."""
        before = self._known.get(name, (None, None))[1]
        if before is not None:
            before.release()
        texture = None
        if image is not None:
            texture = ctx.texture(image.size, 4, image.tobytes(), alignment=1)
            texture.filter = (ctx.LINEAR, ctx.LINEAR)
        self._known[name] = key, texture

    def draw(self, name: str, position: tuple[float, float], density: float) -> None:
        """Draw an image with its upper left corner at a place, in the window's units."""
        texture = self._known.get(name, (None, None))[1]
        if texture is not None:
            low = ImVec2(*position)
            high = ImVec2(low.x + texture.size[0] / density, low.y + texture.size[1] / density)
            imgui.get_background_draw_list().add_image(imgui.ImTextureRef(texture.glo), low, high)

    def release(self) -> None:
        """Release all; they are made again where they are needed."""
        cached, self._known = self._known, {}
        for _, texture in cached.values():
            if texture is not None:
                texture.release()


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
        self.notes = NotesLink(self.presenter, self._filled, wake)
        self._overlays = Overlays()
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
            self._note(self._say("no_beat", options.beat, len(self.presenter.beats)))
        if options.notes and (why := self.notes.open()):
            self._note(self._say("no_notes", why))
        if self.notes.url:
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
        self.notes.tell(self.reader.language)

    def release(self) -> None:
        """Release what was made in the session's context."""
        self._overlays.release()

    def close(self) -> None:
        """Close the page of notes."""
        self.notes.close()

    # ── frames ───────────────────────────────────────────────────────────────

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        if self.notes.waits or self._due is not None:
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
        self._write(sizes, rows)
        line = self._line(area)
        if line is not None:
            top, bottom = ImVec2(line, area[1]), ImVec2(line, area[1] + area[3])
            draw.add_line(top, bottom, 0xE0FFFFFF, 3 * sizes.scale / density)
        margin = 24 * sizes.scale / density
        self._overlays.draw("board", (area[0], area[1]), density)
        self._pen.draw(presenter, area, sizes.scale / density)
        offers = presenter.beat.kind in ("figure", "sweep") or presenter.slider >= 0
        if offers and not presenter.beat.has_board:
            self._overlays.draw("gauges", (area[0] + margin, area[1] + margin), density)
        self._overlays.draw("strip", (area[0], area[1] + area[3]), density)
        if presenter.helps:
            self._overlays.draw("help", (area[0], area[1]), density)
        self._overlays.draw("typed", (area[0] + margin, area[1] + area[3] / 2), density)
        if presenter.laser and not presenter.blank:
            self._pen.draw_spot(sizes.scale / density)
        if presenter.blank:
            room = imgui.get_main_viewport().size
            colour = 0xFF000000 if presenter.blank == "black" else 0xFFFFFFFF
            imgui.get_foreground_draw_list().add_rect_filled(ImVec2(0, 0), ImVec2(room.x, room.y), colour)
        self.notes.tell(self.reader.language)

    def _write(self, sizes: Sizes, rows: list[Row]) -> None:
        """Have images of what is written, where another is due."""
        from playground.course.talk.slide import Gauge, board_of, gauges_of, help_of, plate_of, strip_of

        presenter, ctx, overlays = self.presenter, self.bench.session.engine.ctx, self._overlays
        beat = self._filled(presenter.beat)
        position = presenter.at + 1, len(presenter.beats)
        if not overlays.knows("strip", (ctx, beat, position, sizes)):
            overlays.put("strip", (ctx, beat, position, sizes), strip_of(beat, position, sizes), ctx)
            overlays.put("board", None, board_of(beat, sizes), ctx)
        gauges = tuple(
            Gauge(n + 1, row.title, row.text, row.share, n == presenter.slider) for n, row in enumerate(rows)
        )
        if not overlays.knows("gauges", (ctx, gauges, sizes)):
            overlays.put("gauges", (ctx, gauges, sizes), gauges_of(gauges, sizes), ctx)
        if presenter.helps and not overlays.knows("help", (ctx, sizes)):
            rows_of_help = help_rows(self.reader.language)
            overlays.put("help", (ctx, sizes), help_of(rows_of_help, sizes), ctx)
        prepares = self._say("prepares") if presenter.at == 0 and self.reader.numbers.pending else ""
        says = f"→ {presenter.typed}" if presenter.typed else presenter.notice or prepares
        if not overlays.knows("typed", (ctx, says, sizes)):
            overlays.put("typed", (ctx, says, sizes), plate_of(says, sizes), ctx)

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

    def quit(self) -> None:
        """Quit the program."""
        self.bench.window.quit()

    def enter(self) -> None:
        """Go to the beat whose number was typed."""
        number = self.presenter.typed
        if why := self.presenter.enter():
            self._note(self._say(why, number, len(self.presenter.beats)))

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
        self._note(self._say("laser_on") if self.presenter.laser else "")

    def toggle_pen(self) -> None:
        """Take the pen, or put it down."""
        self.presenter.toggle_pen()
        self._note(self._say("pen_on") if self.presenter.pen else "")

    def toggle_full(self) -> None:
        """Fill the screen, or no longer."""
        self.bench.window.toggle_full()

    def toggle_help(self) -> None:
        """Show the keys, or no longer."""
        self.presenter.helps = not self.presenter.helps

    def say_address(self) -> None:
        """Show where the notes are."""
        self._note(self._say("notes_at", self.notes.url or "–"))

    def _note(self, sentence: str) -> None:
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
    PresentKey("notes", (_K.n,), lambda stage: stage.say_address()),
    PresentKey("full", (_K.f, _K.f11), lambda stage: stage.toggle_full()),
    PresentKey("help", (_K.h,), lambda stage: stage.toggle_help(), typed="?"),
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
        stage.quit()
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
