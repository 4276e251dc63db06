"""Fast variants on the command line: what is said, ``--plain``, and the commands that verify them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.images.files import read_png
from playground.paths import GLSL
from playground.sketch.find import shipped_sketches
from playground.sketch.variant_record import NAME

from .sketch_texts import map_of_height
from .variants import trust

KERNEL = """// land.glsl -- a slope.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the eastern edge is
float kernel(ivec2 texel) { return rise * float(texel.x) / float(size.x - 1); }
"""
FAST = """agrees = "1e-6"
[[pass]]
name = "height"
use = "./same"
[parameters]
rise = "height.rise"
"""
SKETCH = "format = 1\nsize = 33\n" + map_of_height(channel="red")


@pytest.fixture
def land(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sketch whose kernel has a fast variant, verified; the current folder is beside it."""
    folder = tmp_path / "land"
    folder.mkdir()
    for name, text in {"land.glsl": KERNEL, "same.glsl": KERNEL, "land.fast.toml": FAST}.items():
        (folder / name).write_text(text)
    (folder / "sketch.toml").write_text(SKETCH)
    trust(folder)
    monkeypatch.chdir(tmp_path)
    return folder


def drawn(capsys: pytest.CaptureFixture[str], *more: str) -> tuple[np.ndarray, list[str]]:
    """Return the picture, and the lines on standard error."""
    assert main(["render", "land", "-o", "land.png", "--size", "64x48", *more]) == 0
    return read_png(Path("land.png"))[0], capsys.readouterr().err.splitlines()


def test_an_edit_changes_the_picture_and_one_line_says_what_does_not_run(land, capsys):
    before, said = drawn(capsys)
    assert said == []
    (land / "land.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    after, said = drawn(capsys)
    assert (after != before).any()
    (line,) = said
    assert line.startswith("note: land.fast.toml is left out, the plain form runs: land.glsl has changed")
    again, said = drawn(capsys, "--plain")
    np.testing.assert_array_equal(again, after)
    assert said == []


def test_check_says_it_and_tries_it_all_the_same(land, capsys):
    (land / "land.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    assert main(["check", "--json", "land"]) == 0
    reports = {Path(r["path"]).name: r for r in map(json.loads, capsys.readouterr().out.splitlines())}
    assert set(reports) == {"land.glsl", "same.glsl", "land.fast.toml", "sketch.toml"}
    told = {name for name, report in reports.items() if report["notes"]}
    assert told == {"land.glsl", "land.fast.toml", "sketch.toml"}
    (land / "same.glsl").write_text(KERNEL.replace("rise *", "nonsense *"))
    assert main(["check", "land/land.fast.toml"]) == 1
    assert "nonsense" in capsys.readouterr().out
    assert main(["check", "--plain", "land/land.glsl", "land/sketch.toml"]) == 0
    assert "note" not in capsys.readouterr().out


def test_renew_records_what_agrees_beside_it_and_refuses_the_rest(land, capsys):
    (land / NAME).unlink()
    assert main(["variants", "list", "land"]) == 0
    assert "never verified" in capsys.readouterr().out
    assert main(["variants", "verify", "land"]) == 0
    assert "ok      land/land.fast.toml: height" in capsys.readouterr().out
    assert not (land / NAME).exists(), "verify writes nothing"
    assert main(["variants", "renew", "land/land.fast.toml"]) == 0
    assert str(land / NAME) in capsys.readouterr().out and (land / NAME).exists()
    assert drawn(capsys)[1] == []
    (land / "same.glsl").write_text(KERNEL.replace("rise *", "0.9 * rise *"))
    assert main(["variants", "renew", "land"]) == 1
    out = capsys.readouterr().out
    assert "FAILED  land/land.fast.toml: height differs by" in out and "1 variant of 1 not verified" in out
    assert json.loads((land / NAME).read_text())["variants"] == {}


def test_variants_that_ship_are_named_as_techniques_are(capsys):
    assert main(["variants", "list", "generation/fault_formation", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["variant"].rpartition("/")[2] for row in rows] == ["sum.comp", "sum.fast.toml"]
    assert main(["variants", "list", "glsl/generation/fourier.comp"]) == 0
    assert "fourier.comp" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("generation/forrier", "there is no file and no technique 'generation/forrier'; did you mean"),
        ("generation/white_noise", "there is no fast variant in generation/white_noise"),
    ],
)
def test_nothing_to_verify_is_a_sentence(capsys, what, words):
    assert main(["variants", "verify", what]) == 2
    assert words in capsys.readouterr().err


def test_every_shipped_sketch_runs_its_fast_variants():
    """None of those that ship is left out: the record is that of the texts."""
    from playground.sketch.load import load_with
    from playground.sketch.techniques import Techniques
    from playground.sketch.variants import left_out

    assert (GLSL / NAME).is_file()
    reader = Techniques()
    assert {name: left_out(load_with(reader, name)) for name in shipped_sketches()} == dict.fromkeys(
        shipped_sketches(), ()
    )


def test_a_technique_that_has_a_folder_of_its_own_is_meant_by_its_name(capsys):
    assert main(["variants", "list", "generation/diamond_square"]) == 0
    assert "generation/diamond_square.comp" in capsys.readouterr().out
    assert main(["variants", "list", "glsl/generation/fourier"]) == 0
    assert "generation/fourier.comp" in capsys.readouterr().out
