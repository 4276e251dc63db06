"""Exercises that check themselves, and pictures to match, next to the picture: nothing typed is lost."""

from __future__ import annotations

import time

import pytest

from playground.course import library
from playground.course.addition import Lessons
from playground.course.tasks import answer_text
from playground.course.window.page import Page
from playground.course.window.progress import (
    Attempt,
    Progress,
    progress_file,
    read_progress,
    write_progress,
)
from playground.paths import GLSL
from playground.shader.source import read_text
from playground.studio.bench import Host

FILE = "generation/diamond_square/raw.glsl"
RAW = read_text(GLSL / FILE)
LESSON = f"""+++
title   = "After it"
goal    = "Do."
thesis  = []
papers  = []
sketch  = "white_noise"
+++

Do it.

```exercise power
ask      = "Write it."
solution = "So."
sketch   = "diamond_square_steps"
pixels   = [96, 96]
alt      = "Discs"
file     = "{FILE}"
answer   = "diamond_square/dimension.answer.glsl"
points   = 2

[[check]]

[[check]]
of        = "height"
tolerance = 0.001
at        = {{ "height.seed" = 4 }}
hidden    = true
```

## Values

```exercise rough
ask      = "Set it."
solution = "So."
sketch   = "diamond_square_steps"
pixels   = [96, 96]
alt      = "Discs"
set      = {{ "height.smoothing" = 0.8 }}
sliders  = ["height.smoothing"]
```

```challenge seen
ask     = "Match it."
sketch  = "diamond_square_steps"
pixels  = [96, 96]
alt     = "Discs"
set     = {{ "height.smoothing" = 0.8 }}
begin   = {{ "height.smoothing" = 0.0 }}
sliders = ["height.smoothing"]
```
"""


@pytest.fixture
def tasks(harness):
    (library.TEXTS / "en" / "after.md").write_text(LESSON, encoding="utf-8")
    assert harness.reader.open("after", page=0)
    harness.run_frames(4)
    return harness.reader.tasks


def block(harness, name):
    return harness.reader.lesson.named[name]


def judged(harness):
    """Draw frames until the process has judged."""
    drawn_elsewhere(harness, lambda: not harness.reader.tasks.judging.at)


def drawn_elsewhere(harness, until):
    """Draw frames until the process has done something."""
    end = time.monotonic() + 60.0
    while not until():
        assert time.monotonic() < end
        harness.run_frames(1)
        time.sleep(0.02)
    harness.run_frames(2)


def typed(editing, text):
    """Type a text in place of all that is there."""
    editing.view.editor.select_all()
    editing.view.editor.replace_text_in_current_cursor(text)


def attempts():
    return read_progress(progress_file()).attempts


@pytest.mark.slow
def test_a_kernel_is_begun_checked_and_kept_over_a_restart(harness, tasks):
    monkeypatch = pytest.MonkeyPatch()
    harness.click("Start##start")
    harness.run_frames(4)
    assert tasks.is_begun(block(harness, "power")) and harness.session.path.stem == "diamond_square_steps"
    (editing,) = harness.bench.files.editing
    assert editing.text.base == RAW
    harness.click("Check##check")
    judged(harness)
    verdict = tasks.judging.verdicts["power"]
    assert verdict.points == 0.0 and [result.passed for result in verdict.results] == [False, False]
    harness.click("What differs")
    harness.run_frames(2)

    right = answer_text(block(harness, "power"))
    said = []
    monkeypatch.setattr(Page, "text", lambda page, words, **rest: said.append(words))
    harness.run_frames(1)
    assert "You have changed it since: check again." not in said
    typed(editing, right)  # not saved
    harness.run_frames(2)
    assert "You have changed it since: check again." in said
    monkeypatch.undo()
    harness.click("Check##check")
    judged(harness)
    assert tasks.judging.verdicts["power"].passed
    kept = attempts()["after/power"]
    assert kept.text.strip() == right.strip() and (kept.points, kept.of) == (2.0, 2)

    harness.reader.go(1)
    harness.run_frames(4)
    assert harness.bench.files.editing == [] and not harness.session.drafts.texts
    harness.reader.go(0)
    harness.run_frames(4)
    harness.click("Go on##start")
    harness.run_frames(4)
    assert harness.bench.files.editing[0].text.base.strip() == right.strip()

    harness.click("Begin again##again")
    harness.run_frames(4)
    assert harness.bench.files.editing[0].text.base == RAW
    harness.click("Bring mine back##back")
    harness.run_frames(4)
    assert harness.bench.files.editing[0].text.base.strip() == right.strip()


