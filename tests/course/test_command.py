"""``playground lesson``: what it prints, what it writes, how it refuses."""

from __future__ import annotations

import json
import sys

import pytest

from playground.cli import main
from playground.course import commands as lesson_command
from playground.course import library
from playground.course.window.progress import Progress, progress_file, write_progress
from tests.course.conftest import FRENCH


@pytest.fixture
def texts(write_lesson, tmp_path, monkeypatch):
    """Give a folder of texts with the small lesson, in both languages."""
    monkeypatch.setenv("LC_ALL", "C")
    for language in ("en", "fr"):
        (tmp_path / "texts" / language).mkdir(parents=True)
    (tmp_path / "texts/en/small.md").write_bytes(write_lesson().read_bytes())
    (tmp_path / "texts/fr/small.md").write_text(FRENCH, encoding="utf-8")
    course = '[[part]]\ntitle = { en = "All", fr = "Tout" }\nlessons = ["small"]\n'
    (tmp_path / "course.toml").write_text(course, encoding="utf-8")
    monkeypatch.setattr(library, "TEXTS", tmp_path / "texts")
    return tmp_path / "texts"


def run(*arguments):
    return main(["lesson", *arguments])


def test_list_in_a_pipe(texts, capsys):
    assert run("list") == 0
    assert capsys.readouterr().out == "0\tsmall\tA small lesson\t6 min\t14 min\tAll\n"


def test_list_in_french_and_as_json(texts, capsys, monkeypatch):
    monkeypatch.setenv("LC_ALL", "fr_FR.UTF-8")
    assert run("list", "--json") == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert row == {
        "number": 0,
        "name": "small",
        "title": "Une petite leçon",
        "goal": "Connaître $r^2$.",
        "minutes": 6,
        "exercise_minutes": 14,
        "part": "Tout",
    }


def test_status_before_and_after_marking_and_after_a_change(texts, capsys):
    assert run("status") == 1
    assert "small\tfr\tunmarked\tplayground lesson translated small --lang fr" in capsys.readouterr().out
    assert run("translated", "small", "--lang", "fr") == 0
    assert run("status") == 0
    assert capsys.readouterr().out.endswith("small\tfr\tcurrent\t\n")
    path = texts / "en/small.md"
    path.write_text(path.read_text(encoding="utf-8").replace("A picture first.", "Two."), encoding="utf-8")
    assert run("status", "--json") == 1
    (row,) = json.loads(capsys.readouterr().out)
    assert row["state"] == "stale" and len(row["changed_lines"]) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("list", "--lang", "frr"), "--lang frr: no such language; did you mean 'fr'?"),
        (("check", "smal"), "no lesson 'smal'; did you mean 'small'?"),
        (("pictures", "smal"), "no lesson 'smal'"),
        (("translated", "small"), "name the translation: --lang fr"),
        (("build", "smal"), "no lesson 'smal'"),
    ],
)
def test_a_mistake_is_a_sentence(texts, capsys, arguments, words):
    assert run(*arguments) == 2
    error = capsys.readouterr().err
    assert words in error and "Traceback" not in error


def test_check_says_all_that_is_wrong(texts, capsys):
    run("translated", "small", "--lang", "fr")
    assert run("check") == 0
    assert capsys.readouterr().out.endswith("1 lesson: well\n")
    path = texts / "en/small.md"
    text = path.read_text(encoding="utf-8").replace("between = [0.1, 2.0]", "between = [3.0, 4.0]")
    path.write_text(text.replace("lesson:small", "lesson:large"), encoding="utf-8")
    assert run("check", "small") == 1
    error = capsys.readouterr().err
    assert "a link to lesson 'large'" in error and "is not between 3 and 4" in error
    assert "small.md:" in error


def test_pictures_are_written(texts, tmp_path, capsys):
    assert run("pictures", "small", "-o", str(tmp_path / "out")) == 0
    printed = capsys.readouterr().out.split()
    assert len(printed) == len(list((tmp_path / "out").glob("*.png"))) == 1 + 6 + 3 + 2 + 2 + 1


@pytest.mark.slow
def test_a_book_in_one_language_and_a_refused_folder(texts, tmp_path, capsys):
    run("translated", "small", "--lang", "fr")
    assert run("build", "small", "-o", str(tmp_path / "book"), "--lang", "fr") == 0
    assert capsys.readouterr().out.strip().endswith("index.html")
    assert (tmp_path / "book/fr/small.html").is_file() and not (tmp_path / "book/en").exists()
    assert run("build", "-o", str(texts)) == 2
    assert "no book" in capsys.readouterr().err


def test_notebooks(texts, tmp_path, capsys):
    run("translated", "small", "--lang", "fr")
    assert run("build", "small", "--notebooks", "-o", str(tmp_path / "books")) == 0
    for language in ("en", "fr"):
        result = json.loads((tmp_path / "books" / language / "small.ipynb").read_text(encoding="utf-8"))
        assert result["nbformat"] == 4 and len(result["cells"]) > 15


def test_languages_are_promised_as_they_are(capsys):
    """Building takes all, marking one that is named; reading takes the system's."""
    said = {}
    for command in ("list", "open", "build", "translated"):
        assert run(command, "--help") == 0
        said[command] = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "that of the system by default" in said["list"] and "that of the system" in said["open"]
    assert "both by default" in said["build"] and "that of the system" not in said["build"]
    assert "that of the system" not in said["translated"]


def test_open_without_name_takes_last_read_or_first_lesson(texts, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setattr("sys.platform", "linux")
    opened = []
    monkeypatch.setattr(lesson_command, "check_display", lambda renderer: None)
    monkeypatch.setattr(lesson_command, "open_window", lambda *_, request: opened.append(request["lesson"]))
    course = tmp_path / "course.toml"
    (texts / "en/first.md").write_bytes((texts / "en/small.md").read_bytes())
    course.write_text(course.read_text().replace('["small"]', '["first", "small"]'), encoding="utf-8")
    assert run("open") == 0
    for last in ("small", "gone"):
        write_progress(Progress(last), progress_file())
        assert run("open") == 0
    assert opened == ["first", "small", "first"]


def test_open_needs_a_screen_and_a_lesson(texts, capsys, monkeypatch):
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    assert run("open", "smal") == 2
    assert "no lesson 'smal'; did you mean 'small'?" in capsys.readouterr().err
    if sys.platform == "linux":
        assert run("open", "small") == 2
        assert "no screen" in capsys.readouterr().err
