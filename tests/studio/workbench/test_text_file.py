"""A text edited in the window: saved whole, never over what others saved, merged where that is safe."""

from __future__ import annotations

import os
import random
import stat
import sys
from pathlib import Path

import pytest

from playground.errors import DataError
from playground.studio.code.text_file import OpenText, merge

TEXT = "one\ntwo\nthree\nfour\nfive\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "terrain.glsl"
    path.write_bytes(TEXT.encode())
    return path


def test_a_save_leaves_the_text_and_no_other_file(file: Path) -> None:
    text = OpenText.read(file)
    assert text.base == TEXT and not text.changed_outside()
    assert text.save(TEXT + "six ³\n")
    assert file.read_bytes() == (TEXT + "six ³\n").encode()
    assert [path.name for path in file.parent.iterdir()] == ["terrain.glsl"]
    assert not text.changed_outside() and text.save("again\n")


@pytest.mark.parametrize(("start", "ending"), [(b"", b"\n"), (b"\xef\xbb\xbf", b"\r\n")])
def test_line_ends_and_marks_stay(file: Path, start: bytes, ending: bytes) -> None:
    file.write_bytes(start + b"a" + ending + b"b" + ending)
    text = OpenText.read(file)
    assert text.base == "a\nb\n"
    text.save("a\nB\n")
    assert file.read_bytes() == start + b"a" + ending + b"B" + ending


def test_what_others_saved_is_not_overwritten(file: Path) -> None:
    text = OpenText.read(file)
    file.write_text("theirs\n", encoding="utf-8")
    assert text.changed_outside()
    assert not text.save("mine\n")
    assert file.read_text(encoding="utf-8") == "theirs\n"
    assert text.save("mine\n", over=True)
    assert file.read_text(encoding="utf-8") == "mine\n"
    file.unlink()
    assert not text.save("mine again\n") and not file.exists()
    assert text.save("mine again\n", over=True) and file.exists()


def test_a_save_of_the_same_bytes_by_others_is_no_change(file: Path) -> None:
    text = OpenText.read(file)
    file.write_bytes(TEXT.encode())
    os.utime(file, (1, 1))
    assert not text.changed_outside() and text.save("mine\n")


def test_what_cannot_be_edited_is_a_sentence(tmp_path: Path, file: Path) -> None:
    with pytest.raises(DataError, match="there is no such file"):
        OpenText.read(tmp_path / "gone.glsl")
    file.write_bytes(b"\xff\xfe")
    with pytest.raises(DataError, match=r"not UTF-8 text \(byte 0\)"):
        OpenText.read(file)


@pytest.mark.skipif(sys.platform == "win32", reason="permissions differ")
def test_permissions_and_links_stay(file: Path, tmp_path: Path) -> None:
    file.chmod(0o640)
    link = tmp_path / "link.glsl"
    link.symlink_to(file)
    OpenText.read(link).save("new\n")
    assert link.is_symlink() and file.read_text(encoding="utf-8") == "new\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


def test_a_file_that_cannot_be_written_stays_and_says_so(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = OpenText.read(file)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(DataError, match="could not be saved: No space left"):
        text.save("mine\n")
    assert file.read_text(encoding="utf-8") == TEXT
    assert [path.name for path in file.parent.iterdir()] == ["terrain.glsl"]
    monkeypatch.undo()
    assert text.save("mine\n"), "the text is not lost"


def test_changes_far_apart_merge_and_near_ones_do_not(file: Path) -> None:
    text = OpenText.read(file)
    mine = TEXT.replace("one", "ONE")
    file.write_text(TEXT.replace("five", "FIVE"), encoding="utf-8")
    merged = text.merged(mine)
    assert merged == "ONE\ntwo\nthree\nfour\nFIVE\n"
    assert text.save(merged), "it has seen theirs"
    assert merge(TEXT, TEXT.replace("two", "2"), TEXT.replace("two", "II")) is None
    assert merge(TEXT, TEXT.replace("two", "2"), TEXT.replace("three", "III")) is None, "they adjoin"
    assert merge(TEXT, mine, mine) == mine, "the same change on both sides is one"
    assert merge(TEXT, mine, TEXT) == mine and merge(TEXT, TEXT, mine) == mine


def test_a_merge_of_changes_to_other_lines_is_both() -> None:
    """Against the truth: change lines far apart, some by me and some by others."""
    randoms = random.Random(7)
    for _ in range(200):
        lines = [f"line {n}" for n in range(60)]
        mine, theirs, both = list(lines), list(lines), list(lines)
        for n in range(0, 60, 4):
            text = f"new {n}" * randoms.randint(0, 3)
            whose = randoms.choice((None, mine, theirs))
            if whose is not None:
                whose[n] = both[n] = text
        joined = ["\n".join(t) + "\n" for t in (lines, mine, theirs, both)]
        assert merge(*joined[:3]) == joined[3]
