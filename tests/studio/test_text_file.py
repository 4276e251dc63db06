"""A text edited in the window: saved whole, never over what others saved."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

import pytest

from playground.errors import DataError
from playground.studio.code.open_files import OpenText

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
