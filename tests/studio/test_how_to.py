"""The programs on the page about remotes do what it says of them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from playground.engine.engine import Engine
from playground.studio.remote.controllers import read_bindings

from ..docs.pages import DOCS, Block, blocks_of
from .remote_desk import Harness

PAGE = DOCS / "how-to" / "remotes.md"
SKETCH = """format = 1
size = 17
[[pass]]
name = "height"
use = "generation/white_noise"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
set = { grid = 9 }
[[preset]]
name = "evening"
set = { "light.sun" = [250.0, 12.0] }
"""


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> object:
    (tmp_path / "land").mkdir()
    (tmp_path / "land" / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    made = Harness(any_engine, tmp_path / "land")
    yield made
    made.close()


def block(language: str, holds: str) -> Block:
    (result,) = [b for b in blocks_of(PAGE) if b.language == language and holds in b.text]
    return result


def runs(harness: Harness, text: str, folder: Path, *words: str) -> str:
    command = [sys.executable, "-W", "error", "-c", text, *words]

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)

    done = harness.during(run)
    assert done.returncode == 0, done.stderr
    return str(done.stdout)


def test_the_script_by_http(harness: Harness, tmp_path: Path) -> None:
    server = harness.open(port=0).server
    assert server is not None
    printed = runs(harness, block("python", "urlopen").text, tmp_path, server.url)
    assert harness.value("light.sun") == (250.0, 12.0) and "light.sun 250,12" in printed
    with Image.open(tmp_path / "evening.png") as picture:
        assert picture.size == (640, 360)


def test_the_script_by_websocket(harness: Harness, tmp_path: Path) -> None:
    server = harness.open(port=0).server
    assert server is not None
    before = harness.value("light.sun")
    printed = runs(harness, block("python", "aiohttp").text, tmp_path, server.url)
    events = [json.loads(line) for line in printed.splitlines()]
    assert events[0]["event"] == "state" and events[-1] == {"ok": True, "id": "done"}
    assert harness.value("light.sun") == before, "the stream of values is one step, undone at the end"


def test_the_script_by_osc(harness: Harness, tmp_path: Path) -> None:
    osc = harness.open(osc=("127.0.0.1", 0)).osc
    assert osc is not None and osc.source is not None
    text = block("python", "SimpleUDPClient").text.replace("9000", str(osc.source[1]))
    runs(harness, text, tmp_path)
    harness.until(lambda: harness.value("light.sun") == (250.0, 12.0))


def test_what_to_do_and_the_controllers_are_as_shown(harness: Harness, tmp_path: Path) -> None:
    harness.open(port=0)
    wishes = json.loads(block("json", "preset").text)
    from playground.studio.remote.controls import Controls

    controls = Controls(harness.bench)
    assert list(wishes) == controls.names
    controls.do(wishes)
    file = tmp_path / "a.controllers"
    file.write_text(block("toml", "controller").text, encoding="utf-8")
    (binding,) = read_bindings(file)
    assert (binding.path, binding.part, binding.source.number) == ("light.sun", "elevation", 21)


def test_a_packed_sketch_leaves_its_controllers_behind(harness: Harness, tmp_path: Path) -> None:
    from zipfile import ZipFile

    from playground.publish.pack import pack

    (tmp_path / "land" / "sketch.controllers").write_text("format = 1\n", encoding="utf-8")
    assert harness.session.sketch is not None
    names = ZipFile(pack(harness.session.sketch, tmp_path / "land.zip")).namelist()
    assert any(name.endswith("sketch.toml") for name in names)
    assert not any("controllers" in name for name in names)
