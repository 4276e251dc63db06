"""The panel of lessons: which lesson, which page, the page itself, and the way on."""

from __future__ import annotations

import re
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from imgui_bundle import ImVec2, imgui

from playground.course.glossary import linked_term
from playground.course.language import labels
from playground.course.library import LANGUAGES
from playground.course.model import (
    Block,
    Break,
    Challenge,
    Code,
    Compare,
    Exercise,
    Figure,
    Measure,
    Prose,
    Question,
    Slider,
    Steps,
)
from playground.course.typeset import plain, written
from playground.course.window.blocks import (
    draw_break,
    draw_challenge,
    draw_code_block,
    draw_compare,
    draw_exercise,
    draw_figure,
    draw_measure,
    draw_prose,
    draw_question,
    draw_slider,
    draw_steps,
)
from playground.course.window.formulas import Formulas
from playground.course.window.page import Page, SmallPictures
from playground.course.window.page import Prose as Texts
from playground.course.window.progress import MAX_WIDTH, MIN_WIDTH
from playground.course.window.reader import Reader
from playground.errors import PlaygroundError
from playground.sketch.find import find
from playground.studio import theme
from playground.studio.draw import SIDE_PANEL, button, inked, styled, window
from playground.studio.edits.history import History
from playground.studio.panel.memory import Memory
from playground.studio.panel.rows import fitting
from playground.studio.theme import Theme


def follow(reader: Reader, address: str) -> None:
    """Open what a link names."""
    kind, _, name = address.partition(":")
    if kind == "lesson":
        reader.open(name)
    elif kind == "sketch":
        open_sketch(reader, name)
    elif kind == "thesis":
        reader.bench.notices.say(reader.say("thesis_section", name))
    elif kind == "term":
        reader.bench.notices.say(link_text(reader, address))
    elif kind in ("https", "http") and not webbrowser.open(address):
        reader.bench.notices.say(address)


def link_text(reader: Reader, address: str) -> str:
    """Return what is shown of a link under the mouse: of a term its definition, else its address."""
    term = linked_term(address)
    language = reader.lesson.language if reader.lesson else reader.language
    return term.definition(language) if term else address


def play_on(reader: Reader) -> None:
    """Open the lesson's sketch as the reader's own."""
    if reader.lesson is not None:
        open_sketch(reader, reader.lesson.sketch)


def open_sketch(reader: Reader, name: str) -> None:
    """Open a sketch as the reader's own, with the user's edits of the last time."""
    bench, figure = reader.bench, reader.figure
    try:
        path = find(name)
    except PlaygroundError as error:
        bench.notices.say(str(error))
        return
    reader.playing = ""
    reader.bugs.close_all(drawn=False)
    figure.forget_figure()
    bench.interface.panel_shown = True
    opens: Callable[[Path], object] = reader.play or bench.commands.open
    opens(path)
    if bench.session.drafts.opening:  # else it is open already
        bench.undo.begin(History())


DRAWN: dict[type[Block], Any] = {
    Prose: draw_prose,
    Figure: draw_figure,
    Steps: draw_steps,
    Slider: draw_slider,
    Compare: draw_compare,
    Code: draw_code_block,
    Break: draw_break,
    Question: draw_question,
    Exercise: draw_exercise,
    Challenge: draw_challenge,
    Measure: draw_measure,
}
"""What draws each kind of block."""

_MIN_PICTURE_WIDTH = 200.0
"""Room that the picture has next to the panel, in units of scale 1."""


