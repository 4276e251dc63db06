"""Standard streams of every kind: encodings that lack characters, closed ones, pipes without a reader."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from playground.cli import main
from playground.streams import open_streams

from .sketch_texts import map_of_height

ROOT = Path(__file__).resolve().parent.parent
PLAIN = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(0.5); }\n"
KERNEL = '#pragma kernel(output = "value:r32f")\nfloat kernel(ivec2 texel) { return 2.0; }\n'
SKETCH = "format = 1\nsize = 5\n" + map_of_height("./a")


@pytest.fixture
def start(tmp_path: Path):
    """Run the command in a process of its own; ``shell`` is what a shell's user would write after it."""
    (tmp_path / "läñd.frag").write_text(PLAIN, encoding="utf-8")

    def started(*arguments: str, shell: str = "", **environ: str) -> subprocess.CompletedProcess[bytes]:
        clean = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        command = [sys.executable, "-m", "playground", *arguments]
        if shell:
            command = ["sh", "-c", f'"$@" {shell}', "sh", *command]
        variables = clean | {"PYTHONPATH": str(ROOT)} | environ
        return subprocess.run(command, cwd=tmp_path, env=variables, capture_output=True, timeout=180)

    return started


# ── encodings ────────────────────────────────────────────────────────────────


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Run the command here, with standard streams of an encoding as Python opens them."""
    (tmp_path / "läñd.frag").write_text(PLAIN, encoding="utf-8")
    monkeypatch.chdir(tmp_path)

    def called(encoding: str, *arguments: str) -> subprocess.CompletedProcess[bytes]:
        streams = [io.TextIOWrapper(io.BytesIO(), encoding, how) for how in ("strict", "backslashreplace")]
        for name, stream in zip(("stdout", "stderr"), streams, strict=True):
            monkeypatch.setattr(sys, name, stream)
        status = main(arguments)
        return subprocess.CompletedProcess(arguments, status, *(s.buffer.getvalue() for s in streams))

    return called


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_what_an_encoding_lacks_is_spelled(run, encoding: str):
    done = run(encoding, "list", "jacksboro")
    assert (done.returncode, done.stderr) == (0, b"")
    value = done.stdout.decode(encoding)
    assert "height.elevation" in value and "\\x" not in value and "\\u" not in value
    written = run(encoding, "render", "läñd.frag", "--size", "4x4")
    assert written.returncode == 0 and b"Traceback" not in written.stderr
    assert written.stdout.decode(encoding) == ("land.png\n" if encoding == "ascii" else "läñd.png\n")
    missing = run(encoding, "render", "→")
    assert missing.returncode == 2 and b"->" in missing.stderr and b"Traceback" not in missing.stderr


@pytest.mark.slow
def test_json_in_another_encoding_is_the_same_json(run, start):
    plain = start("list", "soft_cone", "--json", PYTHONIOENCODING="ascii")  # in a process of its own for once
    whole = run("utf-8", "list", "soft_cone", "--json")
    assert plain.returncode == whole.returncode == 0, plain.stderr
    assert json.loads(plain.stdout.decode("ascii")) == json.loads(whole.stdout.decode("utf-8"))
    assert any(ord(c) > 127 for c in whole.stdout.decode("utf-8"))


def test_a_name_that_is_no_text_keeps_its_bytes():
    open_streams()  # registers the handler
    assert "a\udcff → é✓".encode("ascii", "playground.spelled") == b"a\xff -> e\\u2713"
    assert "a\udcff".encode("utf-8", "playground.spelled") == b"a\xff"
    assert "½ ﬁ Δ".encode("latin-1", "playground.spelled") == "½ fi \\u0394".encode("latin-1")


# ── closed streams ───────────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell that closes streams")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_closed_stream_changes_no_outcome(start, tmp_path: Path, closed: str):
    for arguments, status in (
        (("--help",), 0),
        (("nosuch",), 2),
        (("render", "läñd.frag", "-o", "a.png", "--size", "4x4", "--profile"), 0),
    ):
        done = start(*arguments, shell=closed)
        assert done.returncode == status and b"Traceback" not in done.stderr + done.stdout, done
        # A mistake's sentence goes where it belongs or nowhere: never into the answer.
        assert not re.search(rb"^error: ", done.stdout, re.MULTILINE)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell that closes streams")
def test_a_picture_for_a_closed_standard_output_is_refused(start):
    done = start("render", "läñd.frag", "-o", "-", shell=">&-")
    assert done.returncode == 2
    assert done.stderr == b"error: -o - writes a PNG to standard output, which is closed; redirect it\n"


# ── pipes without a reader ──────────────────────────────────────────────────


def broken_pipe() -> int:
    read_end, write_end = os.pipe()
    os.close(read_end)
    return write_end


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "status"),
    [(["--help"], 141), (["list", "lighting"], 141), (["nosuch"], 2)],
)
def test_a_reader_that_leaves_is_no_mistake(tmp_path: Path, arguments: list[str], status: int):
    for both in (False, True):
        gone = broken_pipe()
        done = subprocess.run(
            [sys.executable, "-m", "playground", *arguments],
            cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, timeout=180,
            stdout=gone, stderr=gone if both else subprocess.PIPE,
        )  # fmt: skip
        os.close(gone)
        assert done.returncode == status
        assert both or (done.stderr == b"") == (status == 141)


@pytest.mark.slow
def test_notes_without_a_reader_do_not_end_a_command(tmp_path: Path):
    (tmp_path / "a.glsl").write_text(f"// a.glsl -- beyond 1, which is clamped\n{KERNEL}", encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    gone = broken_pipe()
    done = subprocess.run(
        [sys.executable, "-m", "playground", "render", "sketch.toml", "--texture", "height", "-o", "a.png"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, timeout=180,
        stdout=subprocess.PIPE, stderr=gone,
    )  # fmt: skip
    os.close(gone)
    assert (done.returncode, done.stdout) == (0, b"a.png\n")
    assert (tmp_path / "a.png").is_file()
