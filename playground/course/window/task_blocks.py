"""Exercises that check themselves, and pictures to match: their buttons, their verdict, their score."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from imgui_bundle import ImVec2, imgui

from playground.course.model import Challenge, Exercise
from playground.course.tasks.sentences import points_of, sentence_of
from playground.course.tasks.verdict import CheckResult, Picture, Verdict, difference_map
from playground.course.tasks.work import checks_itself, path_of
from playground.course.window.figure_blocks import draw_parameters
from playground.course.window.markdown_runs import written
from playground.course.window.page import Page
from playground.course.window.tasks import Task
from playground.live import theme
from playground.live.code_window import save
from playground.memo import INTERFACE

_WIDE = 160.0  # of the picture to match, in units of scale 1


def draw_work(block: Exercise, page: Page) -> None:
    """Draw what an exercise is done with: begin, check, the verdict."""
    tasks = page.reader.tasks
    _buttons(block, page)
    if tasks.is_begun(block):
        _sliders(block, page)
    verdict = tasks.judging.verdicts.get(block.name)
    if verdict is not None and tasks.judging.at != block.name:
        _verdict(block, verdict, page)


def draw_challenge(block: Challenge, page: Page) -> None:
    """Draw a picture to match, and how near the picture in view is."""
    tasks = page.reader.tasks
    match, best = tasks.scoring.matches.get(block.name), tasks.attempt(block).score
    solved = best >= block.goal
    with page.frame(block.name, theme.ACCENT if solved else theme.WARM):
        page.label(page.say("challenge"), theme.ACCENT if solved else theme.WARM)
        page.text(block.ask)
        target = tasks.judging.target(block)
        if target is not None:
            page.pictures.draw(target, _WIDE * page.look.scale)
            imgui.set_item_tooltip(written(block.alt))
            imgui.same_line()
        imgui.begin_group()
        if match is not None and tasks.is_begun(block):
            with page.look.font(page.look.bold, theme.TEXT_SIZE + 8):
                imgui.text(page.say("score", int(match.score)))
        with page.look.font(page.look.text, theme.SMALL):
            key, shown = ("best_score", (int(best), block.goal)) if best else ("goal_score", (block.goal,))
            imgui.text_disabled(page.say(key, *shown))
        if solved:
            with page.look.font(page.look.bold):
                imgui.text_colored(theme.colour(theme.ACCENT), page.say("solved"))
        imgui.end_group()
        _buttons(block, page)
        if tasks.is_begun(block):
            _sliders(block, page)
        for diagnostic in match.diagnostics if match is not None else ():
            page.plain(str(diagnostic), theme.ALARM)
        page.behind(block.name, "hint", block.hint)
        page.behind(block.name, "solution", block.solution)
        page.text(block.caption, size=theme.SMALL, dim=True)


def task_label(block: Exercise, page: Page) -> str:
    """Return what is written above an exercise: with its points where it has some."""
    name = page.say("exercise")
    if not checks_itself(block):
        return name
    best = page.reader.tasks.attempt(block)
    if best.of:
        return f"{name}   {page.say('best_points', f'{best.points:g}', block.points)}"
    return f"{name}   {page.say('points' if block.points > 1 else 'point', block.points)}"


def _buttons(block: Task, page: Page) -> None:
    tasks = page.reader.tasks
    is_started, attempt = tasks.is_begun(block), tasks.attempt(block)
    has_own = is_started or bool(attempt.text or attempt.values)
    judged = tasks.judging.at == block.name
    row: list[
        tuple[str, str, str, Callable[[Any], object], bool]
    ] = []  # key, mark, note, what it does, enabled
    if not is_started:
        row.append(("go_on" if has_own else "start", "start", page.say("start_note"), tasks.start, True))
    elif block.file:
        row.append(("to_the_text", "text", f"glsl/{block.file}", tasks.focus, True))
    if isinstance(block, Exercise) and has_own:
        key, check = "checking" if judged else "check", partial(_check, page=page)
        row.append((key, "check", page.say("check_note"), check, not judged))
    if attempt.before is not None:  # to begin again once more would take its place
        row.append(("bring_back", "back", "", tasks.undo, True))
    elif has_own:
        row.append(("again", "again", page.say("again_note"), tasks.start_again, True))
    for number, (key, mark, note, act, enabled) in enumerate(row):
        label = page.say(key)
        if number:
            page.same_line(label)
        if page.button(f"{label}##{mark}", note, enabled=enabled):
            act(block)


def _check(block: Exercise, page: Page) -> None:
    """Draw what is typed, and send it to be judged."""
    tasks, files = page.reader.tasks, page.reader.bench.files
    editing = files.copy_of(path_of(block)) if block.file else None
    if editing is not None and editing.view is not None and editing.view.changed and tasks.is_begun(block):
        save(editing, page.reader.bench.notices)
    tasks.check(block)


def _sliders(block: Task, page: Page) -> None:
    sliders = page.reader.tasks.sliders(block)
    if sliders and block.begin is not None:
        draw_parameters(block.begin, sliders, page)


def _verdict(block: Exercise, verdict: Verdict, page: Page) -> None:
    language = page.reader.language
    rgb = theme.ACCENT if verdict.passed else theme.WARM
    with page.look.font(page.look.bold):
        imgui.text_colored(theme.colour(rgb), points_of(verdict, language))
    tasks = page.reader.tasks
    if tasks.is_begun(block) and tasks.work(block) != tasks.judging.judged.get(block.name):
        page.text(page.say("changed_since"), size=theme.SMALL, dim=True)
    for diagnostic in verdict.diagnostics:
        page.plain(str(diagnostic), theme.ALARM)
    for result in verdict.results:
        _mark(page, good=result.passed)
        page.text(sentence_of(result, language), size=theme.SMALL + 1)
    wrong = [result for result in verdict.visible if not result.passed and result.mine is not None]
    opened, key = page.reader.shown, (block.name, "differences")
    if wrong and page.button(page.say("differences"), on=key in opened):
        opened.symmetric_difference_update({key})
    if key in opened:
        for result in wrong:
            _difference(result, page)


@INTERFACE.cached(weight=128)
def _map(result: CheckResult) -> Picture:
    assert result.mine is not None and result.expected is not None
    return difference_map(result.mine, result.expected)


def _mark(page: Page, *, good: bool) -> None:
    """Draw a tick or a cross before a line."""
    side, draw = 9.0 * page.look.scale, imgui.get_window_draw_list()
    at = imgui.get_cursor_screen_pos()
    low = ImVec2(at.x, at.y + 4.0 * page.look.scale)
    ink, thick = theme.packed(theme.ACCENT if good else theme.ALARM), 2.0 * page.look.scale
    if good:
        middle = ImVec2(low.x + 0.35 * side, low.y + side)
        draw.add_line(ImVec2(low.x, low.y + 0.6 * side), middle, ink, thick)
        draw.add_line(middle, ImVec2(low.x + side, low.y), ink, thick)
    else:
        draw.add_line(low, ImVec2(low.x + side, low.y + side), ink, thick)
        draw.add_line(ImVec2(low.x, low.y + side), ImVec2(low.x + side, low.y), ink, thick)
    imgui.dummy(ImVec2(side + 6.0 * page.look.scale, side))
    imgui.same_line()


def _difference(result: CheckResult, page: Page) -> None:
    """Draw the work, what is asked for, and where they differ."""
    mine, expected = result.mine, result.expected
    assert mine is not None and expected is not None
    shown = [("mine", mine), ("wanted", expected)]
    if mine.shape == expected.shape:
        shown.append(("differs", _map(result)))
    gap = imgui.get_style().item_spacing.x
    wide = (imgui.get_content_region_avail().x - gap * (len(shown) - 1)) / len(shown)
    for number, (key, picture) in enumerate(shown):
        if number:
            imgui.same_line()
        imgui.begin_group()
        page.pictures.draw(picture, wide)
        with page.look.font(page.look.text, theme.SMALL):
            imgui.text_disabled(page.say(key))
        imgui.end_group()
