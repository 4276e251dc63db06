"""Blocks of text: questions, exercises, numbers, prose."""

from __future__ import annotations

from imgui_bundle import imgui

from playground.course.measuring import named_in
from playground.course.model import Exercise, Measure, Prose, Question
from playground.course.tasks.work import checks_itself
from playground.course.window.markdown_runs import plain
from playground.course.window.page import Page
from playground.course.window.task_blocks import draw_work, task_label
from playground.live import theme
from playground.live.draw import pushed_id, styled


def draw_prose(block: Prose, page: Page) -> None:
    """Draw a paragraph, a list, a table, a formula."""
    words = f"{'#' * block.level} {block.markdown}" if block.kind == "heading" else block.markdown
    page.text(words)


def draw_question(block: Question, page: Page) -> None:
    """Draw a question; its answer waits behind a button."""
    reader = page.reader
    with page.frame(block.name, theme.WARM):
        page.label(page.say("question"), theme.WARM)
        page.text(block.ask)
        chosen = reader.chosen.get(block.name, -1)
        for index, choice in enumerate(block.choices):
            _choice(block, index, choice, chosen, page)
        right = bool(block.choices) and chosen == block.right
        if chosen >= 0:
            page.text(page.say("right" if right else "wrong"))
        if right:
            page.text(block.answer)
        else:
            page.behind(block.name, "answer", block.answer)


def draw_exercise(block: Exercise, page: Page) -> None:
    """Draw an exercise; hint and solution wait behind buttons."""
    reader = page.reader
    with page.frame(block.name, theme.WARM):
        page.label(task_label(block, page), theme.WARM)
        page.text(block.ask)
        if checks_itself(block):
            draw_work(block, page)
        if block.hint:
            page.behind(block.name, "hint", block.hint)
            page.same_line(page.say("solution"))
        page.behind(block.name, "solution", block.solution)
        if (block.name, "solution") in reader.shown and block.scene is not None:
            if page.button(page.say("solution_picture"), block.alt, on=reader.figure.key == (block.name, 0)):
                reader.show(block)


def draw_measure(block: Measure, page: Page) -> None:
    """Draw a number that is computed here and now, in its sentence where it has one."""
    reader = page.reader
    failed = reader.numbers.failed.get((page.lesson.name, block.name))
    if not block.sentence and failed is None:
        return  # it is in the prose
    with page.frame(block.name, theme.LINE):
        waits = any(reader.numbers.waits(page.lesson, name) for name in named_in(block.sentence))
        page.label(page.say("measuring") if waits else page.say("measured"))
        if failed is not None:
            page.text(page.say("unmeasured", failed), size=theme.SMALL, dim=True)
        page.text(block.sentence)


def _choice(block: Question, index: int, choice: str, chosen: int, page: Page) -> None:
    """Draw one of several answers, as wide as the page."""
    on = chosen == index
    ink = theme.ACCENT if index == block.right else theme.ALARM
    with pushed_id(index):
        with styled({imgui.Col_.text: theme.colour(ink)} if on else {}):
            marked = imgui.radio_button("##choice", on)
        imgui.same_line()
        imgui.begin_group()
        imgui.set_cursor_pos_y(imgui.get_cursor_pos_y() + imgui.get_style().frame_padding.y / 2)
        page.text(choice)
        imgui.end_group()
        if marked or imgui.is_item_clicked(0):
            page.reader.chosen[block.name] = index
    if imgui.is_item_hovered():
        imgui.set_tooltip(plain(choice))