def test_begin_again_and_bring_back_exchange_what_is_typed(harness, tasks):
    """Neither loses anything that was typed; a bare starter is not kept."""
    power = block(harness, "power")
    tasks.start(power)
    harness.run_frames(4)

    def now():
        (editing,) = harness.bench.files.editing
        return editing.text.base.strip()

    def press(label):
        harness.run_frames(2)
        harness.click(label)
        harness.run_frames(4)

    first, second = RAW + "// first", RAW + "// second"
    typed(harness.bench.files.editing[0], first)  # none of what is typed here is saved
    press("Begin again##again")
    assert now() == RAW.strip()
    typed(harness.bench.files.editing[0], second)
    press("Bring mine back##back")
    assert now() == first.strip()
    press("Bring mine back##back")
    assert now() == second.strip(), "what was typed after it began again is kept as well"
    typed(harness.bench.files.editing[0], RAW)
    press("Bring mine back##back")
    assert now() == first.strip() and tasks.attempt(power).before is None
    press("Begin again##again")  # is offered again
    assert now() == RAW.strip() and attempts()["after/power"].before[0].strip() == first.strip()


def test_values_are_exchanged_as_they_are_in_the_picture(harness, tasks):
    harness.reader.go(1)
    harness.run_frames(4)
    rough = block(harness, "rough")
    tasks.start(rough)
    harness.run_frames(4)
    for value in (0.8, 0.2):
        harness.session.drafts.set("height.smoothing", value)
        harness.run_frames(4, step=0.01)  # before it is stored by itself
        (tasks.start_again if value == 0.8 else tasks.undo)(rough)
        harness.run_frames(4)
    assert dict(tasks.work(rough).values) == {"height.smoothing": 0.8}
    assert tasks.attempt(rough).before == ("", {"height.smoothing": 0.2})


def test_unsaved_typing_survives_restart(harness, tasks):
    tasks.start(block(harness, "power"))
    harness.run_frames(4)
    (editing,) = harness.bench.files.editing
    typed(editing, RAW + "// mine\n")
    harness.run_frames(10, step=0.5)
    assert attempts()["after/power"].text.endswith("// mine\n"), "also where the program crashes"
    typed(editing, RAW + "// later\n")
    harness.run_frames(1)
    harness.lessons.release()
    assert attempts()["after/power"].text.endswith("// later\n")


def test_a_slider_that_a_student_adds_is_there_to_drag(harness, tasks):
    power = block(harness, "power")
    tasks.start(power)
    harness.run_frames(4)
    assert tasks.sliders(power) == ()
    own = "uniform float mine = 0.5; //! slider(0, 1) Mine\nuniform uint seed"
    tasks.copies.open[(GLSL / FILE).resolve()].save(RAW.replace("uniform uint seed", own))
    harness.run_frames(4)
    assert tasks.sliders(power) == ("height.raw.mine",)
    harness.click("##height.raw.mine", 0.9)
    assert dict(harness.session.shown.applied)["height.raw.mine"] > 0.8


