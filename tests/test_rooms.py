"""Each room above the core can be removed: its folder, its tests, and one line of ``rooms.ROOMS``."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from playground.rooms import ROOMS

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "playground"
COMMANDS = {"course": {"lesson"}, "dialects": set[str](), "flight": {"fly"}, "lsp": {"lsp"}}
SKETCHES = {"dialects": ("channels", "flood", "from_elsewhere")}  # they use shaders of other tools
ROW = re.compile(r"^│ (\w+) {2,}", re.MULTILINE)
NAMES = list(ROOMS)
CORE_TESTS = (
    "tests/sketch/test_load.py",
    "tests/shader/test_outline.py",
    "tests/data/test_resample.py",
    "tests/studio/live/test_escape_layers.py",  # a panel of a window, without a screen
    "tests/studio/live/test_keys.py",
    "tests/studio/workbench/test_pasted.py",
)


@pytest.mark.parametrize("room", NAMES)
def test_nothing_outside_of_a_room_names_it(room):
    naming = [
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if path.relative_to(PACKAGE).parts[0] not in (room, "web")
        and re.search(rf"playground[./]{room}\b|from playground import .*\b{room}\b", path.read_text("utf-8"))
    ]
    assert not naming, "the registry has its name, and nothing its modules"


def commands(folder: Path) -> set[str]:
    done = run(folder, "-m", "playground", "--help")
    assert done.returncode == 0, done.stderr
    return set(ROW.findall(done.stdout))


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "80", "NO_COLOR": "1"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True
    )


@pytest.fixture
def without(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Give a checkout without a room, its tests, its sketches and its line."""
    room = request.param
    shutil.copytree(
        PACKAGE, tmp_path / "playground", ignore=shutil.ignore_patterns("node_modules", "__pycache__", room)
    )
    shutil.copytree(
        ROOT / "tests", tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__", "screenshots", room)
    )
    for name in ("docs", "pyproject.toml"):
        (tmp_path / name).symlink_to(ROOT / name)
    its = [name for sketch in SKETCHES.get(room, ()) for name in (sketch, f"{sketch}.toml")]
    shutil.copytree(ROOT / "glsl", tmp_path / "glsl", ignore=shutil.ignore_patterns(*its))
    registry = tmp_path / "playground" / "rooms.py"
    text, count = re.subn(rf'^    "{room}": .*\n', "", registry.read_text("utf-8"), flags=re.MULTILINE)
    assert count == 1
    registry.write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("without", NAMES, indirect=True)
def test_everything_else_works_without_a_room(without):
    (room,) = {*NAMES} - {p.name for p in (without / "playground").iterdir()}
    assert commands(without) == commands(ROOT) - COMMANDS[room]
    modules = [
        ".".join(path.relative_to(without).with_suffix("").parts)
        for path in sorted((without / "playground").rglob("*.py"))
        if "templates" not in path.parts and path.stem not in ("__main__", "conftest")
    ]
    code = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)\n"
    done = run(without, "-c", code + "import playground; print(playground.__file__)", *modules)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(without / "playground" / "__init__.py")
    picture = run(without, "-m", "playground", "render", "l_dot_n", "--size", "32x18", "-o", "p.png")
    assert picture.returncode == 0 and (without / "p.png").is_file(), picture.stderr
    core = run(without, "-m", "pytest", "-q", "-p", "no:cacheprovider", *CORE_TESTS)
    assert core.returncode == 0, core.stdout


@pytest.mark.slow
@pytest.mark.parametrize("without", ["dialects"], indirect=True)
def test_without_dialects_another_tool_s_text_has_nothing_to_run(without):
    texts = {
        "toy.frag": "void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n",
        "isf.fs": '/*{"ISFVSN": "2"}*/\nvoid main() { gl_FragColor = vec4(1.0); }\n',
        "none.frag": "float twice(float x) { return 2.0 * x; }\n",
    }
    for name, text in texts.items():
        (without / name).write_text(text, encoding="utf-8")
        done = run(without, "-m", "playground", "render", name, "--size", "8x8", "-o", "p.png")
        assert done.returncode == 2, done.stderr
        assert "nothing to run: no main, mainImage or #pragma kernel" in done.stderr
    plain = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }\n"
    (without / "plain.frag").write_text(plain, encoding="utf-8")
    done = run(without, "-m", "playground", "render", "plain.frag", "--size", "8x8", "-o", "p.png")
    assert done.returncode == 0, done.stderr
