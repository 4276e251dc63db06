"""``playground fly`` as a user meets it: pictures without a window, and mistakes in one message."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from playground import cli
from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.sketch.model import Sketch

from ..sketch_texts import passes

SKETCH = """format = 1
title = "A small endless terrain"
size = 25
extent = 1440.0
relief = 700.0
""" + passes(
    height=("generation/endless", 'set = { apron = 4, hills = 64, "detail.octaves" = 2 }'),
    light="lighting/l_dot_n",
)
HEADER = {
    "format": "playground flight",
    "version": 1,
    "sketch": "terrain.toml",
    "size": [64, 36],
    "step": 1 / 60,
    "radius": 1.5,
    "values": {"height.seed": 9},
    "start": None,
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "terrain.toml").write_text(SKETCH, encoding="utf-8")
    rows = [json.dumps(HEADER), "[20, 50, 10, -30, 0]"]
    (tmp_path / "a.jsonl").write_text("\n".join(rows), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    return tmp_path


def test_a_record_becomes_pictures_whose_paths_are_printed(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    status = cli.main(["fly", "--replay", "a.jsonl", "--frames", "new/pictures", "--every", "10"])
    out, err = capfd.readouterr()
    assert status == 0, err
    names = [f"frame-{n:06d}.png" for n in (0, 10, 20)]
    assert [Path(line).name for line in out.splitlines()] == names
    there = sorted(path.name for path in (folder / "new" / "pictures").iterdir())
    assert there == names, "nothing half written is left"
    pictures = [read_png(folder / "new" / "pictures" / name)[0] for name in names]
    assert all(p.shape == (36, 64, 4) and p[..., :3].std() > 5 for p in pictures)
    assert (pictures[0] != pictures[2]).any()


@pytest.mark.slow
def test_plain_flies_over_the_plain_form_of_every_technique(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The engine is given a sketch that runs no fast variant, and only with --plain."""
    plain: list[bool] = []
    made = Engine.texture

    def texture(self: Engine, sketch: Sketch, *more: Any, **named: Any) -> Any:
        plain.append(sketch.plain)
        return made(self, sketch, *more, **named)

    monkeypatch.setattr(Engine, "texture", texture)
    for words in ([], ["--plain"]):
        plain.clear()
        frames = f"pictures{len(words)}"
        assert cli.main(["fly", "--replay", "a.jsonl", "--frames", frames, "--every", "20", *words]) == 0
        assert plain and set(plain) == {bool(words)}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--record", "b.jsonl", "--replay", "a.jsonl"], "either flown or flown again"),
        (["--frames", "new"], "--frames needs --replay FILE"),
        (["--every", "3"], "--every needs --replay FILE"),
        (["--replay", "a.jsonl", "--every", "3"], "--every needs --frames"),
        (["--replay", "a.jsonl", "--frames", "new", "--every", "0"], "--every 0: expected a whole number"),
        (["--replay", "a.jsonl", "--frames", "new", "--every", "-2"], "--every -2: expected"),
        (["--radius", "40"], "--radius 40: expected a number of parts, 1.5 to 16"),
        (["--radius", "3", "--replay", "a.jsonl"], "cannot change a recorded flight"),
        (["--replay", "none.jsonl"], "none.jsonl: cannot be read"),
        (["--replay", "terrain.toml"], "is no flight"),
        (["--replay", "a.jsonl", "--frames", "terrain.toml"], "is a file; expected a folder"),
        (["--record", "no/such/b.jsonl"], "there is no folder 'no/such'"),
        (["nowhere"], "nowhere"),
        (["--set", "height.sed=3"], "did you mean"),
        (["--size", "3"], "--size 3"),
        ([], "no screen to open a window on"),
    ],
)
def test_a_mistake_is_one_sentence(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    status = cli.main(["fly", *words])
    out, err = capsys.readouterr()
    assert status == 2 and out == "" and message in err
    assert err.startswith("error: ") and "Traceback" not in err
    assert not (folder / "new").exists() or not any((folder / "new").iterdir())


def test_a_sketch_that_has_no_parts_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["fly", "jacksboro", "--replay", "a.jsonl", "--frames", "new", "--set", "relief=500"]
    rows = [json.dumps({**HEADER, "values": {}}), "[1, 0, 0, 0, 0]"]
    (folder / "a.jsonl").write_text("\n".join(rows), encoding="utf-8")
    assert cli.main(words) == 2
    assert "jacksboro cannot be flown over: the technique of its pass 'height'" in capsys.readouterr().err