@dataclass
class LessonPanel:
    """The panel's own memory."""

    memory: Memory = field(default_factory=Memory)
    _formulas: Formulas | None = None
    _texts: Texts | None = None
    _pictures: SmallPictures | None = None

    def draw(self, reader: Reader, look: Theme, present: Callable[[], None]) -> float:
        """Draw the panel at the window's left side; return the width it takes, 0 while it is hidden.

        ``present`` begins a presentation of the lesson.
        """
        lesson = reader.lesson
        if lesson is None or not reader.progress.shown:
            return 0.0
        if self._texts is None:
            self._texts = Texts(
                lambda: self._formulas_of(reader),
                lambda to: follow(reader, to),
                lambda to: link_text(reader, to),
            )
        room, scale = imgui.get_main_viewport().size, look.scale
        widest = max(room.x - _MIN_PICTURE_WIDTH * scale, 160.0)
        imgui.set_next_window_pos(ImVec2(0, 0))
        target = min(reader.progress.width * scale, widest)
        imgui.set_next_window_size(ImVec2(target, room.y))
        imgui.set_next_window_size_constraints(
            ImVec2(min(MIN_WIDTH * scale, widest), room.y), ImVec2(min(MAX_WIDTH * scale, widest), room.y)
        )
        with window("lesson", SIDE_PANEL, ground=theme.colour((0.110, 0.119, 0.127))):
            page = Page(reader, lesson, look, self._texts, self.memory, self._pictures_of(reader), present)
            _head(page)
            scrolls = imgui.WindowFlags_.always_vertical_scrollbar
            imgui.begin_child("page", ImVec2(0, -_foot_height()), 0, scrolls)
            if reader.to_top:
                reader.to_top = False
                imgui.set_scroll_y(0.0)
            _page(page)
            imgui.end_child()
            _foot(page)
            width = imgui.get_window_size().x
        if abs(width - target) > 0.5:  # pulled; a narrow window alone makes it no narrower for good
            reader.progress.width = width / scale
        return float(width)

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""
        if self._formulas is not None:
            self._formulas.release()
        if self._pictures is not None:
            self._pictures.release()
        self._formulas = self._pictures = None

    def _pictures_of(self, reader: Reader) -> SmallPictures:
        ctx = reader.bench.session.engine.ctx
        if self._pictures is None or self._pictures.ctx is not ctx:
            self._pictures = SmallPictures(ctx)  # those before went with a context that was lost
        return self._pictures

    def _formulas_of(self, reader: Reader) -> Formulas:
        ctx = reader.bench.session.engine.ctx
        if self._formulas is None or self._formulas.ctx is not ctx:
            self._formulas = Formulas(ctx)  # those before went with a context that was lost
        return self._formulas


def _head(page: Page) -> None:
    """Draw which lesson this is, the way to others, the languages, and what closes the panel."""
    reader, lesson, look = page.reader, page.lesson, page.look
    style = imgui.get_style()
    codes = [code.upper() for code in LANGUAGES]
    buttons = sum(imgui.calc_text_size(code).x + 2 * style.frame_padding.x for code in codes)
    buttons += imgui.calc_text_size("×").x + 2 * style.frame_padding.x + 4 * len(codes) * look.scale
    imgui.set_next_item_width(imgui.get_content_region_avail().x - buttons - style.item_spacing.x)
    if imgui.begin_combo(
        "##lessons", page.say("lesson", lesson.number), imgui.ComboFlags_.height_largest.value
    ):
        for summary in reader.summaries:
            done = summary.name in reader.progress.done  # read to its end: in green
            label = f"{summary.number}  {written(summary.title)}##{summary.name}"
            with inked(theme.ACCENT if done else theme.INK):
                if imgui.selectable(label, summary.name == lesson.name)[0]:
                    reader.open(summary.name)
            minutes = page.say("minutes", summary.minutes, summary.exercise_minutes)
            imgui.set_item_tooltip(f"{plain(summary.goal)}\n{minutes}")
        imgui.end_combo()
    for code in LANGUAGES:
        imgui.same_line(0, 4 * look.scale)
        if page.button(f"{code.upper()}##{code}", LANGUAGES[code], on=code == reader.language):
            reader.set_language(code)
    imgui.same_line(0, 4 * look.scale)
    if page.button("×##close", page.say("close")):
        reader.toggle()
    with look.font(look.bold, theme.TEXT_SIZE + 5):
        imgui.text_wrapped(written(lesson.title))
    talk = labels("talk", reader.language)
    if page.button(talk["present"], talk["present_note"]):
        page.present()
    with look.font(look.text, theme.SMALL):
        minutes = page.say("minutes", lesson.minutes, lesson.exercise_minutes)
        imgui.text_disabled(f"{minutes}   {page.say('page', reader.index + 1, _count(page))}")
    _pages(page)


