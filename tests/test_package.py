"""What a user installs: the wheel carries the GLSL library and renders in an empty environment."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from playground.images.files import read_png

ROOT = Path(__file__).resolve().parent.parent

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", str(ROOT), "--no-deps", "--wheel-dir", str(folder)]
    made = subprocess.run(command, capture_output=True, text=True, timeout=300)
    _need_network(made)
    return next(folder.glob("*.whl"))


def _need_network(result: subprocess.CompletedProcess[str]) -> None:
    offline = (
        "NewConnectionError",
        "No matching distribution",
        "Could not find a version",
        "Temporary failure",
    )
    if result.returncode and any(word in result.stderr for word in offline) and not os.environ.get("CI"):
        pytest.skip("no package registry can be reached")
    assert result.returncode == 0, result.stderr[-2000:]


def test_the_wheel_carries_every_file_of_the_library(wheel: Path):
    inside = set(zipfile.ZipFile(wheel).namelist())
    glsl = [p for p in (ROOT / "glsl").rglob("*") if p.is_file()]
    assert len(glsl) > 20
    for path in glsl:
        assert f"playground/{path.relative_to(ROOT).as_posix()}" in inside
    assert "playground/py.typed" in inside
    page = [p for p in (ROOT / "playground/shots/page").iterdir() if p.is_file()]
    assert {"report.html", "report.css", "viewer.js"} <= {path.name for path in page}
    for path in page:
        assert f"playground/shots/page/{path.name}" in inside
    shaders = list((ROOT / "playground/gpu/shaders").iterdir())
    assert shaders and inside >= {f"playground/gpu/shaders/{path.name}" for path in shaders}
    web = {name for name in inside if name.startswith("playground/web/") and not name.endswith(".py")}
    bundles = {f"playground/web/bundle/{path.name}" for path in (ROOT / "playground/web/bundle").glob("*")}
    assert bundles and web == bundles
    tables = list((ROOT / "playground/sketch").glob("*.toml"))
    assert tables and inside >= {f"playground/sketch/{path.name}" for path in tables}
    assert not [name for name in inside if name.startswith(("tests/", "screenshots/"))]


def test_an_empty_environment_renders_the_default_sketch(wheel: Path, tmp_path: Path):
    home = tmp_path / "home"
    home.mkdir()
    environment = tmp_path / "env"
    venv.create(environment, with_pip=True)
    scripts = environment / ("Scripts" if os.name == "nt" else "bin")
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PLAYGROUND"))} | {
        "HOME": str(home)
    }
    _need_network(
        subprocess.run(
            [str(scripts / "python"), "-m", "pip", "install", "-q", str(wheel)],
            capture_output=True,
            text=True,
            env=clean,
            timeout=600,
        )
    )
    picture = tmp_path / "terrain.png"
    done = subprocess.run(
        [str(scripts / "playground"), "render", "-o", str(picture), "--size", "320x180"],
        capture_output=True,
        text=True,
        env=clean,
        cwd=tmp_path,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    array, _ = read_png(picture)
    assert array.shape == (180, 320, 4)
    assert array[..., :3].std() > 10
