"""Blocks of code: an excerpt of the real shader, and a fault to be found in it."""

from __future__ import annotations

from imgui_bundle import imgui

from playground.errors import PlaygroundError
from playground.lessons.model import Break, Code
from playground.live import theme
from playground.live.lesson.page import Page
from playground.workbench.lesson.bugs import BROKEN, MENDED, TOLD


def draw_code_block(block: Code, page: Page) -> None:
    """Draw an excerpt of a shader as it is now, with a way to edit a copy of it."""
    faults = page.reading.faults
    edited = faults.is_edited(block)
    with page.frame(block.name, theme.WARM if edited else theme.LINE):
        try:
            found = faults.excerpt(block)
        except PlaygroundError as error:
            page.text(str(error), dim=True)
        else:
            with page.look.font(page.look.text, theme.SMALL):
                imgui.text_disabled(f"glsl/{block.file}:{found.line}")
            fence = "```"
            page.prose.draw(f"{fence}\n{found.text}\n{fence}", page.look, size=theme.SMALL + 1)
        if page.button(page.say("edit"), page.say("edit_note")):
            faults.edit(block)
        if edited:
            page.beside(page.say("put_back"))
            if page.button(page.say("put_back"), f"glsl/{block.file}"):
                faults.put_back(block)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_break(block: Break, page: Page) -> None:
    """Draw a fault: it is put into the picture, looked for, and mended."""
    faults = page.reading.faults
    state = faults.state.get(block.name, "")
    rgb = theme.ALARM if state == BROKEN else theme.ACCENT if state in (MENDED, TOLD) else theme.WARM
    with page.frame(block.name, rgb):
        page.label(page.say("fault"), rgb)
        page.text(block.ask)
        if page.button(page.say("break"), block.alt, on=state == BROKEN):
            (faults.focus if state == BROKEN else faults.break_it)(block)
        if state == BROKEN:
            imgui.same_line()
            if page.button(page.say("mend"), f"glsl/{block.file}"):
                faults.mend_it(block)
        _hint(block, page)
        if state == BROKEN:
            page.text(page.say("broken"), size=theme.SMALL)
        elif state == MENDED:
            with page.look.font(page.look.bold):
                imgui.text_wrapped(page.say("mended"))
        if state in (MENDED, TOLD):
            page.text(block.fix)
        page.text(block.caption, size=theme.SMALL, dim=True)


def _hint(block: Break, page: Page) -> None:
    known, key = page.reading.shown, (block.name, "hint")
    if key in known:
        page.text(block.hint)
        return
    page.beside(page.say("hint"))
    if page.button(page.say("hint")):
        known.add(key)