def _pages(page: Page) -> None:
    """Draw one bar for each page; a click on one goes there."""
    count, at, scale = _count(page), page.reader.index, page.look.scale
    gap, high = 3 * scale, 5 * scale
    wide = (imgui.get_content_region_avail().x - gap * (count - 1)) / count
    corner, draw = imgui.get_cursor_screen_pos(), imgui.get_window_draw_list()
    for index, section in enumerate(page.lesson.sections):
        low = ImVec2(corner.x + index * (wide + gap), corner.y)
        high_corner = ImVec2(low.x + wide, low.y + high)
        reach = ImVec2(high_corner.x + gap / 2, high_corner.y + 4 * scale)
        over = imgui.is_window_hovered() and imgui.is_mouse_hovering_rect(
            ImVec2(low.x - gap / 2, low.y - 4 * scale), reach
        )
        rgb = theme.ACCENT if index <= at else theme.RAISED
        alpha = 1.0 if index == at or over else 0.5
        draw.add_rect_filled(low, high_corner, theme.packed(rgb, alpha), high / 2)
        if over:
            imgui.set_tooltip(plain(section.title or page.lesson.title))
            if imgui.is_mouse_clicked(0):
                page.reader.go(index)
    imgui.dummy(ImVec2(1, high + 2 * scale))


def _page(page: Page) -> None:
    """Draw the open page."""
    reader, lesson = page.reader, page.lesson
    section = reader.section
    if section is None:
        return
    gap = ImVec2(1, 3 * page.look.scale)
    if reader.index == 0:
        page.text(lesson.goal, dim=True)
        imgui.dummy(gap)
    if section.title:
        page.text(f"## {section.title}")
        imgui.dummy(gap)
    for block in section.blocks:
        if isinstance(block, Prose) and block.kind == "heading" and block.level == 1:
            continue  # the title is above
        DRAWN[type(block)](block, page)
        imgui.dummy(gap)
    if reader.index == _count(page) - 1:
        _sources(page)


def _sources(page: Page) -> None:
    """Draw where the lesson comes from."""
    lesson = page.lesson
    thesis = [f"[{page.say('thesis', section)}](thesis:{section})" for section in lesson.thesis]
    if thesis or lesson.papers:
        imgui.separator()
        page.label(page.say("sources"))
        papers = [re.sub(r"(https?://\S+)", r"<\1>", paper) for paper in lesson.papers]
        lines = [*thesis, *papers]
        page.text("\n".join(f"- {line}" for line in lines), size=theme.SMALL, dim=True)


def _foot(page: Page) -> None:
    """Draw the way back and on, and out of the lesson."""
    reader, count = page.reader, _count(page)
    imgui.separator()
    half = (imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x) / 2
    if button(f"{page.say('previous')}##previous", "PgUp", enabled=reader.index > 0, wide=half):
        reader.turn_page(-1)
    imgui.same_line()
    last = reader.index == count - 1
    following = next((summary for summary in reader.summaries if summary.number > page.lesson.number), None)
    text = page.say("next_lesson") if last else page.say("next")
    note = "PgDn" if not last else following.title if following else ""
    with styled({imgui.Col_.button: theme.colour((0.29, 0.46, 0.32))}):
        if button(f"{text}##next", note, enabled=not last or following is not None, wide=half):
            if not last:
                reader.turn_page(1)
            elif following is not None:
                reader.open(following.name, page=0)
    if reader.figure.before_lesson is not None:
        own = reader.figure.before_lesson.path
        name = own.parent.name if own.name == "sketch.toml" else own.stem
        if button(fitting(page.say("back"), half) + "##back", page.say("back_note", name), wide=half):
            reader.go_back()
    else:
        imgui.dummy(ImVec2(half, imgui.get_frame_height()))
    imgui.same_line()
    note = page.say("play_on_note", page.lesson.sketch)
    if button(fitting(page.say("play_on"), half) + "##play on", note, wide=half):
        play_on(reader)


def _foot_height() -> float:
    spacing = imgui.get_style().item_spacing.y
    return 2 * imgui.get_frame_height() + 3 * spacing


def _count(page: Page) -> int:
    return len(page.lesson.sections)
