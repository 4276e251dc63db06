"""Each room above the core can be removed: its folder, its tests, and one line of ``rooms.ROOMS``."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from playground.rooms import ROOMS

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "playground"
COMMANDS = {
    "studio": {"live"},
    "publish": {"render", "export", "pack"},
    "verify": {"check", "reduce", "bench", "shots", "variants"},
    "course": {"lesson"},
    "dialects": set[str](),
    "flight": {"fly"},
    "lsp": {"lsp"},
}
SKETCHES = {"dialects": ("channels", "flood", "from_elsewhere")}  # they use shaders of other tools
ROW = re.compile(r"^│ (\w+) {2,}", re.MULTILINE)
NAMES = list(ROOMS)
CORE_TESTS = (
    "sketch/test_load.py",
    "shader/test_outline.py",
    "data/test_bounds.py",
)
ROOM_TESTS = {
    "studio": ("test_input.py",),  # a panel of a window, without a screen
    "publish": ("capture/test_mesh.py",),
    "verify": ("shots/test_judge.py",),
}


def removed_with(room: str) -> set[str]:
    """Return a room and all that need it, however far."""
    gone = {room}
    while more := {name for name, each in ROOMS.items() if gone & {*each.needs}} - gone:
        gone |= more
    return gone


def is_of_window(name: str) -> bool:
    """Return whether a module of a room, by its path, is imported by the studio alone."""
    return re.match(r"\w+/(addition\.py|window/)", name) is not None


@pytest.mark.parametrize("room", NAMES)
def test_only_rooms_that_need_a_room_name_it(room):
    naming = [
        name
        for path in PACKAGE.rglob("*.py")
        if (name := path.relative_to(PACKAGE).as_posix()) not in ("__init__.py", "rooms.py")
        and (home := name.partition("/")[0]) != room
        and not (home in ROOMS and room in ROOMS[home].needs)
        and not (room == "studio" and is_of_window(name))
        and re.search(rf"playground[./]{room}\b|from playground import .*\b{room}\b", path.read_text("utf-8"))
    ]
    assert not naming, "the registry has its name, and nothing its modules"


def commands(folder: Path) -> set[str]:
    done = run(folder, "-m", "playground", "--help")
    assert done.returncode == 0, done.stderr
    return set(ROW.findall(done.stdout))


def run(folder: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "80", "NO_COLOR": "1", **variables}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True
    )


@pytest.fixture
def without(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Give a checkout without a room and those that need it, their tests, sketches and lines."""
    gone = removed_with(request.param)

    def ignored(root: Path) -> Callable[[str, list[str]], set[str]]:
        junk = shutil.ignore_patterns("node_modules", "__pycache__", "screenshots")
        return lambda folder, names: {*junk(folder, names), *(gone if Path(folder) == root else ())}

    shutil.copytree(PACKAGE, tmp_path / "playground", ignore=ignored(PACKAGE))
    shutil.copytree(ROOT / "tests", tmp_path / "tests", ignore=ignored(ROOT / "tests"))
    for path in ROOT.iterdir():
        if path.name not in ("playground", "tests", "glsl", "pyproject.toml", ".git", ".venv"):
            (tmp_path / path.name).symlink_to(path)
    settings = (ROOT / "pyproject.toml").read_text("utf-8")
    if "verify" in gone:  # its plugin
        settings = settings.replace('"-p", "playground.verify.shots.plugin", ', "")
        settings = re.sub(r'^(shots = |"playground\.verify\.).*\n', "", settings, flags=re.MULTILINE)
    (tmp_path / "pyproject.toml").write_text(settings, "utf-8")
    its = [name for room in gone for sketch in SKETCHES.get(room, ()) for name in (sketch, f"{sketch}.toml")]
    shutil.copytree(ROOT / "glsl", tmp_path / "glsl", ignore=shutil.ignore_patterns(*its))
    registry = tmp_path / "playground" / "rooms.py"
    text, count = re.subn(
        rf'^    "({"|".join(gone)})": .*\n', "", registry.read_text("utf-8"), flags=re.MULTILINE
    )
    assert count == len(gone)
    registry.write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("without", NAMES, indirect=True)
def test_everything_else_works_without_a_room(without):
    gone = {*NAMES} - {p.name for p in (without / "playground").iterdir()}
    assert commands(without) == commands(ROOT) - {name for room in gone for name in COMMANDS[room]}
    modules = [
        ".".join(path.relative_to(without).with_suffix("").parts)
        for path in sorted((without / "playground").rglob("*.py"))
        if "templates" not in path.parts
        and path.stem not in ("__main__", "conftest")
        and not ("studio" in gone and is_of_window(path.relative_to(without / "playground").as_posix()))
    ]
    code = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)\n"
    code += "import playground; from playground import *; print(playground.__file__)"
    done = run(without, "-c", code, *modules)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(without / "playground" / "__init__.py")
    picture = (
        "import playground\nwith playground.headless(software=True) as engine:\n"
        "    engine.render(playground.load('l_dot_n'), size=(32, 18)).save('p.png')\n"
    )
    done = run(without, "-c", picture)
    assert done.returncode == 0 and (without / "p.png").is_file(), done.stderr
    # What is installed names the plugin of shots, which the room verify takes along.
    off = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    done = run(
        without, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--collect-only", "-m", "", "tests", **off
    )
    assert done.returncode == 0, done.stdout[-3000:]
    tests = [f"tests/{name}" for name in CORE_TESTS]
    tests += [
        f"tests/{room}/{name}" for room, names in ROOM_TESTS.items() if room not in gone for name in names
    ]
    done = run(without, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests, **off)
    assert done.returncode == 0, done.stdout
    if "studio" not in gone and shutil.which("Xvfb"):
        assert '"error": ""' in opened(without)


WINDOW = """
import sys
from playground.studio.app import run
sys.exit(run("l_dot_n", size=(480, 320), time_limit=8))
"""


def opened(folder: Path) -> str:
    """Open a window for some seconds; return the status that it wrote."""
    read, write = os.pipe()
    with subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "640x480x24", "-nolisten", "tcp"],
        pass_fds=[write], stderr=subprocess.DEVNULL,
    ) as server:  # fmt: skip
        os.close(write)
        with os.fdopen(read) as answer:
            display = f":{answer.readline().strip()}"
        status = folder / "status.jsonl"
        done = run(
            folder, "-c", WINDOW, DISPLAY=display, PLAYGROUND_STATUS=str(status), XDG_STATE_HOME=str(folder)
        )
        server.terminate()
    assert done.returncode == 0, done.stderr
    return status.read_text("utf-8")


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
