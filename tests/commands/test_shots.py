"""``playground shots list``: every shot, its size, and whether a reference is there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from playground import cli
from playground.sketch.find import shipped_sketches

from ..sketch_texts import map_of_height

SKETCH = (
    'format = 1\ntitle = "A slope"\nsize = 33\n'
    + map_of_height("./slope")
    + '[[shot]]\nname = "dark"\nsize = [66, 33]\n[[shot]]\nname = "bright"\n'
)
SLOPE = """// slope.glsl -- a slope that rises to the east.
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x) / float(size.x - 1); }
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make a sketch of two shots: one has references of two renderers, the other has none."""
    (tmp_path / "mine.toml").write_text(SKETCH)
    (tmp_path / "slope.glsl").write_text(SLOPE)
    for name in ("llvmpipe/dark.png", "llvmpipe/dark.2.png", "nvidia/dark.png", "nvidia/dark.old.png"):
        path = tmp_path / "screenshots" / "mine" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_row_says_which_renderers_have_a_reference(mine: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["shots", "list", "mine.toml"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "mine\tdark\t66x33\tllvmpipe (2), nvidia",
        "mine\tbright\t640x360\tmissing",
    ]


def test_json_names_the_files(mine: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["shots", "list", "mine.toml", "--json"]) == 0
    folder = "screenshots/mine"
    assert json.loads(capsys.readouterr().out) == [
        {
            "sketch": "mine",
            "file": "mine.toml",
            "shot": "dark",
            "size": [66, 33],
            "references": {
                "llvmpipe": [f"{folder}/llvmpipe/dark.png", f"{folder}/llvmpipe/dark.2.png"],
                "nvidia": [f"{folder}/nvidia/dark.png"],
            },
        },
        {"sketch": "mine", "file": "mine.toml", "shot": "bright", "size": [640, 360], "references": {}},
    ]


@pytest.mark.slow
def test_without_a_sketch_it_lists_all_that_ship(capsys: pytest.CaptureFixture[str]):
    assert cli.main(["shots", "list"]) == 0
    rows = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    assert sorted({row[0] for row in rows}) == shipped_sketches()
    assert all(row[3] != "missing" for row in rows)


def test_the_group_alone_says_what_there_is(capsys: pytest.CaptureFixture[str]):
    assert cli.main(["shots"]) == 0
    assert "list" in capsys.readouterr().out
