"""A lesson in front of a class, in a real window: the keys that a clicker sends, and the page of notes."""

from __future__ import annotations

import json
import re
import sys
import urllib.request
from pathlib import Path

import pytest

from ..studio.screen import ON_LINUX, Program, Screen
from .lesson_desk import OWN, write_lessons

RUN = """
import sys
from pathlib import Path
from playground.course import library
library.TEXTS = Path(sys.argv[1])
from playground.studio.app import run
from playground.course.talk.stage import Presenting
say = lambda text: print(text, file=sys.stderr, flush=True)
request = {"lesson": "halving", "present": Presenting(3, say=say)}
sys.exit(run(sys.argv[2], size=(640, 480), request=request, time_limit=300))
"""
pytestmark = ON_LINUX
SCREEN = 960, 540  # [pixels]


@pytest.mark.slow
def test_clicker_and_notes_drive_presentation_until_escape(
    screen: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LC_ALL", "C")
    write_lessons(tmp_path / "texts")
    (tmp_path / "sketch.toml").write_text(OWN, encoding="utf-8")
    command = [sys.executable, "-c", RUN, str(tmp_path / "texts"), str(tmp_path)]
    window = Program(screen, tmp_path, command, tmp_path)

    def press(key: str, beat: int) -> None:
        screen.do("key", key)
        window.wait(lambda now: now["beat"] == beat)

    try:
        window.wait(lambda now: now["beat"] == 3 and now["draws"] > 0 and now["stage"] == "NONE")
        shown = screen.pixels()
        assert shown.shape == (540, 960, 3) and (shown[-110:].min(axis=2) > 200).sum() > 200, (
            "a strip of text"
        )
        press("Next", 4)
        window.wait(lambda now: now["steps"] == {"height.raw": 0, "phase": 0})
        press("Prior", 3)
        press("space", 4)
        press("BackSpace", 3)
        screen.do("key", "period", "sleep", 0.5)
        assert screen.pixels().max() == 0, "black"
        screen.do("key", "Next", "sleep", 0.5)
        assert window.now()["beat"] == 3 and screen.pixels().max() > 200, "it only comes back"
        screen.do("key", "w", "sleep", 0.5)
        assert screen.pixels().min() == 255, "white"
        screen.do("key", "w", "key", "F5", "key", "shift+F5", "sleep", 0.5)
        assert window.now()["beat"] == 3, "a clicker's Start is nothing new"
        last = _ask(window, {"go": "last"})
        press("Home", 1)
        press("End", last)
        press("Home", 1)
        screen.do("type", "05")
        press("Return", 5)
        result = _ask(window, {"go": "next"})
        assert result == 6
        before = window.now()["edited"]
        press("Home", 1)
        screen.do("key", "1", "sleep", 0.2, "key", "Up")
        window.wait(lambda now: now["edited"] != before and now["edited"].get("height.seed") != 3)
        press("Escape", 0)
        assert window.process.poll() is None, "the program stays"
        press("F5", 1)
        press("Escape", 0)
        screen.do("key", "ctrl+q")
        assert window.ended() == 0, window.complaint()
    finally:
        window.close()


def _ask(window: Program, wishes: dict[str, object]) -> int:
    """Ask by the page of notes; return the beat that is on then."""
    url = re.search(r"http://\S+", window.complaint())
    assert url is not None
    request = urllib.request.Request(url[0] + "do", json.dumps(wishes).encode())
    before = window.now()["beat"]
    with urllib.request.urlopen(request, timeout=20) as answer:
        assert answer.status == 200
    window.wait(lambda now: now["beat"] != before)
    with urllib.request.urlopen(url[0] + "state", timeout=20) as answer:
        state = json.load(answer)["state"]
    assert state["at"] <= state["count"] and state["notes"].startswith("<p>")
    return int(state["at"])
