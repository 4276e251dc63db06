"""What every command takes: -v tells more, -q less, and -h shows no type of Python's."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from playground import cli
from playground.terminal import Loudness, choose_loudness, complain, loudness, note, with_loudness

KERNEL = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'
TYPES = re.compile(r"<\w+(\|\w+)*>|\b(INTEGER|FLOAT|BOOLEAN|TEXT)\b|\[[\d.]*<?=?x[<>]=?|\bx[<>]=")


def commands(command: Any, name: str = "") -> Iterator[str]:
    yield name
    for child, result in getattr(command, "commands", {}).items():
        yield from commands(result, f"{name} {child}".strip())


ALL = list(commands(cli.command_line()))


@pytest.fixture
def kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "flat.glsl"
    path.write_text(KERNEL)
    return path


@pytest.mark.parametrize("name", ALL)
def test_every_help_has_these_options_and_names_no_type(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("COLUMNS", "100")
    assert cli.main([*name.split(), "-h"]) == 0
    shown = capsys.readouterr().out
    for long, short in (("--verbose", "-v"), ("--quiet", "-q"), ("--help", "-h")):
        assert len(re.findall(rf"{long}\s+{short}\s", shown)) == 1
    result = TYPES.search(shown.replace("--token     TEXT", "").replace("TEXT        The remote's token", ""))
    assert not result, result


@pytest.mark.slow
@pytest.mark.parametrize("order", [["-v", "render"], ["render", "-v"], ["render", "--verbose"]])
def test_verbose_logs_files_driver_compiles_and_caches_with_time(
    order: list[str], kernel: Path, capsys: pytest.CaptureFixture[str]
):
    assert cli.main([*order, str(kernel), "--size", "32x18", "-o", "a.png"]) == 0
    out, err = capsys.readouterr()
    assert out == "a.png\n"
    lines = err.splitlines()
    assert all(re.match(r" *\d+\.\d{3} s  \S", line) for line in lines)
    times = [float(line.split()[0]) for line in lines]
    assert times == sorted(times)
    for part in (r"read flat\.glsl$", r"opened OpenGL \d\.\d: ", r"compiled flat\.glsl \(\w+\) in \d+ ms$"):
        assert len([line for line in lines if re.search(part, line)]) == 1, part
    assert re.search(r"passes ran: .*\bheight 1\b", err) and "from the cache in memory: " in err


def test_it_holds_for_one_command_only(kernel: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["list", "-v", str(kernel)]) == 0
    assert "read flat.glsl" in capsys.readouterr().err
    assert cli.main(["list", str(kernel)]) == 0
    assert "read flat.glsl" not in capsys.readouterr().err
    assert not logging.getLogger("playground").handlers


@pytest.mark.slow
def test_quiet_leaves_what_was_asked_for_and_errors(kernel: Path, capsys: pytest.CaptureFixture[str]):
    kernel.write_text(KERNEL.replace("0.5", "0.0 / float(texel.x * 0)"))
    arguments = ["render", str(kernel), "--size", "32x18", "-o", "a.png"]
    assert cli.main(arguments) == 0
    out, err = capsys.readouterr()
    assert out == "a.png\n" and "NaN" in err  # a note, which shows that there is one to leave out
    assert cli.main([*arguments, "-q"]) == 0
    assert capsys.readouterr() == ("a.png\n", "")
    assert cli.main(["-q", "render", "no-such-sketch"]) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_what_each_loudness_prints(capsys: pytest.CaptureFixture[str]):
    printed = {}
    for chosen in Loudness:
        with with_loudness():
            choose_loudness(chosen)
            complain("an error")
            complain("a warning", "warning")
            note("a note")
            logging.getLogger("playground.sketch.x").debug("a detail")
        printed[chosen] = [line.split()[-1] for line in capsys.readouterr().err.splitlines()]
    assert printed == {
        Loudness.QUIET: ["error"],
        Loudness.DEFAULT: ["error", "warning", "note"],
        Loudness.VERBOSE: ["error", "warning", "note", "detail"],
    }
    assert loudness() is Loudness.DEFAULT


@pytest.mark.room("dialects")
def test_root_opens_a_folder_for_one_command_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    Path("all/a").mkdir(parents=True)
    Path("all/m.glsl").write_text("float level() { return 0.25; }\n")
    text = '#include "../m.glsl"\nvoid main() { gl_FragColor = vec4(level()); }\n'
    Path("all/a/x.frag").write_text(text)
    for words in (["--root", "all", "render"], ["render", "--root", "all"]):
        assert cli.main([*words, "all/a/x.frag", "--size", "8x4", "-o", "x.png"]) == 0
        assert cli.main(["render", "all/a/x.frag", "--size", "8x4", "-o", "x.png"]) == 2
        assert "--root all opens it" in capsys.readouterr().err
    assert cli.main(["pack", "--root", "all", "all/a/x.frag", "-o", "x.zip"]) == 0
    assert cli.main(["render", "x.zip", "--size", "8x4", "-o", "x.png"]) == 0


@pytest.mark.slow
def test_check_takes_the_root_for_a_file_and_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("all/a").mkdir(parents=True)
    Path("all/m.glsl").write_text("float level() { return 0.25; }\n")
    Path("all/a/x.frag").write_text('#include "../m.glsl"\nvoid main() { gl_FragColor = vec4(level()); }\n')
    for path in ("all/a/x.frag", "all/a"):
        assert cli.main(["check", "--root", "all", path]) == 0
        assert cli.main(["check", path]) == 1
