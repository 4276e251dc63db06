"""The panel of lessons: which lesson, which page, each kind of block on it, and the way on."""

from __future__ import annotations

import re
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from imgui_bundle import ImVec2, imgui

from playground.course.glossary import linked_term
from playground.course.library import LANGUAGES, labels
from playground.course.measures import named_in
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
    Scene,
    Slider,
    Steps,
    Trace,
)
from playground.course.scenes import BOTH, comparable
from playground.course.tasks import (
    CheckResult,
    Picture,
    Verdict,
    checks_itself,
    difference_map,
    path_of,
    points_of,
    sentence_of,
)
from playground.course.typeset import label_text, written
from playground.course.window.bugs import BROKEN, FIXED, SHOWN
from playground.course.window.figure_view import sketch_path
from playground.course.window.page import Page, Textures, draw_picture
from playground.course.window.page import Prose as Texts
from playground.course.window.progress import MAX_WIDTH, MIN_WIDTH
from playground.course.window.reader import Reader
from playground.course.window.tasks import Task
from playground.errors import ParameterError, PlaygroundError
from playground.memo import INTERFACE
from playground.shader.parameter import write
from playground.sketch.assign import resolve
from playground.sketch.find import find
from playground.studio import theme
from playground.studio.draw import (
    SIDE_PANEL,
    button,
    fitting,
    inked,
    place_side_panel,
    pushed_id,
    styled,
    window,
)
from playground.studio.edits.history import History
from playground.studio.language import shortcut
from playground.studio.panel.parameter_list import PanelState, items_of, shown_values
from playground.studio.panel.passes_panel import Rows
from playground.studio.theme import Theme
from playground.studio.widgets import slide_whole


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
    if session.path != sketch_path(scene) or page.reader.figure.busy:
        return
    items = {item.leaf: item for item in items_of(draft).values()}
    values = shown_values(draft)
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
    return theme.palette.accent if page.reader.is_on(block) else theme.palette.line


def draw_code_block(block: Code, page: Page) -> None:
    """Draw an excerpt of a shader as it is now, with a way to edit a copy of it."""
    bugs = page.reader.bugs
    edited = bugs.is_edited(block)
    with page.frame(block.name, theme.palette.warm if edited else theme.palette.line):
        try:
            quoted = bugs.excerpt(block)
        except PlaygroundError as error:
            page.text(str(error), dim=True)
        else:
            with page.look.font(page.look.text, theme.SMALL):
                imgui.text_disabled(f"glsl/{block.file}:{quoted.line}")
            fence = "```"
            page.prose.draw(f"{fence}\n{quoted.text}\n{fence}", page.look, size=theme.SMALL + 1)
        if page.button(page.say("edit"), page.say("edit_note")):
            bugs.edit(block)
        if edited:
            page.same_line(page.say("put_back"))
            if page.button(page.say("put_back"), f"glsl/{block.file}"):
                bugs.put_back(block)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_trace(block: Trace, page: Page) -> None:
    """Draw lines of a shader with the values of one texel, and a slider over the steps of their loop."""
    reader = page.reader
    lines = reader.numbers.traces.get((page.lesson.name, block.name))
    failed = reader.numbers.failed.get((page.lesson.name, block.name))
    with page.frame(block.name, theme.palette.line):
        with page.look.font(page.look.text, theme.SMALL):
            texel = page.say("texel_of", x=block.texel[0], y=block.texel[1])
            imgui.text_disabled(f"glsl/{block.file}, {texel}")
        if lines is None:
            page.text(page.say("unmeasured", failed) if failed else page.say("measuring"), dim=True)
        else:
            last = len(lines.steps) - 1
            at = min(reader.at.get(block.name, 0), max(last, 0))
            if lines.steps:
                imgui.set_next_item_width(-1)
                chosen = slide_whole("##steps", at, (0, last), lines.label)
                reader.at[block.name] = at = at if chosen is None else chosen
            questions = page.lesson.questions_of(block.name)
            answered = all((question.name, "answer") in reader.shown for question in questions)
            for line in lines.lines:
                page.plain(line.code or " ")
                indent = " " * (len(line.code) - len(line.code.lstrip()) + 2)
                for value in filter(None, (each.text(at, reveals=answered) for each in line.values)):
                    page.plain(f"{indent}{value}", theme.palette.accent)
        page.text(block.caption, size=theme.SMALL, dim=True)


