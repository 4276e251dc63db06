"""What the READMEs show is true: their shaders compile, their Python runs, their commands and links exist."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

from playground.cli import app
from playground.engine.engine import Engine
from playground.sketch.load import load

ROOT = Path(__file__).resolve().parent.parent
READMES = (ROOT / "README.md", ROOT / "glsl" / "README.md")
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(language: str) -> list[str]:
    return [
        text for path in READMES for kind, text in BLOCK.findall(path.read_text("utf-8")) if kind == language
    ]


@pytest.mark.parametrize("text", blocks("glsl"), ids=lambda text: text.split("--")[0].strip("/ \n"))
def test_a_shader_runs_by_both_drivers(text: str, engine: Engine, tmp_path: Path):
    kernel = tmp_path / "shown.glsl"
    kernel.write_text(text, encoding="utf-8")
    sketch = load(kernel).with_values({"size": 33})
    picture = engine.render(sketch, size=(64, 36)).array
    assert picture[..., :3].std() > 1


def test_the_first_kernel_fits_the_sketch_that_new_writes(any_engine: Engine, tmp_path: Path):
    """As the README tells it: save waves.glsl, use it, take out the lines that speak of my_land."""
    from playground.templates import make_sketch

    folder = make_sketch(tmp_path / "hills")
    (folder / "waves.glsl").write_text(next(t for t in blocks("glsl") if "waves.glsl" in t), encoding="utf-8")
    text = (folder / "sketch.toml").read_text("utf-8").replace('"./my_land"', '"./waves"')
    text = re.sub(r"\[\[preset\]\]\n.*\n.*\n", "", text)
    assert "frequency" not in text and "preset]]" not in text
    (folder / "sketch.toml").write_text(text, encoding="utf-8")
    sketch = load(folder).with_values({"height.waves": 4.5, "size": 65})
    assert any_engine.render(sketch, size=(64, 36)).array[..., :3].std() > 1


def smaller(text: str) -> str:
    """Return the code with pictures of a quarter of the sides: what runs is the same."""
    return re.sub(r"\((\d{3,4}), (\d{3,4})\)", lambda m: f"({int(m[1]) // 4}, {int(m[2]) // 4})", text)


@pytest.mark.parametrize("text", blocks("python"))
@pytest.mark.slow
def test_python_runs(text: str, tmp_path: Path):
    runs(smaller(text), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("text", blocks("python"))
def test_python_runs_as_it_stands(text: str, tmp_path: Path):
    runs(text, tmp_path)


def runs(text: str, tmp_path: Path) -> None:
    here = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error", "-c", text]
    done = subprocess.run(command, cwd=tmp_path, env=here, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_commands_exist():
    shown = set(
        re.findall(r"(?:playground|\./play) ([a-z]+)", " ".join(path.read_text("utf-8") for path in READMES))
    )
    known = {*get_command(app).commands, "test"}
    assert shown and shown <= known


@pytest.mark.parametrize("readme", READMES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(readme: Path):
    links = re.findall(r"\]\(([^)#:]+)\)", readme.read_text("utf-8"))
    missing = [link for link in links if not (readme.parent / link).exists()]
    assert not missing


def test_the_layout_names_what_is_there():
    text = (ROOT / "README.md").read_text("utf-8")
    layout = text[text.index("playground/     ") : text.index("glsl/           ")]
    for name in re.findall(r"^  (\S+)", layout, re.MULTILINE):
        assert (ROOT / "playground" / name).exists(), name


def test_the_library_names_its_folders():
    text = (ROOT / "glsl" / "README.md").read_text("utf-8")
    there = {path.name for path in (ROOT / "glsl").iterdir() if path.is_dir()}
    table = text[text.index("| folder | holds |") : text.index("## Axes")]
    assert set(re.findall(r"`(\w+)/`", table)) == there
