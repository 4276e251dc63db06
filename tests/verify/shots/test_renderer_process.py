"""The process that renders shots: the right images, nothing left behind here, each way it can end."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import ContextError, ParameterError, SandboxCrash, ShaderError
from playground.sketch.model import Graph, Shot, Sketch
from playground.verify.shots import suite as renderer_module
from playground.verify.shots.suite import RendererProcess, ShotCase, render_shot, shots_of

from ...sketch_texts import map_of_height

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"),
    reason="the reference renderer, Mesa's llvmpipe, is chosen by name on Linux",
)

KERNEL = """// terrain.glsl -- bands that time moves.
#pragma kernel(output = "height:r32f", repeat = "count")

uniform int count = 3;         //! slider(1, 9) How often it is made brighter
uniform float gain = 0.2;      //! slider(0, 1) How much brighter in each step

float kernel(ivec2 texel) {
    return previous(texel) + gain * fract(float(texel.x) / float(size.x) + 0.1 * time);
}
"""

SKETCH = (
    "format = 1\nsize = 32\n"
    + map_of_height(channel="red")
    + """[[preset]]
name = "dim"
set = { "height.gain" = 0.1 }
[[shot]]
name = "plain"
size = [48, 32]
[[shot]]
name = "later"
size = [40, 32]
time = 2.5
[[shot]]
name = "dim"
size = [32, 32]
preset = "dim"
[[shot]]
name = "short"
size = [32, 32]
set = { "height.count" = 2 }
[[shot]]
name = "first"
size = [32, 32]
steps = { height = 1 }
"""
)


@pytest.fixture
def cases(tmp_path: Path) -> dict[str, ShotCase]:
    (tmp_path / "terrain.glsl").write_text(KERNEL)
    (tmp_path / "bands.toml").write_text(SKETCH)
    return {case.shot.name: case for case in shots_of([tmp_path / "bands.toml"])}


def test_a_case_is_named_by_sketch_and_shot(cases: dict[str, ShotCase]) -> None:
    assert [str(case) for case in cases.values()] == [f"bands/{name}" for name in cases]
    assert [name for name in cases] == ["plain", "later", "dim", "short", "first"]


def test_the_worker_draws_what_an_engine_here_draws(
    cases: dict[str, ShotCase], warm_renderer: RendererProcess, any_engine: Engine
) -> None:
    if any_engine.info.slug != warm_renderer.renderer.slug:
        pytest.skip(f"OpenGL here is {any_engine.info.renderer}")
    for case in cases.values():
        np.testing.assert_array_equal(warm_renderer.render(case).array, render_shot(any_engine, case).array)


def test_a_shot_obeys_each_of_its_settings(
    cases: dict[str, ShotCase], warm_renderer: RendererProcess
) -> None:
    frames = {name: warm_renderer.render(case) for name, case in cases.items()}
    assert frames["plain"].size == (48, 32)
    assert (frames["later"].size, frames["later"].time) == ((40, 32), 2.5)
    # The terrain is 32 texels wide; at x = 31 its value is count * gain * 31/32 (* fract(31/32 + 0.25)).
    bright = {name: int(frame.array[16, -1 - (frame.size[0] - 32) // 2, 0]) for name, frame in frames.items()}
    expected = {
        "plain": 3 * 0.2 * 31 / 32,
        "later": 3 * 0.2 * 7 / 32,
        "dim": 3 * 0.1 * 31 / 32,
        "short": 2 * 0.2 * 31 / 32,
        "first": 1 * 0.2 * 31 / 32,
    }
    for name, value in expected.items():
        assert bright[name] == pytest.approx(255 * value, abs=0.51), name


@pytest.mark.slow
def test_this_process_keeps_its_environment_and_its_context(
    cases: dict[str, ShotCase], ctx: moderngl.Context
) -> None:
    before = dict(os.environ)
    texture = ctx.texture((1, 1), 1, b"\x07")
    with RendererProcess() as own:
        own.render(cases["plain"])
        assert texture.read() == b"\x07"
    assert dict(os.environ) == before
    texture.release()


def test_sketch_error_reaches_parent_and_next_shot_runs(
    cases: dict[str, ShotCase], warm_renderer: RendererProcess, tmp_path: Path
) -> None:
    (tmp_path / "terrain.glsl").write_text(KERNEL.replace("gain *", "gian *"))
    broken = shots_of([tmp_path / "bands.toml"])[0]
    with pytest.raises(ShaderError, match=r"terrain\.glsl:8.*gian"):
        warm_renderer.render(broken)
    wrong = ShotCase(cases["plain"].sketch, Shot("wrong", values=(("height.gian", 1.0),)))
    with pytest.raises(ParameterError, match="gian"):
        warm_renderer.render(wrong)
    assert warm_renderer.render(cases["plain"]).size == (48, 32)


@pytest.mark.slow
def test_a_missing_software_renderer_is_reported_each_time(
    monkeypatch: pytest.MonkeyPatch, cases: dict[str, ShotCase]
) -> None:
    monkeypatch.setenv("GALLIUM_DRIVER", "no-such-driver")
    with RendererProcess() as renderer:
        for _ in range(2):
            with pytest.raises(ContextError):
                renderer.render(cases["plain"])


def test_a_renderer_process_that_rendered_nothing_starts_nothing() -> None:
    with RendererProcess() as renderer:
        assert renderer.process is None


# How a worker can end. Its OpenGL is made up: what it draws is nothing, and it ends as the shot is named.

FAKE = """
import ctypes, os, sys
from pathlib import Path