def draw_break(block: Break, page: Page) -> None:
    """Draw a bug: it is put into the picture, searched for, and fixed."""
    bugs = page.reader.bugs
    state = bugs.state.get(block.name, "")
    rgb = (
        theme.palette.alarm
        if state == BROKEN
        else theme.palette.accent
        if state in (FIXED, SHOWN)
        else theme.palette.warm
    )
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


_FIELD = 120.0  # for a number, in units of scale 1
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
    match, best = tasks.judging.matches.get(block.name), tasks.attempt(block).score
    solved = best >= block.goal
    with page.frame(block.name, theme.palette.accent if solved else theme.palette.warm):
        page.label(page.say("challenge"), theme.palette.accent if solved else theme.palette.warm)
        page.text(block.ask)
        target = tasks.judging.target(block)
        if target is not None:
            draw_picture(page.textures, target, _WIDE * page.look.scale)
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
                imgui.text_colored(theme.colour(theme.palette.accent), page.say("solved"))
        imgui.end_group()
        _buttons(block, page)
        if tasks.is_begun(block):
            _sliders(block, page)
        for diagnostic in match.diagnostics if match is not None else ():
            page.plain(str(diagnostic), theme.palette.alarm)
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
        files.save(editing)
    tasks.check(block)


def _sliders(block: Task, page: Page) -> None:
    sliders = page.reader.tasks.sliders(block)
    if sliders and block.begin is not None:
        draw_parameters(block.begin, sliders, page)


def _verdict(block: Exercise, verdict: Verdict, page: Page) -> None:
    language = page.reader.language
    rgb = theme.palette.accent if verdict.passed else theme.palette.warm
    with page.look.font(page.look.bold):
        imgui.text_colored(theme.colour(rgb), points_of(verdict, language))
    tasks = page.reader.tasks
    if tasks.is_begun(block) and tasks.work(block) != tasks.judging.judged.get(block.name):
        page.text(page.say("changed_since"), size=theme.SMALL, dim=True)
    for diagnostic in verdict.diagnostics:
        page.plain(str(diagnostic), theme.palette.alarm)
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
    ink, thick = theme.packed(theme.palette.accent if good else theme.palette.alarm), 2.0 * page.look.scale
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
        draw_picture(page.textures, picture, wide)
        with page.look.font(page.look.text, theme.SMALL):
            imgui.text_disabled(page.say(key))
        imgui.end_group()


def draw_prose(block: Prose, page: Page) -> None:
    """Draw a paragraph, a list, a table, a formula."""
    words = f"{'#' * block.level} {block.markdown}" if block.kind == "heading" else block.markdown
    page.text(words)


def draw_question(block: Question, page: Page) -> None:
    """Draw a question; its answer waits behind a button."""
    reader = page.reader
    with page.frame(block.name, theme.palette.warm):
        page.label(page.say("question"), theme.palette.warm)
        page.text(block.ask)
        chosen = reader.chosen.get(block.name, -1)
        for index, choice in enumerate(block.choices):
            _choice(block, index, choice, chosen, page)
        if block.of is not None:
            _number(block, page)
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
    with page.frame(block.name, theme.palette.warm):
        page.label(task_label(block, page), theme.palette.warm)
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
    with page.frame(block.name, theme.palette.line):
        waits = any(reader.numbers.waits(page.lesson, name) for name in named_in(block.sentence))
        page.label(page.say("measuring") if waits else page.say("measured"))
        if failed is not None:
            page.text(page.say("unmeasured", failed), size=theme.SMALL, dim=True)
        page.text(block.sentence)


