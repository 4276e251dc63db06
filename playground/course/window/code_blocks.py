"""Blocks of code: an excerpt of the real shader, and a bug to be found in it."""

from __future__ import annotations

from imgui_bundle import imgui

from playground.course.model import Break, Code
from playground.course.window.bugs import BROKEN, FIXED, SHOWN
from playground.course.window.page import Page
from playground.errors import PlaygroundError
from playground.live import theme


def draw_code_block(block: Code, page: Page) -> None:
    """Draw an excerpt of a shader as it is now, with a way to edit a copy of it."""
    bugs = page.reader.bugs
    edited = bugs.is_edited(block)
    with page.frame(block.name, theme.WARM if edited else theme.LINE):
        try:
            excerpt_found = bugs.excerpt(block)
        except PlaygroundError as error:
            page.text(str(error), dim=True)
        else:
            with page.look.font(page.look.text, theme.SMALL):
                imgui.text_disabled(f"glsl/{block.file}:{excerpt_found.line}")
            fence = "```"
            page.prose.draw(f"{fence}\n{excerpt_found.text}\n{fence}", page.look, size=theme.SMALL + 1)
        if page.button(page.say("edit"), page.say("edit_note")):
            bugs.edit(block)
        if edited:
            page.same_line(page.say("put_back"))
            if page.button(page.say("put_back"), f"glsl/{block.file}"):
                bugs.put_back(block)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_break(block: Break, page: Page) -> None:
    """Draw a bug: it is put into the picture, searched for, and fixed."""
    bugs = page.reader.bugs
    state = bugs.state.get(block.name, "")
    rgb = theme.ALARM if state == BROKEN else theme.ACCENT if state in (FIXED, SHOWN) else theme.WARM
    with page.frame(block.name, rgb):
        page.label(page.say("bug"), rgb)
        page.text(block.ask)
        if page.button(page.say("break"), block.alt, on=state == BROKEN):
            (bugs.focus if state == BROKEN else bugs.break_it)(block)
        if state == BROKEN:
            imgui.same_line()
            if page.button(page.say("fix"), f"glsl/{block.file}"):
                bugs.fix_it(block)
        _hint(block, page)
        if state == BROKEN:
            page.text(page.say("broken"), size=theme.SMALL)
        elif state == FIXED:
            with page.look.font(page.look.bold):
                imgui.text_wrapped(page.say("fixed"))
        if state in (FIXED, SHOWN):
            page.text(block.fix)
        page.text(block.caption, size=theme.SMALL, dim=True)


def _hint(block: Break, page: Page) -> None:
    opened, key = page.reader.shown, (block.name, "hint")
    if key in opened:
        page.text(block.hint)
        return
    page.same_line(page.say("hint"))
    if page.button(page.say("hint")):
        opened.add(key)
