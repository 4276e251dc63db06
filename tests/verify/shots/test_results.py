"""The records of checked shots: every one comes back as it was, and anything else is refused in words."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.errors import DataError
from playground.verify.shots.results import (
    PICTURES,
    Record,
    flat,
    from_json,
    read_result,
    read_results,
    record_of,
    result_path,
    to_json,
    write_result,
)

FULL = record_of(
    dict(
        sketch="hills & dales",
        shot="dawn",
        word="differs",
        message="max difference 12 of 255, at x = 3, y = 1 from the top left",
        renderer="llvmpipe",
        tier="same build",
        tolerance="noise, 8 of 255 at 100 % of the pixels (grain)",
        tolerated="needed",
        masked=("4 × 2 pixels at x = 0, y = 0",),
        tone="reinhard",
        reference="screenshots/hills/llvmpipe/dawn.png",
        stands_in="drawn by apple-m1, compared by structure only with llvmpipe's references",
        catches="anything over one level",
        numbers={"max difference [levels]": 12, "over [%]": 0.25},
        size=(6, 4),
        expected_size=(6, 4),
        place=(3, 1),
        texts={"renderer": "llvmpipe (LLVM 15.0.6)", "sketch": "hills – Hügel"},
        expected_texts={"renderer": "llvmpipe (LLVM 14.0.0)"},
        fingerprint=("LLVM 15.0.6 drew it now, LLVM 14.0.0 the reference",),
        traced=("land.glsl:9: lit = 0.5, in the reference's run 0.4  (pass light, texel (3, 4))",),
        root="/a/terrain",
        home="screenshots",
        compared="dawn.2.png",
        references={"dawn.png": "ab" * 32, "dawn.2.png": "cd" * 32},
        error="<script>alert(1)</script>\n\x1b[31mred",
        node="tests/test_shots.py::test_shot[hills/dawn]",
        command="pytest --shots-update 'tests/test_shots.py::test_shot[hills/dawn]'",
        seconds=0.25,
        when=1.75e9,
        run="abc",
    )
)
PIXELS = np.arange(4 * 6 * 4, dtype=np.uint8).reshape(4, 6, 4)


def test_every_field_of_the_example_says_something() -> None:
    """So that a field that is lost on the way cannot go unseen."""
    alone = {"pictures", "digest", "folder"}  # what write_result fills in; tested by itself
    assert not [name for name, value in flat(FULL).items() if not value and name not in alone]


OTHER = replace(FULL, folder="hills & dales-1a2b3c4d")


@pytest.mark.parametrize(
    "record",
    [FULL, OTHER, Record(sketch="a", shot="b", word="same", message="every pixel")],
    ids=["full", "in a folder of its own", "bare"],
)
def test_a_record_comes_back_as_it_was(record: Record) -> None:
    text = to_json(record)
    assert from_json(text) == record
    assert json.loads(text)["format"] == 4


def test_a_result_is_there_with_its_pictures_and_again_without(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    pictures = {word: PIXELS + np.uint8(number) for number, word in enumerate(PICTURES)}
    written = write_result(folder, FULL, pictures)
    assert read_results(folder) == [written]
    assert written.actual.pictures == {word: f"hills & dales/dawn.{word}.png" for word in PICTURES}
    assert (
        written.actual.digest
        == hashlib.sha256((folder / written.actual.pictures["actual"]).read_bytes()).hexdigest()
    )
    for word, pixels in pictures.items():
        read, texts = read_png(folder / written.actual.pictures[word])
        np.testing.assert_array_equal(read, pixels)
        assert texts == (FULL.actual.texts if word == "actual" else {})
    passed = write_result(folder, replace(FULL, word="same"), {})
    assert passed.actual.pictures == {} and passed.actual.digest == ""
    assert [p.name for p in (folder / FULL.sketch).iterdir()] == ["dawn.json"]


def test_new_results_folder_is_git_ignored_existing_one_is_not(tmp_path: Path) -> None:
    write_result(tmp_path / "new", FULL, {})
    assert "*" in (tmp_path / "new/.gitignore").read_text().splitlines()
    (tmp_path / "mine").mkdir()
    write_result(tmp_path / "mine", FULL, {})
    assert [p.name for p in (tmp_path / "mine").iterdir()] == [FULL.sketch]


def test_results_come_by_sketch_and_shot(tmp_path: Path) -> None:
    for name in ("b/z", "b/a", "a/m"):
        sketch, shot = name.split("/")
        write_result(tmp_path, Record(sketch=sketch, shot=shot, word="same", message="every pixel"), {})
    assert [record.name for record in read_results(tmp_path)] == ["a/m", "b/a", "b/z"]


def test_two_sketches_of_one_name_stand_side_by_side(tmp_path: Path) -> None:
    written = [write_result(tmp_path, record, {"actual": PIXELS}) for record in (FULL, OTHER)]
    assert read_results(tmp_path) == written
    assert [record.name for record in written] == ["hills & dales/dawn", "hills & dales-1a2b3c4d/dawn"]
    assert len({record.actual.pictures["actual"] for record in written}) == 2


def test_a_stamp_distinguishes_one_result_from_the_next() -> None:
    assert FULL.stamp == replace(FULL).stamp != record_of(flat(FULL) | {"when": FULL.run.when + 1}).stamp


def test_a_record_in_the_place_of_another_is_refused(tmp_path: Path) -> None:
    written = write_result(tmp_path, FULL, {})
    path = result_path(tmp_path, written)
    path.rename(path.with_name("dusk.json"))
    with pytest.raises(DataError, match="the record of hills & dales/dawn lies where another belongs"):
        read_result(path.with_name("dusk.json"))


def test_a_record_that_cannot_be_written_leaves_none_half_done(tmp_path: Path) -> None:
    """The old record goes before the pictures change: no record ever speaks of another run's pictures."""
    write_result(tmp_path, FULL, {"actual": PIXELS})
    with pytest.raises(DataError, match="uint8 array"):
        write_result(tmp_path, FULL, {"actual": PIXELS.astype(np.float32)})  # type: ignore[dict-item]
    assert not list(tmp_path.glob("*/*.json"))
    assert not list(tmp_path.glob("*/.*.part"))
