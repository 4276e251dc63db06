"""Fast variants on the command line: what is printed, ``--plain``, and the commands that verify them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.data.image_files import read_png
from playground.paths import GLSL
from playground.sketch.find import shipped_sketches
from playground.sketch.variants import NAME

from .sketch_texts import map_of_height, passes
from .variants import trust

KERNEL = """// terrain.glsl -- a slope.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the eastern edge is
float kernel(ivec2 texel) { return rise * float(texel.x) / float(size.x - 1); }
"""
FAST = 'agrees = "1e-6"\n' + passes(height="./same") + '[parameters]\nrise = "height.rise"\n'
SKETCH = "format = 1\nsize = 33\n" + map_of_height(channel="red")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sketch whose kernel has a fast variant, verified; the current folder holds its folder."""
    folder = tmp_path / "terrain"
    folder.mkdir()
    for name, text in {"terrain.glsl": KERNEL, "same.glsl": KERNEL, "terrain.fast.toml": FAST}.items():
        (folder / name).write_text(text)
    (folder / "sketch.toml").write_text(SKETCH)
    trust(folder)
    monkeypatch.chdir(tmp_path)
    return folder


def drawn(capsys: pytest.CaptureFixture[str], *more: str) -> tuple[np.ndarray, list[str]]:
    """Return the picture, and the lines on standard error."""
    assert main(["render", "terrain", "-o", "terrain.png", "--size", "64x48", *more]) == 0
    return read_png(Path("terrain.png"))[0], capsys.readouterr().err.splitlines()


def test_edited_kernel_shows_and_reports_left_out_variant(folder, capsys):
    before, notes = drawn(capsys)
    assert notes == []
    (folder / "terrain.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    after, notes = drawn(capsys)
    assert (after != before).any()
    (line,) = notes
    assert line.startswith(
        "note: terrain.fast.toml is left out, the plain form runs: terrain.glsl has changed"
    )
    again, notes = drawn(capsys, "--plain")
    np.testing.assert_array_equal(again, after)
    assert notes == []


@pytest.mark.slow
def test_check_says_it_and_tries_it_all_the_same(folder, capsys):
    (folder / "terrain.glsl").write_text(KERNEL.replace("rise *", "0.2 * rise *"))
    assert main(["check", "--json", "terrain"]) == 0
    reports = {Path(r["path"]).name: r for r in map(json.loads, capsys.readouterr().out.splitlines())}
    assert set(reports) == {"terrain.glsl", "same.glsl", "terrain.fast.toml", "sketch.toml"}
    noted = {name for name, report in reports.items() if report["notes"]}
    assert noted == {"terrain.glsl", "terrain.fast.toml", "sketch.toml"}
    (folder / "same.glsl").write_text(KERNEL.replace("rise *", "nonsense *"))
    assert main(["check", "terrain/terrain.fast.toml"]) == 1
    assert "nonsense" in capsys.readouterr().out
    assert main(["check", "--plain", "terrain/terrain.glsl", "terrain/sketch.toml"]) == 0
    assert "note" not in capsys.readouterr().out


def test_renew_records_agreeing_variants_and_refuses_rest(folder, capsys):
    (folder / NAME).unlink()
    assert main(["variants", "list", "terrain"]) == 0
    assert "never verified" in capsys.readouterr().out
    assert main(["variants", "verify", "terrain"]) == 0
    assert "ok      terrain/terrain.fast.toml: height" in capsys.readouterr().out
    assert not (folder / NAME).exists(), "verify writes nothing"
    assert main(["variants", "renew", "terrain/terrain.fast.toml"]) == 0
    assert str(folder / NAME) in capsys.readouterr().out and (folder / NAME).exists()
    assert drawn(capsys)[1] == []
    (folder / "same.glsl").write_text(KERNEL.replace("rise *", "0.9 * rise *"))
    assert main(["variants", "renew", "terrain"]) == 1
    out = capsys.readouterr().out
    assert (
        "FAILED  terrain/terrain.fast.toml: height differs by" in out and "1 variant of 1 not verified" in out
    )
    assert json.loads((folder / NAME).read_text())["variants"] == {}


@pytest.mark.slow
def test_variants_that_ship_are_named_as_techniques_are(capsys):
    assert main(["variants", "list", "generation/fault_formation", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["variant"].rpartition("/")[2] for row in rows] == ["sum.comp", "sum.fast.toml"]
    assert main(["variants", "list", "glsl/generation/fourier.comp"]) == 0
    assert "fourier.comp" in capsys.readouterr().out


@pytest.mark.slow
def test_every_shipped_sketch_runs_its_fast_variants():
    """None of those that ship is left out: the record is that of the texts."""
    from playground.sketch.load import load_with
    from playground.sketch.techniques import Techniques
    from playground.sketch.variants import unverified

    assert (GLSL / NAME).is_file()
    reader = Techniques()
    assert {name: unverified(load_with(reader, name)) for name in shipped_sketches()} == dict.fromkeys(
        shipped_sketches(), ()
    )


@pytest.mark.slow
def test_technique_with_own_folder_is_selected_by_its_name(capsys):
    assert main(["variants", "list", "generation/diamond_square"]) == 0
    assert "generation/diamond_square.comp" in capsys.readouterr().out
    assert main(["variants", "list", "glsl/generation/fourier"]) == 0
    assert "generation/fourier.comp" in capsys.readouterr().out
