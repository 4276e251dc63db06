"""Files opened from the window: which editor gets which arguments, and texts edited here."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from playground.errors import DataError
from playground.studio.code.editors import Editor, Opener, find_editor, find_terminal
from playground.studio.code.open_files import OpenText

FILE = Path("/terrain/my hills/terrain.glsl").absolute()


def installed(*names: str) -> Callable[[str], str | None]:
    """Return a fake ``shutil.which`` on a machine with these programs."""
    return lambda name: f"/usr/bin/{name}" if name in names else None


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("/usr/bin/code",), ["-g", f"{FILE}:12:5"]),
        (("/usr/bin/code", "--wait"), ["--wait", "-g", f"{FILE}:12:5"]),
        ((r"C:\Programs\VS Code\bin\code.cmd",), ["-g", f"{FILE}:12:5"]),
        (("subl",), [f"{FILE}:12:5"]),
        (("gedit",), ["+12:5", str(FILE)]),
        (("kate",), ["--line", "12", "--column", "5", str(FILE)]),
        (("notepad++.exe",), ["-n12", "-c5", str(FILE)]),
        (("vim",), ["+call cursor(12,5)", str(FILE)]),
        (("nano",), ["+12,5", str(FILE)]),
        (("emacsclient",), ["-n", "+12:5", str(FILE)]),
        (("emacsclient", "-t"), ["-t", "+12:5", str(FILE)]),
        (("open", "-t"), ["-t", str(FILE)]),
        (("own-editor",), [str(FILE)]),
        (("own-editor", "--at={line}", "{file}"), ["--at=12", str(FILE)]),
    ],
)
def test_each_editor_gets_the_place_its_own_way(words: tuple[str, ...], expected: list[str]) -> None:
    assert Editor(words).command(FILE, 12, 5) == [words[0], *expected]


def test_a_place_that_is_not_known_is_the_first() -> None:
    assert Editor(("code",)).command(FILE) == ["code", "-g", f"{FILE}:1:1"]


def test_a_file_named_like_a_mark_is_left_alone() -> None:
    odd = Path("/terrain/{line}.glsl").absolute()
    assert Editor(("subl",)).command(odd, 3, 4) == ["subl", f"{odd}:3:4"]


@pytest.mark.parametrize(
    ("environ", "there", "expected"),
    [
        ({"VISUAL": "kate", "EDITOR": "code"}, ("kate", "code"), ("/usr/bin/kate",)),
        ({"PLAYGROUND_EDITOR": "subl -n", "VISUAL": "kate"}, ("kate", "subl"), ("/usr/bin/subl", "-n")),
        ({"EDITOR": "'gedit' --new-window"}, ("gedit",), ("/usr/bin/gedit", "--new-window")),
        ({}, ("gedit", "code"), ("/usr/bin/code",)),
        ({}, ("gedit",), ("/usr/bin/gedit",)),
        ({}, ("vim",), None),  # there is no terminal
        ({}, (), None),
        ({"PLAYGROUND_EDITOR": "builtin", "VISUAL": "kate"}, ("kate",), None),
        ({"VISUAL": "  "}, ("code",), ("/usr/bin/code",)),
    ],
)
def test_the_user_s_own_wish_comes_first(
    environ: dict[str, str], there: tuple[str, ...], expected: tuple[str, ...] | None
) -> None:
    editor, complaint = find_editor(environ, installed(*there), "linux")
    assert (editor.words if editor else None) == expected
    assert complaint == ""


def test_a_terminal_editor_runs_in_a_terminal() -> None:
    which = installed("vim", "xterm", "gnome-terminal", "st")
    editor, complaint = find_editor({"EDITOR": "vim -R"}, which, "linux")
    assert editor is not None and complaint == ""
    start = ["/usr/bin/gnome-terminal", "--", "/usr/bin/vim", "-R"]
    assert editor.command(FILE, 3, 1) == [*start, "+call cursor(3,1)", str(FILE)]
    assert find_terminal({"TERMINAL": "st -g 80x50"}, which) == ("/usr/bin/st", "-g", "80x50", "-e")
    assert find_terminal({"TERMINAL": "gone"}, which)[0] == "/usr/bin/gnome-terminal"
    emacs, _ = find_editor({"EDITOR": "emacs -nw"}, installed("emacs", "xterm"), "linux")
    assert emacs is not None and emacs.command(FILE, 3, 1)[:4] == [
        "/usr/bin/xterm", "-e", "/usr/bin/emacs", "-nw",
    ]  # fmt: skip
    alone, _ = find_editor({"EDITOR": "emacs"}, installed("emacs"), "linux")
    assert alone is not None and not alone.terminal, "it has a window of its own"


@pytest.mark.parametrize(
    ("environ", "part"),
    [
        ({"VISUAL": "atom --wait"}, "$VISUAL names atom, which is not installed"),
        ({"EDITOR": "'code"}, "$EDITOR is not a command"),
        ({"EDITOR": "vim"}, "no terminal to open it in"),
    ],
)
def test_a_wish_that_cannot_be_is_reported_and_the_next_is_taken(environ: dict[str, str], part: str) -> None:
    editor, complaint = find_editor(environ, installed("kate", "vim"), "linux")
    assert editor is not None and editor.name == "kate"
    assert part in complaint


def test_a_path_with_blanks_is_one_program() -> None:
    path = r"C:\Program Files\Notepad++\notepad++.exe"
    editor, _ = find_editor({"VISUAL": path}, lambda name: name if name == path else None, "win32")
    assert editor is not None and editor.command(FILE, 2, 1) == [path, "-n2", "-c1", str(FILE)]
    result, _ = find_editor(
        {"ProgramFiles": r"C:\Program Files"}, lambda name: name if name.endswith("++.exe") else None, "win32"
    )
    assert result is not None and result.name == "notepad++"


def ended(opener: Opener) -> None:
    for thread in opener.threads:
        thread.join(60)
        assert not thread.is_alive()


def test_editor_process_is_awaited_and_gets_verbatim_arguments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[subprocess.Popen[bytes]] = []

    def start(*words: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(real(*words, **options))
        return started[-1]

    real = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", start)
    out = tmp_path / "got.txt"
    code = "import sys, pathlib; pathlib.Path(sys.argv[1]).write_text('|'.join(sys.argv[2:]))"
    odd = tmp_path / "a $(touch owned); b.glsl"
    odd.write_text("// nothing\n")
    opener = Opener()
    editor = Editor((sys.executable, "-c", code, str(out), "{file}", "{line}", "{column}"))
    assert opener.open(editor, odd, 4, 2)
    ended(opener)
    assert out.read_text() == f"{odd}|4|2"
    assert not (tmp_path / "owned").exists() and not opener.notes
    assert started[0].returncode == 0, "it was waited for"


@pytest.mark.parametrize(
    "words",
    [
        ("sh", "-c", "vim {file}"),
        ("sh", "-c", "vim<{file}"),
        ("/bin/bash", "-lc", "{file}"),
        ("env", "A=b", "zsh", "-ec", '"{file}"'),
        ("tmux", "new-window", "vim '{file}'"),
        ("sh", "-c", "bash -c 'vim {file}'"),
    ],
)
def test_a_shell_that_would_read_the_name_is_refused(tmp_path: Path, words: tuple[str, ...]) -> None:
    opener = Opener()
    assert not opener.open(Editor(words), tmp_path / "a.glsl")
    assert "make {file} a word of its own" in opener.notes.popleft()


@pytest.mark.skipif(sys.platform == "win32", reason="needs sh")
@pytest.mark.parametrize(
    "name", ["my hills.glsl", "it's.glsl", "$(touch owned).glsl", "-n {line} {file}.glsl"]
)
def test_a_script_gets_the_name_as_an_argument(tmp_path: Path, name: str) -> None:
    words = ("sh", "-c", 'printf %s "$1"', "sh", "{file}")
    done = subprocess.run(
        Editor(words).command(tmp_path / name), cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.stdout, done.stderr) == (str(tmp_path / name), "") and not list(tmp_path.iterdir())


def test_an_editor_that_fails_is_a_sentence(tmp_path: Path) -> None:
    woken: list[int] = []
    opener = Opener(lambda: woken.append(1))
    file = tmp_path / "a.glsl"
    assert not opener.open(Editor((str(tmp_path / "gone"),)), file)
    assert opener.notes.popleft().startswith("gone could not be started: ")
    code = "import sys; print('cannot open display', file=sys.stderr); sys.exit(3)"
    assert opener.open(Editor((sys.executable, "-c", code, "{file}")), file)
    ended(opener)
    assert opener.notes.popleft().endswith("ended with status 3: cannot open display")
    assert woken


def test_a_running_editor_holds_nothing_up(tmp_path: Path) -> None:
    opener = Opener()
    code = "import sys; sys.stdin.read(); open(sys.argv[1]).read()"
    fifo = tmp_path / "go"
    if not hasattr(os, "mkfifo"):
        pytest.skip("no named pipes here")
    os.mkfifo(fifo)
    assert opener.open(Editor((sys.executable, "-c", code, str(fifo), "{file}")), tmp_path / "a.glsl")
    assert opener.threads[0].is_alive(), "it waits for the pipe, and we do not"
    subprocess.run([sys.executable, "-c", f"open({str(fifo)!r}, 'w').close()"], check=True, timeout=60)
    ended(opener)


# ── text file ─────────────────────────────────────────────────────────────────


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
