"""Blocks that are pictures: each draws its buttons and sliders, and the live view shows the picture."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from imgui_bundle import imgui

from playground.course.model import Compare, Figure, Scene, Slider, Steps
from playground.course.scenes import comparable
from playground.course.window.figure_state import path_of
from playground.course.window.page import Page
from playground.course.window.reader import BOTH
from playground.errors import ParameterError
from playground.live import theme
from playground.live.parameter_row import Rows
from playground.live.sliders import slide_whole
from playground.shader.parameter import write
from playground.sketch.assign import resolve

_ON, _OFF = theme.ACCENT, theme.LINE


def draw_figure(block: Figure, page: Page) -> None:
    """Draw a figure: its caption, and what may be dragged."""
    with page.frame(block.name, _bar(page, block)):
        _show(block, page)
        _parameters(block, block.sliders, page)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_steps(block: Steps, page: Page) -> None:
    """Draw the steps of a repeated kernel: a slider over them, and buttons to play them."""
    reader, last = page.reader, len(block.scenes) - 1
    at = min(reader.at.get(block.name, 0), last)
    with page.frame(block.name, _bar(page, block)):
        _player(block, page, at, last)
        imgui.set_next_item_width(-1)
        chosen = slide_whole(
            "##steps", at, (0, last), lambda n: page.say("step", block.iterations[n], block.iterations[-1])
        )
        if chosen is not None:
            reader.playing = ""
            reader.move(block, chosen)
        if block.captions:
            page.text(block.captions[at], size=theme.SMALL)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_slider(block: Slider, page: Page) -> None:
    """Draw one parameter that is swept: its own widget, and a button that plays."""
    reader, last = page.reader, len(block.scenes) - 1
    at = min(reader.at.get(block.name, 0), last)
    with page.frame(block.name, _bar(page, block)):
        _player(block, page, at, last)
        if reader.is_on(block):
            _parameters(block, (block.parameter,), page)
        else:
            imgui.set_next_item_width(-1)
            chosen = slide_whole("##values", at, (0, last), lambda n: _named(block, n))
            if chosen is not None:
                reader.move(block, chosen)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_compare(block: Compare, page: Page) -> None:
    """Draw a choice of variants; two of them can be shown at once, divided by a line."""
    reader = page.reader
    on = reader.at.get(block.name) if reader.is_on(block) else None
    with page.frame(block.name, _bar(page, block)):
        first = True
        if len(block.scenes) == 2 and comparable(*block.scenes):
            first = False
            note = f"A: {block.labels[0]}\nB: {block.labels[1]}"
            if page.button(page.say("both"), note, on=on == BOTH):
                reader.choose(block, BOTH)
        for index, label in enumerate(block.labels):
            if not first:
                page.same_line(label)
            first = False
            if page.button(f"{label}##{index}", block.alt, on=on == index):
                reader.choose(block, index)
        if on == BOTH:
            page.text(f"A: {block.labels[0]} | B: {block.labels[1]}", size=theme.SMALL)
        page.text(block.caption, size=theme.SMALL, dim=True)


def _show(block: Figure, page: Page) -> None:
    reader = page.reader
    on = reader.is_on(block)
    shows = page.say("show" if not on else "coming" if reader.figure.busy else "on_view")
    if page.button(shows, block.alt or page.say("show_note"), on=on) and not on:
        reader.show(block)
    if on:
        _reset(block, page)


def _reset(block: Figure | Slider, page: Page) -> None:
    """Draw a button that resets the figure, where the reader has changed it."""
    if page.reader.figure.changed:
        imgui.same_line()
        if page.button(page.say("reset"), page.say("reset_note")):
            page.reader.reset(block)


def _player(block: Steps | Slider, page: Page, at: int, last: int) -> None:
    """Draw buttons that go through a series."""
    reader, on = page.reader, page.reader.is_on(block)
    if not on:
        if page.button(page.say("show"), block.alt):
            reader.show(block)
        imgui.same_line()
    playing = reader.playing == block.name
    for label, by in (("<", -1), (page.say("pause" if playing else "play"), 0), (">", 1)):
        if by >= 0:
            imgui.same_line()
        if page.button(label, "" if by else block.alt, on=playing and not by, enabled=0 <= at + by <= last):
            if by:
                reader.playing = ""
                reader.move(block, at + by)
            else:
                reader.play_or_pause(block)
    if on and isinstance(block, Slider):
        _reset(block, page)


def _parameters(block: Figure | Slider, paths: tuple[str, ...], page: Page) -> None:
    scene = block.scene if isinstance(block, Figure) else block.scenes[0]
    if scene is not None and page.reader.is_on(block):
        draw_parameters(scene, paths, page)


def draw_parameters(scene: Scene, paths: tuple[str, ...], page: Page) -> None:
    """Draw parameters of the picture that is shown, as the panel draws them."""
    bench, memory = page.reader.bench, page.memory
    session, draft = bench.session, bench.session.shown
    if not paths or draft is None:
        return
    if session.path != path_of(scene) or page.reader.figure.busy:
        return
    items = {item.leaf: item for section in memory.listing.sections(draft) for item in section.items}
    values = memory.listing.values(draft)
    rows = Rows(session, bench.notices, memory, bench.interface.ahead, values, page.look)
    for path in paths:
        with suppress(ParameterError):
            item = items.get(resolve(draft.base.graph, path)[0].path)
            if item is not None:
                rows.draw(item, Path(draft.sketch.folder))
    if session.shown is not draft:
        page.reader.playing = ""
    if memory.menu:
        rows.draw_menu({item.label: item for item in items.values()})


def _named(block: Slider, at: int) -> str:
    """Return a value of a sweep, with the name of what it is of."""
    parameter = resolve(block.scenes[at].sketch.graph, block.parameter)[0].parameter
    return f"{block.label or parameter.title}: {write(parameter, block.values[at])}"


def _bar(page: Page, block: Figure | Steps | Slider | Compare) -> theme.Rgb:
    return _ON if page.reader.is_on(block) else _OFF
