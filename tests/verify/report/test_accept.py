"""Accepting: the very picture that was looked at becomes the reference, or a message says why not."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.data.image_files import encode_png, read_png
from playground.errors import DataError, ParameterError
from playground.verify.shots.accept import accept, choose, undo
from playground.verify.shots.results import Record, flat, read_results, record_of

from .pictures import TEXTS, picture

RESULTS = Path("results")
PLACE = Path("screenshots/hills/llvmpipe")


def files() -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in PLACE.glob("*")}


def test_the_picture_takes_the_place_of_all_references(leave) -> None:
    (PLACE).mkdir(parents=True)
    (PLACE / "dawn.2.png").write_bytes(encode_png(picture(7)))
    (PLACE / "dawn-late.png").write_bytes(encode_png(picture(8)))
    record = leave(actual=picture(1), expected=picture(2))
    change = accept(RESULTS, record)
    assert sorted(files()) == ["dawn-late.png", "dawn.png"]
    pixels, texts = read_png(PLACE / "dawn.png")
    np.testing.assert_array_equal(pixels, picture(1))
    assert texts == TEXTS
    assert change.messages == [
        "wrote screenshots/hills/llvmpipe/dawn.png  (in place of the one before)",
        "removed screenshots/hills/llvmpipe/dawn.2.png  (it let the picture before this one pass)",
    ]


@pytest.mark.parametrize("also", [False, True])
def test_undo_puts_every_file_back_to_the_byte(leave, also: bool) -> None:
    (PLACE).mkdir(parents=True)
    (PLACE / "dawn.2.png").write_bytes(encode_png(picture(7)))
    record = leave(actual=picture(1), expected=picture(2))
    before = files()
    change = accept(RESULTS, record, also=also)
    assert files() != before
    assert undo(change)
    assert files() == before


def test_further_reference_takes_next_number_and_keeps_others(leave) -> None:
    (PLACE).mkdir(parents=True)
    (PLACE / "dawn.2.png").write_bytes(encode_png(picture(7)))
    record = leave(actual=picture(1), expected=picture(2))
    before = files()
    change = accept(RESULTS, record, also=True)
    assert change.further and change.written == Path.cwd() / PLACE / "dawn.3.png"
    assert {name: data for name, data in files().items() if name != "dawn.3.png"} == before
    np.testing.assert_array_equal(read_png(PLACE / "dawn.3.png")[0], picture(1))


@pytest.mark.parametrize("also", [False, True])
def test_the_first_reference_has_the_shot_s_own_name(leave, also: bool) -> None:
    change = accept(RESULTS, leave(actual=picture(1)), also=also)
    assert list(files()) == ["dawn.png"] and change.messages[0].endswith("(the first)")
    assert undo(change) == ["removed screenshots/hills/llvmpipe/dawn.png  (there was none before)"]
    assert not files()


@pytest.mark.parametrize("word", ["blank", "nan", "gl-error", "crash", "hang", "error"])
def test_a_broken_picture_is_never_accepted(leave, word: str) -> None:
    record = leave(actual=picture(1), expected=picture(2), word=word, message="it is broken")
    before = files()
    with pytest.raises(DataError, match=r"hills/dawn: no reference can be made of it \(it is broken\)"):
        accept(RESULTS, record)
    assert files() == before


def test_what_passed_is_not_accepted(leave) -> None:
    with pytest.raises(DataError, match="it passed"):
        accept(RESULTS, leave(actual=picture(1), expected=picture(1)))


def test_a_reference_that_changed_meanwhile_stays(leave) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    (PLACE / "dawn.png").write_bytes(encode_png(picture(3)))
    before = files()
    with pytest.raises(
        DataError, match="the reference has changed since it was checked; run the tests again"
    ):
        accept(RESULTS, record)
    (PLACE / "dawn.png").unlink()
    with pytest.raises(DataError, match=r"the reference dawn\.png has gone since"):
        accept(RESULTS, record)
    (PLACE / "dawn.png").write_bytes(before["dawn.png"])
    assert files() == before


def test_a_reference_that_came_meanwhile_stays(leave) -> None:
    record = leave(actual=picture(1))
    PLACE.mkdir(parents=True)
    (PLACE / "dawn.png").write_bytes(encode_png(picture(3)))
    with pytest.raises(DataError, match=r"the reference dawn\.png has come since"):
        accept(RESULTS, record)


def test_accepting_twice_says_that_it_is_done_already(leave) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    accept(RESULTS, record)
    before = files()
    again = accept(RESULTS, record)
    assert again.written is None and again.messages == ["hills/dawn: a reference is this picture already"]
    assert files() == before and undo(again) == []


def test_a_picture_that_has_gone_or_changed_is_refused(leave) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    path = RESULTS / record.actual.pictures["actual"]
    path.write_bytes(encode_png(picture(5)))
    with pytest.raises(DataError, match="its picture has changed since it was checked"):
        accept(RESULTS, record)
    path.unlink()
    with pytest.raises(DataError, match="its picture is not there any more"):
        accept(RESULTS, record)


def test_undo_never_loses_what_was_written_since(leave) -> None:
    change = accept(RESULTS, leave(actual=picture(1), expected=picture(2)))
    (PLACE / "dawn.png").write_bytes(encode_png(picture(3)))
    before = files()
    with pytest.raises(
        DataError, match="its references have changed since it was accepted; nothing is undone"
    ):
        undo(change)
    assert files() == before


def test_a_damaged_reference_is_replaced_but_never_a_further_one(leave) -> None:
    PLACE.mkdir(parents=True)
    record = leave(actual=picture(1), expected=picture(2), word="unreadable", message="damaged")
    with pytest.raises(DataError, match="is damaged, so it cannot stay"):
        accept(RESULTS, record, also=True)
    accept(RESULTS, record)
    np.testing.assert_array_equal(read_png(PLACE / "dawn.png")[0], picture(1))


def test_results_made_elsewhere_are_accepted_in_this_folder(leave, tmp_path: Path) -> None:
    """As from a continuous integration: its root is not here, so the paths are from this folder."""
    record = leave(actual=picture(1), expected=picture(2), root="/nowhere/on/this/machine")
    downloaded = tmp_path / "downloads/results"
    shutil.copytree(RESULTS, downloaded)
    shutil.rmtree(RESULTS)
    accept(downloaded, record)
    np.testing.assert_array_equal(read_png(PLACE / "dawn.png")[0], picture(1))


def test_results_of_this_machine_are_accepted_from_any_folder(leave, tmp_path: Path, monkeypatch) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    accept(tmp_path / "results", record)
    np.testing.assert_array_equal(read_png(tmp_path / PLACE / "dawn.png")[0], picture(1))
    assert not list(elsewhere.iterdir())


@pytest.mark.parametrize(
    "change",
    [{"home": ""}, {"home": "../screenshots"}, {"home": "pictures"}, {"renderer": "../x"}, {"renderer": "A"}],
)
def test_a_record_cannot_lead_elsewhere(leave, change: dict[str, str]) -> None:
    record = record_of(flat(leave(actual=picture(1))) | change)
    with pytest.raises(DataError, match="does not say where its references belong"):
        accept(RESULTS, record)


def test_shots_are_named_or_matched() -> None:
    records = [
        Record(sketch="a", shot="x", word="differs", message=""),
        Record(sketch="a", shot="y", word="same", message=""),
        Record(sketch="b[1]", shot="x", word="differs", message=""),
    ]

    def names(*patterns: str) -> list[str]:
        return [record.name for record in choose(records, list(patterns))]

    assert names("a/x") == ["a/x"]
    assert names("a/y") == ["a/y"], "what passed may be named: then it is refused in words"
    assert names("*/x", "a/*") == ["a/x", "b[1]/x"]
    assert names("b[1]/x") == ["b[1]/x"]
    with pytest.raises(ParameterError, match=r"there is no result of a shot 'a/z'; did you mean 'a/[xy]'"):
        names("a/z")
    with pytest.raises(ParameterError, match=r"no shot that failed matches 'c/\*'"):
        names("c/*")


def test_the_command_writes_and_says_what(leave, capsys) -> None:
    leave("hills/dawn", picture(1), picture(2))
    leave("hills/dusk", picture(3))
    leave("hills/noon", picture(4), picture(4))
    leave("hills/night", word="hang", message="took more than 60 s")
    assert main(["shots", "accept", "results", "hills/dawn"]) == 0
    message = capsys.readouterr()
    assert (
        message.out == "wrote screenshots/hills/llvmpipe/dawn.png  (in place of the one before)\n"
        and not message.err
    )
    assert main(["shots", "accept", "results", "hills/n*"]) == 2, "chosen by name, it is a mistake"
    assert "error: hills/night: no reference can be made" in capsys.readouterr().err
    assert main(["shots", "accept", "results", "--all", "--also"]) == 0
    message = capsys.readouterr()
    assert "hills/dawn: a reference is this picture already" in message.out
    assert "dusk.png  (the first)" in message.out
    assert message.err == (
        "left as it is: hills/night: no reference can be made of it (took more than 60 s)\n"
    )
    assert {record.name for record in read_results(RESULTS)} >= {"hills/noon"}
    assert sorted(files()) == ["dawn.png", "dusk.png", "noon.png"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "expected the names of shots, or --all"),
        (["results"], "expected the names of shots, or --all"),
        (["results", "hills/dawn", "--all"], "expected the names of shots, or --all"),
        (["results", "hills/down"], "did you mean 'hills/dawn'?"),
        (["nowhere/results", "hills/dawn"], "shots-report: there is no such folder"),
    ],
)
def test_a_wrong_choice_is_one_sentence(leave, capsys, arguments: list[str], message: str) -> None:
    leave(actual=picture(1), expected=picture(2))
    before = files()
    assert main(["shots", "accept", *arguments]) == 2
    assert message in capsys.readouterr().err
    assert files() == before


def test_the_report_command_prints_its_path(leave, capsys) -> None:
    leave(actual=picture(1))
    assert main(["shots", "report", "results", "-o", "out.html"]) == 0
    assert capsys.readouterr().out == "out.html\n"
    assert Path("out.html").read_text(encoding="utf-8").startswith("<!doctype html>")
