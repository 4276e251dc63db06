"""What the documentation shows is true: its shaders compile, its sketches load, its Python runs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from playground.engine.engine import Engine
from playground.sketch.load import load
from playground.sketch.templates import make_sketch

from .pages import PAGES, ROOT, Block, blocks, blocks_of, files, write_files

SKETCHES = sorted(title for title in files() if title.endswith("/sketch.toml"))
IN_A_SKETCH = tuple(title.removesuffix("sketch.toml") for title in SKETCHES)


def by_name(block: object) -> str | None:
    return block.name if isinstance(block, Block) else None


ALONE = [b for b in blocks("glsl") if not b.title.startswith(IN_A_SKETCH)]


def test_there_is_something_to_run():
    assert len(ALONE) >= 4 and len(SKETCHES) >= 3 and len(blocks("python")) >= 4 and len(blocks("sh")) >= 30


def test_blocks_that_are_not_run_are_few_and_say_why():
    left_out = [b for page in PAGES for b in blocks_of(page) if b.reason]
    assert len(left_out) <= 10, [f"{b.name}: {b.reason}" for b in left_out]
    assert all(len(b.reason.split()) > 2 for b in left_out)


@pytest.mark.parametrize("block", ALONE, ids=by_name)
def test_a_shader_runs_by_both_drivers(block: Block, engine: Engine, tmp_path: Path):
    kernel = tmp_path / (Path(block.title).name or "shown.glsl")
    kernel.write_text(block.text, encoding="utf-8")
    for image in re.findall(r'//! file\("([^"]+)"', block.text):
        Image.fromarray(np.arange(64, dtype=np.uint8).reshape(8, 8) * 4).save(tmp_path / image)
    sketch = load(kernel)
    if "#version" not in block.text:
        sketch = sketch.with_values({"size": 33})
    picture = engine.render(sketch, size=(64, 36)).array
    assert picture[..., :3].std() > 1


@pytest.mark.parametrize("title", SKETCHES)
def test_a_sketch_of_a_page_runs_by_both_drivers(title: str, engine: Engine, tmp_path: Path):
    folder = title.partition("/")[0]
    make_sketch(tmp_path / folder)
    write_files(tmp_path, folder)
    sketch = load(tmp_path / folder)
    for shot in sketch.shots:
        shown = sketch.for_shot(shot).with_values({"size": 65})
        assert engine.render(shown, size=(64, 36)).array[..., :3].std() > 1


@pytest.mark.parametrize("block", blocks("toml"), ids=by_name)
def test_toml_is_toml(block: Block):
    assert tomllib.loads(block.text)


@pytest.mark.parametrize("block", blocks("yaml"), ids=by_name)
def test_yaml_is_yaml(block: Block):
    assert yaml.safe_load(block.text)


@pytest.mark.slow
def test_the_first_kernel_fits_the_sketch_that_new_writes(any_engine: Engine, tmp_path: Path):
    """As the README says: save waves.glsl, use it, add a tilt; the preset of my_land is warned of."""
    folder = make_sketch(tmp_path / "hills")
    write_files(tmp_path, "hills/waves.glsl")
    text = (folder / "sketch.toml").read_text("utf-8").replace('"./my_land"', '"./waves"')
    (folder / "sketch.toml").write_text(text, encoding="utf-8")
    assert all(w.message.startswith("preset 'calm' leaves out height.") for w in load(folder).warnings)
    sketch = load(folder).with_values({"height.waves": 4.5, "size": 65})
    before = any_engine.read(sketch, "height")
    assert any_engine.render(sketch, size=(64, 36)).array[..., :3].std() > 1

    readme = (ROOT / "README.md").read_text("utf-8")
    (tilt,) = re.findall(r"`(uniform float tilt [^`]*)`", readme)
    kernel = (folder / "waves.glsl").read_text("utf-8")
    kernel = kernel.replace("float kernel", f"{tilt}\n\nfloat kernel")
    kernel = kernel.replace("return 0.5", "return tilt * place.x + 0.5")
    (folder / "waves.glsl").write_text(kernel, encoding="utf-8")
    tilted = load(folder).with_values({"height.waves": 4.5, "height.tilt": 1.0, "size": 65})
    rise = any_engine.read(tilted, "height") - before
    np.testing.assert_allclose(rise, np.broadcast_to(np.linspace(0, 1, 65), (65, 65)), atol=1e-6)


def smaller(text: str) -> str:
    """Return the code with pictures of a quarter of the sides: what runs is the same."""
    return re.sub(r"\((\d{3,4}), (\d{3,4})\)", lambda m: f"({int(m[1]) // 4}, {int(m[2]) // 4})", text)


PYTHON = [b for b in blocks("python") if not b.title]


@pytest.mark.parametrize("block", PYTHON, ids=by_name)
@pytest.mark.slow
def test_python_runs(block: Block, tmp_path: Path):
    runs(smaller(block.text), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("block", PYTHON, ids=by_name)
def test_python_runs_as_it_is_written(block: Block, tmp_path: Path):
    runs(block.text, tmp_path)


def runs(text: str, tmp_path: Path) -> None:
    here = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error", "-c", text]
    done = subprocess.run(command, cwd=tmp_path, env=here, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("block", [b for b in blocks("python") if b.title.startswith("test_")], ids=by_name)
def test_a_test_in_python_passes_once_its_reference_is_there(block: Block, tmp_path: Path):
    make_sketch(tmp_path / "hills")
    for title in (block.title, block.title.removeprefix("test_")):  # with the program that it tests
        write_files(tmp_path, title)
    statuses = []
    for more in ([], ["--shots-update"], []):
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", block.title, *more]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        statuses.append(done.returncode)
    assert statuses[0] == 1 and statuses[-1] == 0, (statuses, done.stdout)