with Path("starts").open("a") as starts:
    starts.write("x")
if Path("cannot start").exists():
    print("LLVM ERROR: out of memory", file=sys.stderr, flush=True)
    os.abort()

import numpy as np
from playground.engine.context import ContextInfo
from playground.engine.process.worker import Service
from playground.verify.shots.suite import RenderedShot

def open_service(parent, renderer):
    def take(case):
        name = case.shot.name
        if name == "crash":
            os.write(2, b"nir: validation failed after split_vars\\n")
            os.abort()
        if name == "hang":  # as a draw does: with Python's lock held, so that no thread and no handler runs
            ctypes.PyDLL(None).sleep(100_000)
        print("drew", name, flush=True)
        return RenderedShot(np.zeros((2, 3, 4), np.uint8), drawn=name)

    return Service(take, ContextInfo(450, "llvmpipe (made up)", "", "", 4))
"""


def made_up(name: str) -> ShotCase:
    return ShotCase(Sketch("hills", "", "", Graph("", "", ())), Shot(name))


@pytest.fixture
def fake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RendererProcess]:
    """Give a renderer whose child draws nothing."""
    (tmp_path / "fake_handler.py").write_text(FAKE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(renderer_module, "HANDLER", "fake_handler")
    with RendererProcess() as made:
        yield made


@pytest.mark.slow
def test_a_worker_that_cannot_start_is_tried_thrice_and_no_more(fake: RendererProcess) -> None:
    Path("cannot start").touch()
    words = r"starting the process that draws crashed: the process was ended by SIGABRT\n    \| LLVM ERROR"
    for _ in range(4):
        with pytest.raises(SandboxCrash, match=words):
            fake.render(made_up("first"))
    assert Path("starts").read_text() == "xxx"
    Path("cannot start").unlink()
    with RendererProcess() as other:
        assert other.render(made_up("first")).drawn == "first"
        assert "drew first" in other.printed() and not other.printed()


ENDING = (
    "format = 1\nsize = 32\n"
    + map_of_height()
    + '[[shot]]\nname = "crash"\n[[shot]]\nname = "hang"\n[[shot]]\nname = "next"\n'
)


@pytest.mark.slow
def test_how_a_worker_ends_is_reported_by_the_plugin(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    for variable in ("CI", "PYTEST_ADDOPTS"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.syspath_prepend(pytester.path)
    monkeypatch.setattr(renderer_module, "HANDLER", "fake_handler")
    files = {"fake_handler.py": FAKE, "terrain.glsl": KERNEL, "bands.toml": ENDING}
    for name, text in files.items():
        Path(name).write_text(text)
    Path("test_x.py").write_text("def test_one(shot): shot.render('bands.toml', shot='crash')\n")

    def run(*arguments: str) -> pytest.RunResult:
        fixed = (
            "-p",
            "playground.verify.shots.plugin",
            "-p",
            "no:cacheprovider",
            "-W",
            "error",
            "bands.toml",
        )
        return pytester.runpytest_inprocess(*fixed, *arguments)

    result = run("test_x.py", "-k", "crash or next or one")
    result.assert_outcomes(failed=3, deselected=2)
    result.stdout.fnmatch_lines(
        [
            "bands/crash: crash: drawing bands/crash crashed: the process was ended by SIGABRT",
            "    | nir: validation failed after split_vars",
            "bands/next: blank: *",
            "E *SandboxCrash: crash: drawing bands/crash crashed: the process was ended by SIGABRT",
        ]
    )
    result.stdout.no_fnmatch_line("*Traceback*")
    result = run("-k", "hang", "--shots-timeout=0.2")  # where it is sure to be over
    result.assert_outcomes(failed=1, deselected=3)
    message = "drawing bands/hang took more than 0.2 s and was stopped"
    result.stdout.fnmatch_lines([f"bands/hang: hang: {message}*"])
    words = {p.stem: json.loads(p.read_text())["word"] for p in Path("shots-report/bands").glob("*.json")}
    assert words == {"crash": "crash", "next": "blank", "hang": "hang"}
