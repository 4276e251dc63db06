"""What a user installs: the wheel carries the GLSL library and renders in an empty environment."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from playground.data.image_files import read_png

ROOT = Path(__file__).resolve().parent.parent

MAX_BYTES = 12_000_000  # of a wheel or a source distribution; the library's measured land is 1.5 MB of it

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the wheel, made from the source distribution, which is next to it."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)]
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
    page = [p for p in (ROOT / "playground/verify/shots/page").iterdir() if p.is_file()]
    assert {"report.html", "report.css", "viewer.js"} <= {path.name for path in page}
    for path in page:
        assert f"playground/verify/shots/page/{path.name}" in inside
    shaders = list((ROOT / "playground/shader/shaders").iterdir())
    assert shaders and inside >= {f"playground/shader/shaders/{path.name}" for path in shaders}
    web = {name for name in inside if name.startswith("playground/publish/web/") and not name.endswith(".py")}
    bundles = {
        f"playground/publish/web/bundle/{path.name}"
        for path in (ROOT / "playground/publish/web/bundle").glob("*")
    }
    assert bundles and web == bundles
    tables = list((ROOT / "playground/sketch").glob("*.toml"))
    assert tables and inside >= {f"playground/sketch/{path.name}" for path in tables}
    assert not [name for name in inside if name.startswith(("tests/", "screenshots/"))]


@pytest.mark.parametrize(
    "check",
    [("twine", "check", "--strict"), ("check_wheel_contents", "--config", str(ROOT / "pyproject.toml"))],
)
def test_wheel_and_sdist_pass_publication_checks(wheel: Path, check: tuple[str, ...]):
    files = [wheel, next(wheel.parent.glob("*.tar.gz"))] if check[0] == "twine" else [wheel]
    assert max(file.stat().st_size for file in files) < MAX_BYTES
    done = subprocess.run(
        [sys.executable, "-m", *check, *map(str, files)], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_empty_environment_renders_the_default_sketch(wheel: Path, tmp_path: Path):
    home = tmp_path / "home"
    home.mkdir()
    environment = tmp_path / "env"
    venv.create(environment, with_pip=True)
    scripts = environment / ("Scripts" if os.name == "nt" else "bin")
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PLAYGROUND", "DISPLAY"))} | {
        "HOME": str(home),
        "PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}",
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
    for command in readme_commands():
        done = subprocess.run(
            shlex.split(command), capture_output=True, text=True, env=clean, cwd=tmp_path, timeout=120
        )
        needs_a_screen = "There is no screen" in done.stderr and done.returncode == 2
        assert done.returncode == 0 or needs_a_screen, f"{command}: {done.stderr}"
    lacking = [str(scripts / "playground"), "lsp"]
    done = subprocess.run(lacking, capture_output=True, text=True, env=clean, cwd=tmp_path, timeout=120)
    command = done.stderr.strip().partition("needs pygls: ")[2]
    _need_network(subprocess.run(command, shell=True, capture_output=True, text=True, env=clean, timeout=600))
    installed = [str(scripts / "python"), "-c", "import pygls"]
    assert command and subprocess.run(installed, env=clean, cwd=tmp_path, timeout=120).returncode == 0
    for number, text in enumerate(readme_blocks("python")):
        (tmp_path / f"snippet_{number}.py").write_text(text, encoding="utf-8")
        words = [str(scripts / "python"), f"snippet_{number}.py"]
        done = subprocess.run(words, capture_output=True, text=True, env=clean, cwd=tmp_path, timeout=120)
        assert done.returncode == 0, f"{text}: {done.stderr}"


def readme_blocks(language: str) -> list[str]:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def readme_commands() -> list[str]:
    """Return the commands of README.md that are the playground's, as one types them without a checkout."""
    lines = [line.partition("  #")[0].strip() for block in readme_blocks("sh") for line in block.splitlines()]
    names = [re.sub(r"^\./play\b", "playground", line) for line in lines]
    names = [line for line in names if re.match(r"playground(?! (?:test|add)\b)", line)]
    assert {"playground new hills", "playground render hills -o hills.png"} <= set(names)
    return names