def test_the_text_of_another_block_is_no_attempt(harness, tasks):
    """A bug put into the same file takes the place of the copy."""
    first = block(harness, "power")
    tasks.start(first)
    harness.run_frames(4)
    copies = tasks.copies
    mine = copies.open[(GLSL / FILE).resolve()]
    copies.edit(mine.path, "// another's", lambda text: None)
    tasks.store()
    assert tasks.work(first).text == RAW and tasks.attempt(first).text == ""
    tasks.leave()
    assert copies.text_of(mine.path) == "// another's"


def test_the_solution_s_picture_is_that_of_the_model_answer(harness, tasks):
    harness.reader.show(block(harness, "power"))
    harness.run_frames(4)
    ((path, text),) = harness.session.drafts.texts.items()
    assert path.endswith("raw.glsl") and text == answer_text(block(harness, "power"))
    assert not tasks.is_begun(block(harness, "power"))
    harness.reader.go(1)
    harness.run_frames(4)
    assert not harness.session.drafts.texts


@pytest.mark.slow
def test_values_are_set_with_sliders_and_checked(harness, tasks):
    harness.reader.go(1)
    harness.run_frames(4)
    rough = block(harness, "rough")
    tasks.start(rough)
    harness.run_frames(4)
    assert dict(tasks.work(rough).values) == {"height.smoothing": 0.5}
    tasks.check(rough)
    judged(harness)
    assert tasks.judging.verdicts["rough"].points == 0.0
    harness.session.drafts.set("height.smoothing", 0.8)
    harness.run_frames(4)
    tasks.check(rough)
    judged(harness)
    assert tasks.judging.verdicts["rough"].passed
    assert attempts()["after/rough"].values == {"height.smoothing": 0.8}


@pytest.mark.slow
def test_a_score_follows_the_picture_and_the_best_is_kept(harness, tasks):
    harness.reader.go(1)
    harness.run_frames(4)
    seen = block(harness, "seen")
    drawn_elsewhere(harness, lambda: tasks.judging.target(seen) is not None)  # before one begins
    tasks.start(seen)
    harness.run_frames(4)
    matches, scores = tasks.judging.matches, []
    drawn_elsewhere(harness, lambda: "seen" in matches)
    assert matches["seen"].score == 0.0
    for smoothing in (0.4, 0.8, 0.6):
        last = matches["seen"]
        harness.session.drafts.set("height.smoothing", smoothing)
        drawn_elsewhere(harness, lambda last=last: matches["seen"] is not last)
        scores.append(matches["seen"].score)
    assert scores[1] == 100.0 and 0.0 < scores[0] < 100.0 and 0.0 < scores[2] < 100.0
    assert attempts()["after/seen"].score == 100.0
    last = matches["seen"]
    harness.run_frames(20, step=0.2)
    assert matches["seen"] is last and not tasks.judging.busy, "a picture that rests is scored once"


def test_the_window_says_that_attempts_could_not_be_read(harness):
    progress_file().parent.mkdir(parents=True, exist_ok=True)
    progress_file().write_text("damaged", encoding="utf-8")
    Lessons(Host(harness.bench, harness.autosave, lambda: None, lambda: None, lambda: harness.theme))
    harness.run_frames(1)
    said = [notice.text for notice in harness.bench.notices.items]
    assert any("what was remembered of lessons cannot be read; it is kept in" in text for text in said)


def test_old_progress_is_read_and_new_attempts_round_trip(tmp_path):
    path = tmp_path / "lessons.json"
    old = Progress("halving", sections={"halving": 2})
    assert write_progress(old, path) == ""
    text = path.read_text(encoding="utf-8").replace(',\n "attempts": {}', "")
    assert "attempts" not in text
    path.write_text(text, encoding="utf-8")
    assert read_progress(path) == old
    done = Attempt("x\n", {"a.b": (1.0, 2.0), "c": True}, ("y", {"a.b": 3}), 1.5, 2, 88.0)
    write_progress(Progress("halving", attempts={"halving/x": done, "halving/y": Attempt()}), path)
    assert read_progress(path).attempts == {"halving/x": done}