def _number(block: Question, page: Page) -> None:
    """Draw a field for a number, and whether it is right."""
    reader = page.reader
    imgui.align_text_to_frame_padding()
    imgui.text(page.say("your_number"))
    imgui.same_line()
    imgui.set_next_item_width(_FIELD * page.look.scale)
    flags = imgui.InputTextFlags_.enter_returns_true.value
    entered, reader.typed[block.name] = imgui.input_text("##number", reader.typed.get(block.name, ""), flags)
    page.same_line(page.say("check_number"))
    waits = (page.lesson.name, block.name) not in reader.numbers.answers
    if page.button(page.say("check_number"), enabled=not waits) or (entered and not waits):
        reader.check_number(block)
    if block.name in reader.checked:
        right = reader.checked[block.name]
        value = f"{{{{{block.name}}}}}"
        said = page.say("no_number" if right is None else "wrong_number")
        page.text(page.say("right_number", value=value) if right else said)


def _choice(block: Question, index: int, choice: str, chosen: int, page: Page) -> None:
    """Draw one of several answers, as wide as the page."""
    on = chosen == index
    ink = theme.palette.accent if index == block.right else theme.palette.alarm
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
        imgui.set_tooltip(label_text(choice))


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
    opens: Callable[[Path], object] = reader.play or bench.actions.open
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
    Trace: draw_trace,
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

    memory: PanelState = field(default_factory=PanelState)
    _texts: Texts | None = None
    _textures: Textures | None = None

    def draw(self, reader: Reader, look: Theme, present: Callable[[], None]) -> float:
        """Draw the panel at the window's left side; return the width it takes, 0 while it is hidden.

        ``present`` begins a presentation of the lesson.
        """
        lesson = reader.lesson
        if lesson is None or not reader.progress.shown:
            return 0.0
        if self._texts is None:
            self._texts = Texts(
                lambda: self._textures_of(reader),
                lambda to: follow(reader, to),
                lambda to: link_text(reader, to),
            )
        limits, steps = (MIN_WIDTH, MAX_WIDTH), reader.bench.panes.take_steps("lesson")
        beside = _MIN_PICTURE_WIDTH
        target = place_side_panel(reader.progress.width, limits, look, beside=beside, steps=steps)
        with window("lesson", SIDE_PANEL, ground=theme.colour(theme.palette.ground)):
            page = Page(reader, lesson, look, self._texts, self.memory, self._textures_of(reader), present)
            _head(page)
            scrolls = imgui.WindowFlags_.always_vertical_scrollbar
            imgui.begin_child("page", ImVec2(0, -_foot_height()), imgui.ChildFlags_.nav_flattened, scrolls)
            if reader.to_top:
                reader.to_top = False
                imgui.set_scroll_y(0.0)
            _page(page)
            imgui.end_child()
            _foot(page)
            width = imgui.get_window_size().x
        if width != target:  # pulled; a narrow window alone makes it no narrower for good
            reader.progress.width = width / look.scale
        return float(width)

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""
        if self._textures is not None:
            self._textures.release()
        self._textures = None

    def _textures_of(self, reader: Reader) -> Textures:
        ctx = reader.bench.session.engine.ctx
        if self._textures is None or self._textures.ctx is not ctx:
            self._textures = Textures(ctx)  # those before went with a context that was lost
        return self._textures


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
            with inked(theme.palette.accent if done else theme.palette.ink):
                if imgui.selectable(label, summary.name == lesson.name)[0]:
                    reader.open(summary.name)
            minutes = page.say("minutes", summary.minutes, summary.exercise_minutes)
            imgui.set_item_tooltip(f"{label_text(summary.goal)}\n{minutes}")
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
        rgb = theme.palette.accent if index <= at else theme.palette.raised
        alpha = 1.0 if index == at or over else 0.5
        draw.add_rect_filled(low, high_corner, theme.packed(rgb, alpha), high / 2)
        if over:
            imgui.set_tooltip(label_text(section.title or page.lesson.title))
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
    if button(f"{page.say('previous')}##previous", shortcut("PgUp"), enabled=reader.index > 0, wide=half):
        reader.turn_page(-1)
    imgui.same_line()
    last = reader.index == count - 1
    following = next((summary for summary in reader.summaries if summary.number > page.lesson.number), None)
    text = page.say("next_lesson") if last else page.say("next")
    note = shortcut("PgDn") if not last else following.title if following else ""
    with styled({imgui.Col_.button: theme.colour(theme.palette.grab)}):
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
