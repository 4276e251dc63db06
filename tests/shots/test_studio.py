"""The child process that takes pictures: the right ones, nothing left behind here, each way it can end."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import ContextError, ParameterError, ShaderError, TrialCrash, TrialTimeout
from playground.shots.studio import Studio
from playground.shots.suite import ShotCase, shots_of, take
from playground.sketch.model import Shot

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"),
    reason="the reference renderer, Mesa's llvmpipe, is chosen by name on Linux",
)

KERNEL = """// land.glsl -- bands that time moves.
#pragma kernel(output = "height:r32f", repeat = "turns")

uniform int turns = 3;         //! slider(1, 9) How often it is made brighter
uniform float gain = 0.2;      //! slider(0, 1) How much brighter in a turn

float kernel(ivec2 texel) {
    return previous(texel) + gain * fract(float(texel.x) / float(size.x) + 0.1 * time);
}
"""

SKETCH = """format = 1
size = 32
[[pass]]
name = "height"
use = "./land"
[view]
use = "view/map"
inputs = { shown = "height" }
set = { channel = "red" }
[[preset]]
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
set = { "height.turns" = 2 }
[[shot]]
name = "first"
size = [32, 32]
steps = { height = 1 }
"""


@pytest.fixture
def cases(tmp_path: Path) -> dict[str, ShotCase]:
    (tmp_path / "land.glsl").write_text(KERNEL)
    (tmp_path / "bands.toml").write_text(SKETCH)
    return {case.shot.name: case for case in shots_of([tmp_path / "bands.toml"])}


@pytest.fixture(scope="module")
def studio() -> Iterator[Studio]:
    with Studio() as made:
        yield made


def test_a_case_is_named_by_sketch_and_shot(cases: dict[str, ShotCase]) -> None:
    assert [str(case) for case in cases.values()] == [f"bands/{name}" for name in cases]
    assert [name for name in cases] == ["plain", "later", "dim", "short", "first"]


def test_the_child_draws_what_an_engine_here_draws(
    cases: dict[str, ShotCase], studio: Studio, any_engine: Engine
) -> None:
    if any_engine.info.slug != studio.renderer.slug:
        pytest.skip(f"OpenGL here is {any_engine.info.renderer}")
    for case in cases.values():
        np.testing.assert_array_equal(studio.take(case).array, take(any_engine, case).array)


def test_a_shot_obeys_each_of_its_settings(cases: dict[str, ShotCase], studio: Studio) -> None:
    frames = {name: studio.take(case) for name, case in cases.items()}
    assert frames["plain"].size == (48, 32)
    assert (frames["later"].size, frames["later"].time) == ((40, 32), 2.5)
    # The land is 32 texels wide; at x = 31 its value is turns * gain * 31/32 (* fract(31/32 + 0.25)).
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


def test_this_process_keeps_its_environment_and_its_context(
    cases: dict[str, ShotCase], ctx: moderngl.Context
) -> None:
    before = dict(os.environ)
    texture = ctx.texture((1, 1), 1, b"\x07")
    with Studio() as own:
        own.take(cases["plain"])
        assert texture.read() == b"\x07"
    assert dict(os.environ) == before
    texture.release()


def test_cases_and_frames_cross_over_whole(cases: dict[str, ShotCase]) -> None:
    for case in cases.values():
        assert pickle.loads(pickle.dumps(case)) == case


def test_a_mistake_of_the_sketch_crosses_over_and_the_next_shot_still_runs(
    cases: dict[str, ShotCase], studio: Studio, tmp_path: Path
) -> None:
    (tmp_path / "land.glsl").write_text(KERNEL.replace("gain *", "gian *"))
    broken = shots_of([tmp_path / "bands.toml"])[0]
    with pytest.raises(ShaderError, match=r"land\.glsl:8.*gian"):
        studio.take(broken)
    wrong = ShotCase(cases["plain"].sketch, Shot("wrong", values=(("height.gian", 1.0),)))
    with pytest.raises(ParameterError, match="gian"):
        studio.take(wrong)
    assert studio.take(cases["plain"]).size == (48, 32)


def test_a_child_that_dies_is_a_crash_and_is_replaced(cases: dict[str, ShotCase]) -> None:
    with Studio() as studio:
        first = studio.take(cases["plain"])
        assert studio._process is not None
        studio._process.kill()
        studio._process.wait()
        with pytest.raises(TrialCrash, match="drawing bands/dim died"):
            studio.take(cases["dim"])
        np.testing.assert_array_equal(studio.take(cases["plain"]).array, first.array)


def test_a_child_that_hangs_is_stopped_and_is_replaced(cases: dict[str, ShotCase]) -> None:
    with Studio() as studio:
        first = studio.take(cases["plain"])
        assert studio._process is not None
        studio._process.send_signal(signal.SIGSTOP)
        studio.limit = 0.2
        with pytest.raises(TrialTimeout, match=r"drawing bands/dim took more than 0\.2 s"):
            studio.take(cases["dim"])
        studio.limit = 60.0
        np.testing.assert_array_equal(studio.take(cases["plain"]).array, first.array)


def test_no_software_renderer_is_said_each_time(
    monkeypatch: pytest.MonkeyPatch, cases: dict[str, ShotCase]
) -> None:
    monkeypatch.setenv("GALLIUM_DRIVER", "no-such-driver")
    with Studio() as studio:
        for _ in range(2):
            with pytest.raises(ContextError):
                studio.take(cases["plain"])


def test_a_studio_that_took_nothing_starts_nothing() -> None:
    with Studio() as studio:
        assert studio._process is None


def test_closing_ends_the_child(cases: dict[str, ShotCase]) -> None:
    studio = Studio()
    studio.take(cases["plain"])
    process = studio._process
    assert process is not None and process.poll() is None
    studio.close()
    assert process.returncode == 0
