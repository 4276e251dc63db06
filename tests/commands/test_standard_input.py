"""``-`` as a sketch: a shader's text from standard input is kept as a file, and read from there."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from playground import cli
from playground.commands.standard_input import kept
from playground.data.image_files import read_png
from playground.errors import ParameterError

SHADER = "// Half red\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(0.5, 0.0, 0.0, 1.0); }\n"


class Input(io.TextIOWrapper):
    def __init__(self, data: bytes, *, terminal: bool = False) -> None:
        super().__init__(io.BytesIO(data), "utf-8")
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def given(monkeypatch: pytest.MonkeyPatch, data: bytes, *, terminal: bool = False) -> None:
    monkeypatch.setattr("sys.stdin", Input(data, terminal=terminal))


@pytest.mark.room("dialects")
def test_a_text_is_rendered_and_kept(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(monkeypatch, SHADER.encode())
    assert cli.main(["render", "-", "--size", "8x8"]) == 0
    said = capsys.readouterr()
    assert said.out == "half_red.png\n" and "kept as half_red.frag" in said.err
    assert (here / "half_red.frag").read_text("utf-8") == SHADER
    assert tuple(read_png(here / "half_red.png")[0][0, 0, :3]) == (128, 0, 0)


@pytest.mark.slow
def test_a_mistake_is_reported_at_its_line_of_the_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(monkeypatch, SHADER.replace("0.5", "wrong").encode())
    assert cli.main(["check", "-"]) == 1
    assert "half_red.frag:2" in capsys.readouterr().out


@pytest.mark.parametrize(
    "data, part",
    [
        (b"", "standard input: there is no text to open"),
        (b"no shader", "standard input: nothing to run"),
        (b"\xff\xfe\x00", "standard input is no UTF-8 text"),
        (b" " * 5_000_000, "standard input is larger than 4 MiB"),
    ],
)
def test_what_is_no_shader_is_one_sentence(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], data: bytes, part: str
) -> None:
    given(monkeypatch, data)
    assert cli.main(["render", "-"]) == 2
    said = capsys.readouterr().err
    assert part in said and said.count("\n") == 1 and list(here.iterdir()) == []


@pytest.mark.room("dialects")
def test_a_terminal_is_no_text_but_the_window_has_the_clipboard(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(monkeypatch, b"", terminal=True)
    with pytest.raises(ParameterError, match="standard input is the terminal"):
        kept("-", "render")
    assert kept("-", "live", lambda: SHADER) == str(here / "half_red.frag")
    assert "the text of the clipboard is kept as half_red.frag" in capsys.readouterr().err
    assert kept("jacksboro", "live") == "jacksboro"
