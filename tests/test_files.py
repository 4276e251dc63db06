"""Files half written, files that are none, and texts of JSON."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from playground.errors import DataError
from playground.files import make_folder, partial_file, remove_left_over, replacing

ROOT = Path(__file__).resolve().parent.parent
PLAIN = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(0.5); }\n"
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGXCPU", "SIGUSR1", "SIGUSR2")
UNCHANGED = ".picture.png.0123456789ab.part"


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture(autouse=True)
def _as_in_a_new_process():
    remove_left_over.cache_clear()


def test_a_file_is_there_while_it_is_written_and_gone_after(tmp_path: Path):
    with partial_file(tmp_path / "a.png") as partial:
        assert names(tmp_path) == [partial.path.name]
    assert names(tmp_path) == []
    with replacing(tmp_path / "a.png") as handle:
        handle.write(b"new")
    assert names(tmp_path) == ["a.png"] and (tmp_path / "a.png").read_bytes() == b"new"


def test_a_folder_is_refused_where_a_file_is(tmp_path: Path):
    (tmp_path / "file").write_text("x")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for name, refused in [("file", "file"), ("file/a/b", "file"), ("link", "link"), ("link/a", "link")]:
        with pytest.raises(DataError, match=r"; expected a folder$") as caught:
            make_folder(tmp_path / name)
        assert caught.value.diagnostics[0].file == str(tmp_path / refused)
    assert make_folder(tmp_path / "a" / "b").is_dir() and make_folder(tmp_path / "a") == tmp_path / "a"


def test_what_a_dead_process_left_is_removed_and_nothing_else(tmp_path: Path):
    others = [".picture.png.part", "picture.png.0123456789ab.part", ".a.0123456789az.part", "b.part"]
    for name in (UNCHANGED, *others):
        (tmp_path / name).write_bytes(b"some")
    (tmp_path / ".folder.0123456789ab.part").mkdir()
    with replacing(tmp_path / "b.png"):
        pass
    assert names(tmp_path) == sorted([".folder.0123456789ab.part", "b.png", *others])


WRITES = """
import sys, time
from pathlib import Path
from playground.files import partial_file
with partial_file(Path(sys.argv[1])) as partial:
    print(partial.path.name, flush=True)
    time.sleep(600)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="an open file cannot be removed there")
def test_partial_file_of_other_process_is_kept_until_it_dies(tmp_path: Path):
    command = [sys.executable, "-c", WRITES, str(tmp_path / "picture.png")]
    environ = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environ) as writer:
        assert writer.stdout is not None
        written = writer.stdout.readline().strip()
        try:
            with replacing(tmp_path / "a.png"):
                pass
            assert names(tmp_path) == sorted(["a.png", written])
        finally:
            writer.kill()
    assert written in names(tmp_path), "a killed process removes nothing"
    remove_left_over.cache_clear()
    with replacing(tmp_path / "a.png"):
        pass
    assert names(tmp_path) == ["a.png"]


def receive_signals() -> None:
    """Let a process receive signals, also where the tests were started with them ignored, as by nohup."""
    for name in SIGNALS:
        signal.signal(getattr(signal, name), signal.SIG_DFL)


def begun(folder: Path) -> subprocess.Popen[bytes]:
    """Return a process that draws a large picture, of which the first bytes are there."""
    (folder / "plain.frag").write_text(PLAIN, encoding="utf-8")
    command = [sys.executable, "-m", "playground", "render", "plain.frag"]
    process = subprocess.Popen(
        [*command, "--size", "6000x60000", "-o", "picture.png"],
        cwd=folder, env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=receive_signals,
    )  # fmt: skip
    while process.poll() is None and not any(p.stat().st_size for p in folder.glob(".picture.png.*.part")):
        time.sleep(0.02)
    assert process.poll() is None, process.communicate()
    return process


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals differ there")
@pytest.mark.parametrize("name", SIGNALS)
def test_a_large_picture_that_is_ended_leaves_nothing(tmp_path: Path, name: str):
    process = begun(tmp_path)
    number = getattr(signal, name)
    process.send_signal(number)
    out, err = process.communicate(timeout=120)
    assert (process.returncode, out, err) == (128 + number, b"", b"")
    assert names(tmp_path) == ["plain.frag"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals differ there")
def test_what_a_killed_picture_left_goes_with_the_next(tmp_path: Path):
    process = begun(tmp_path)
    process.kill()
    process.communicate(timeout=120)
    assert len(names(tmp_path)) == 2
    done = subprocess.run(
        [sys.executable, "-m", "playground", "render", "plain.frag", "--size", "4x4", "-o", "picture.png"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert names(tmp_path) == ["picture.png", "plain.frag"]
