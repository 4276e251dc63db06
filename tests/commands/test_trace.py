"""`playground trace` as a user meets it: values beside lines, tables of loops, where two runs part."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from playground import cli
from playground.commands.trace import HELP

from ..sketch_texts import map_of, passes

ROOTS = """// roots.glsl -- Newton's square roots of the column, and of a negative row.
#pragma kernel(output = "roots:rg32f")
uniform float begin = 1.0;  //! slider(1, 9)
float step_of(float guess, float of) { return 0.5 * (guess + of / guess); }
vec2 kernel(ivec2 texel) {
    float guess = begin;
    for (int i = 0; i < 4; i++) {
        float before = guess;
        guess = step_of(guess, float(texel.x));
        if (abs(guess - before) < 1e-3) break;
    }
    float bad = sqrt(float(-texel.y));
    return vec2(guess, bad);
}
"""
SKETCH = "format = 1\nsize = 33\n" + passes(roots="./roots") + map_of("roots", channel="red")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "roots.glsl").write_text(ROOTS)
    (tmp_path / "s.toml").write_text(SKETCH)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Return what the command prints."""
    assert cli.main(["trace", "s.toml", "roots", *arguments]) == 0
    return capsys.readouterr().out


def guesses(of: float, begin: float = 1.0) -> list[float]:
    values = [begin]
    for _ in range(4):
        values.append(0.5 * (values[-1] + of / values[-1]))
        if abs(values[-1] - values[-2]) < 1e-3:
            break
    return values[1:]


def test_values_stand_beside_their_lines(capsys: pytest.CaptureFixture[str]) -> None:
    lines = run(capsys, "9", "0", "--loop", "i").splitlines()
    assert "roots" in lines[0] and "(9, 0)" in lines[0] and "bit for bit" in lines[0]
    beside = dict(line.split("│") for line in lines if "│" in line)
    assert len({line.index("│") for line in lines if "│" in line}) == 1
    notes = {code.split(maxsplit=1)[0]: text.strip() for code, text in beside.items()}
    assert notes["5"] == "texel = (9, 0)"
    written = [f"{value:.4g}" for value in guesses(9.0)]
    assert notes["9"] == f"guess = {' | '.join(written)}"
    assert notes["10"] == f"? {'-' * len(written)}"
    assert notes["13"].startswith("→ (") and notes["4"].count("|") == 2 * len(written) - 2 + len(written) - 1
    table = [line.split() for line in lines[lines.index(next(s for s in lines if "loop over i" in s)) + 1 :]]
    assert [row[table[0].index("guess")] for row in table[1:]] == written


def test_numbers_that_are_not_finite_are_marked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = run(capsys, "9", "3").splitlines()
    assert re.search(r"NaN.*bad.*roots\.glsl:12", lines[1])
    assert [line.split()[:2] for line in lines if line.startswith("! ")][1:] == [["!", "12"], ["!", "13"]]
    monkeypatch.setenv("COLUMNS", "72")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    red = [line for line in run(capsys, "9", "3").splitlines() if "\033[1;31m" in line]
    assert len(red) == 3 and all("!" in line for line in red)
    monkeypatch.setenv("NO_COLOR", "1")
    plain = run(capsys, "9", "3").splitlines()
    assert not any("\033[" in line for line in plain)
    assert all(len(line) <= 72 for line in plain if "│" in line)
    assert "guess = 5 | 3.4 | 3.024 | 3" in " ".join(" ".join(plain).split()).replace("│ ", "")


def test_two_runs_part_at_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    text = run(capsys, "9", "0", "--against", "roots.begin=3")
    assert re.search(r"1: roots\.glsl:6.*guess = 1\n", text) and re.search(
        r"2: roots\.glsl:6.*guess = 3\n", text
    )
    assert "different paths" in text and "abs(guess - before) < 1e-3 is true" in text
    text = run(capsys, "9", "0", "--compare", "16", "0")
    first = text[text.index("first value") :].splitlines()
    assert "of = 9" in first[1] and "of = 16" in first[3]  # what the texel itself is counts for nothing
    assert "no recorded value differs" in run(capsys, "9", "0", "--against", "roots.begin=1")


def test_json_has_every_event(capsys: pytest.CaptureFixture[str]) -> None:
    found: dict[str, Any] = json.loads(run(capsys, "9", "3", "--json"))
    assert found["exact"] and found["texel"] == [9, 3]
    events = [event for event in found["events"] if event["name"] == "guess" and event["kind"] == "set"]
    assert [event["value"] for event in events][1:] == pytest.approx(guesses(9.0), rel=1e-6)
    assert [event["iterations"] for event in events][1:] == [[0], [1], [2], [3]]
    bad = [event["value"] for event in found["events"] if event["name"] == "bad"]
    assert bad == ["NaN"]
    assert [call["function"] for call in found["calls"]] == ["kernel", *["step_of"] * 4]


def test_the_help_has_examples() -> None:
    assert all(f"{option}" in HELP for option in ("--loop", "--compare", "--against", "--json", "--function"))
