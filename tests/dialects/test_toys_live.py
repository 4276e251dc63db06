"""Shadertoy's exports, folders and VS Code files live: a save shows, a mistake has its pass and its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.studio.input.drops import _is_sketch
from playground.studio.problems.problems import Problems
from playground.studio.session import Session
from tests.dialect_texts import HERE, MISTAKE
from tests.toy_texts import EXPORTS, FOLDERS, PLAIN, VSCODE, A, Toy, export, one

SIZE = (16, 9)
CASES: dict[str, tuple[Toy, str]] = {
    "export": (EXPORTS["common_in_a_buffer"], "shader.json"),
    "folder": (FOLDERS["folder_directive"], "Buffer A.glsl"),
    "code": (VSCODE["code_file"], "b.glsl"),
    "code_include": (VSCODE["code_include"], "lib/x.glsl"),
}


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", CASES)
def test_save_of_any_pass_shows_and_error_keeps_last_picture(any_engine, tmp_path, name):
    toy, file = CASES[name]
    write(tmp_path, toy.files)
    session = Session(any_engine, tmp_path / toy.opens)
    try:
        session.frame(SIZE)
        first = session.read()
        assert first is not None and session.error is None
        assert tmp_path / file in session.drafts.files
        files, line = toy.with_mistake()
        write(tmp_path, files)
        session.drafts.reload()
        session.frame(SIZE)
        assert session.error is not None
        diagnostic = session.error.diagnostics[0]
        assert (diagnostic.file.rpartition("/")[2], diagnostic.line) == (toy.at, line)
        assert Problems().lines_around(diagnostic)[0][1].strip() or "not_declared" in diagnostic.excerpt
        assert MISTAKE.strip() in [text.strip() for _, text in Problems().lines_around(diagnostic)]
        again = session.read()
        assert again is not None
        np.testing.assert_array_equal(again.array, first.array)
        planted = toy.files[file].replace("0.5", "0.125")
        assert planted != toy.files[file] or name != "code_include"
        write(tmp_path, {**toy.files, file: planted})
        session.drafts.reload()
        session.frame(SIZE)
        assert session.error is None
        changed = session.read()
        assert changed is not None
        assert np.array_equal(changed.array, first.array) == (planted == toy.files[file])
    finally:
        session.release()


def test_what_is_dropped_opens(tmp_path):
    write(tmp_path, {"a.json": export(one("Image", PLAIN), A), "b.json": '{"x": 1}', "t/Image.glsl": PLAIN})
    (tmp_path / "none").mkdir()
    assert [_is_sketch(tmp_path / name) for name in ("a.json", "b.json", "t", "none")] == [
        True,
        False,
        True,
        False,
    ]


def test_a_pass_that_comes_is_watched_for(any_engine, tmp_path):
    write(tmp_path, {"Image.glsl": FOLDERS["folder"].files["Image.glsl"].replace(HERE, "")})
    session = Session(any_engine, tmp_path)
    try:
        session.frame(SIZE)
        noise = session.read()
        assert tmp_path / "Buffer A.glsl" in session.drafts.files
        write(tmp_path, {"Buffer A.glsl": PLAIN})
        session.drafts.reload()
        session.frame(SIZE)
        shown = session.read()
        assert noise is not None and shown is not None and session.error is None
        assert not np.array_equal(noise.array, shown.array)
    finally:
        session.release()
