"""Lessons in a real window: opened next to a sketch, paged by keys, and closed for good."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from playground.course.window.progress import Progress, write_progress

from ..studio.screen import ON_LINUX, Program, Screen
from .lesson_desk import OWN, write_lessons

RUN = """
import sys
from pathlib import Path
from playground.course import library
library.TEXTS = Path(sys.argv[1])
from playground.studio.app import run
sys.exit(run(sys.argv[2], size=(1000, 700), request={"lesson": sys.argv[3]}, time_limit=300))
"""
pytestmark = ON_LINUX


SCREEN = 1000, 700  # [pixels]


def opened(screen: Screen, folder: Path, lesson: str = "") -> Program:
    command = [sys.executable, "-c", RUN, str(folder / "texts"), str(folder), lesson]
    made = Program(screen, folder, command, folder)
    made.wait(lambda now: now["draws"] > 0)
    screen.do("mousemove", 800, 300)
    return made


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LC_ALL", "C")
    write_lessons(tmp_path / "texts")
    (tmp_path / "sketch.toml").write_text(OWN, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_lesson_beside_sketch_takes_view_on_page_turn(screen: Screen, folder: Path) -> None:
    progress = folder / "state" / "terrain-shader-playground" / "lessons.json"
    window = opened(screen, folder, "halving")
    try:
        own = window.now()["picture"]
        screen.do("key", "Next")
        window.wait(lambda now: now["steps"] == {"height.raw": 0, "phase": 0} and now["picture"] != own)
        page = screen.pixels()[:, :420]
        assert (page.min(axis=2) > 200).sum() > 500, "a page of text"
        screen.do("key", "F2")
        window.wait(lambda _: not json.loads(progress.read_text())["shown"])
        assert json.loads(progress.read_text())["sections"] == {"halving": 1}
        screen.do("key", "ctrl+q")
        assert window.ended() == 0, window.complaint()
    finally:
        window.close()


@pytest.mark.slow
def test_closed_lessons_stay_closed_and_leave_sketches_untouched(screen: Screen, folder: Path) -> None:
    progress = folder / "state" / "terrain-shader-playground" / "lessons.json"
    progress.parent.mkdir(parents=True)
    write_progress(Progress("halving", shown=False, sections={"halving": 1}), progress)
    window = opened(screen, folder)
    try:
        screen.do("key", "Next")
        screen.do("key", "m", "sleep", 0.2, "key", "m")
        now = window.wait(lambda now: now["map"] == "" and now["draws"] > 2)
        assert now["steps"] == {}, "no page is turned: the panel is closed"
        screen.do("key", "F2", "sleep", 0.2, "key", "Prior")
        window.wait(lambda _: json.loads(progress.read_text())["sections"] == {"halving": 0})
        window.wait(lambda now: now["runs"].get("light"))  # the lesson's terrain
        screen.do("key", "ctrl+q")
        assert window.ended() == 0, window.complaint()
        memories = [json.loads(f.read_text())["sketch"] for f in progress.parent.rglob("sessions/*.json")]
        assert memories in ([], [str(folder / "sketch.toml")]), "none of the lesson's sketches"
    finally:
        window.close()
