"""Previews of a slow picture have fewer pixels while it moves, and are drawn in full when it rests."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.studio.cost.costs import PassCosts
from playground.studio.inspect.inspection import Inspection
from playground.studio.picture.full_screen import Enlarger
from playground.studio.picture.preview import BUDGETS, DIVISORS, chosen_divisor
from playground.studio.picture.shown_picture import REST
from playground.studio.session import Session

from ..sketch_texts import passes

SIZE = (640, 480)
RAMP = """#pragma kernel(output = "frame:rgba8")
uniform float level = 0.5;  //! slider(0, 1)
uniform sampler2D made;     //! input
vec4 kernel(ivec2 texel) {
    return vec4(vec2(texel) / vec2(size), level * texelFetch(made, ivec2(0), 0).r, 1.0);
}
"""
MADE = """#pragma kernel(output = "made:r32f")
uniform float high = 0.5;  //! slider(0, 1)
float kernel(ivec2 texel) { return high; }
"""
COUNT = """#pragma kernel(output = "frame:rgba8")
uniform sampler2D before;  //! input("zero")
vec4 kernel(ivec2 texel) { return texelFetch(before, texel, 0) + vec4(1.0 / 255.0); }
"""
POINTER = """void mainImage(out vec4 colour, vec2 at) { colour = vec4(iMouse.xy / iResolution.xy, 0, 1); }
"""
SKETCH = """format = 1
size = 8
[[pass]]
name = "made"
use = "./made"
size = 8
[view]
use = "./ramp"
inputs = { made = "made" }
"""


@dataclass
class MadeUpTimer:
    """Says that passes took what a test makes up: [ms] for a texel, and for any number of them."""

    engine: Engine
    each: dict[str, float] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    busy: Callable[[], float] = lambda: 1.0  # a factor of all
    clock: str = "made up"

    @contextmanager
    def measure(self, into: dict[str, float], name: str) -> Iterator[None]:
        yield
        step = self.engine.record.plan.step(name)
        texels = step.size[0] * step.size[1]
        into[name] = self.busy() * (self.fixed.get(name, 0.0) + self.each.get(name, 0.0) * texels)


@dataclass
class Slow:
    """A session on the sketch of this file, its clock and what its passes take."""

    session: Session
    timer: MadeUpTimer
    now: list[float]

    def frame(self, seconds: float = 0.0) -> tuple[int, int]:
        """Let a frame pass, so many seconds after the last; return the pixels that were drawn."""
        self.now[0] += seconds
        self.session.frame(SIZE)
        assert self.session.error is None
        return self.session.picture.drawn_size

    def move(self, times: int, path: str = "view.level") -> list[int]:
        """Move a slider for so many frames; return by what the sides were divided."""
        numbers = []
        for number in range(times):
            self.session.drafts.set(path, 0.1 + 0.79 * number / times)
            numbers.append(round(SIZE[0] / self.frame(0.05)[0]))
        return numbers


@pytest.fixture
def slow(tmp_path: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[Slow]:
    """Open the sketch; a whole picture takes a second."""
    for name, text in (("ramp.glsl", RAMP), ("made.glsl", MADE), ("sketch.toml", SKETCH)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(ContextInfo, "software", True)
    timer = MadeUpTimer(any_engine, each={"view": 1000.0 / (SIZE[0] * SIZE[1])})
    monkeypatch.setattr(any_engine, "_timer_of", lambda: timer)
    now = [0.0]
    made = Slow(Session(any_engine, tmp_path / "sketch.toml", now=lambda: now[0]), timer, now)
    yield made
    made.session.release()


def test_a_slow_picture_moves_in_fewer_pixels_and_rests_in_full(slow: Slow):
    session = slow.session
    slow.frame()
    slow.frame(1.0)
    assert session.picture.drawn_size == SIZE and not session.is_preview
    divisors = slow.move(12)
    spent = sum(session.engine.record.times.values())
    assert set(divisors[-6:]) == {3} and spent < 1e3 * BUDGETS[3], "the largest within its budget: 111 ms"
    assert session.is_preview and session.picture.texture.size == SIZE and not session.is_idle
    assert slow.frame(REST / 2) != SIZE and slow.frame(REST) == SIZE
    assert not session.is_preview and session.is_idle
    expected = session.engine.render(session.sketch, size=SIZE).array
    np.testing.assert_array_equal(session.read().array[..., :3], expected[..., :3])


def test_the_first_picture_is_small_and_the_next_frame_is_whole(slow: Slow):
    width, height = slow.frame()
    assert (width, height) == (213, 160) and slow.session.picture.texture.size == SIZE
    assert slow.frame() == SIZE and slow.session.draws == 2


def test_what_is_read_back_is_whole_while_it_moves(slow: Slow):
    slow.move(6)
    picture = slow.session.read().array
    expected = slow.session.engine.render(slow.session.sketch, size=SIZE).array
    np.testing.assert_array_equal(picture[..., :3], expected[..., :3])


def test_a_fast_picture_stays_whole(slow: Slow):
    slow.timer.each["view"] /= 40  # 25 ms
    slow.frame()
    slow.frame(1.0)
    assert set(slow.move(10)) == {1}


def test_what_fewer_pixels_do_not_make_faster_stays_whole(slow: Slow):
    slow.timer.each["view"] /= 20
    slow.timer.fixed["made"] = 700.0
    slow.frame()
    slow.frame(1.0)
    assert set(slow.move(8, "made.high")) == {1}


def test_a_slider_that_runs_only_fast_passes_shows_all_pixels(slow: Slow):
    """Which passes run decides, and not what the last picture took."""
    slow.timer.each = {"made": 1.0, "view": 1e-6}
    slow.timer.fixed["made"] = 700.0
    slow.frame()
    slow.frame(1.0)
    slow.move(3, "made.high")
    assert set(slow.move(3, "view.level")) == {1}


def test_preview_size_is_steady_under_varying_machine_load(slow: Slow):
    factors = itertools.cycle((1.0, 1.3, 0.9, 1.1))
    slow.timer.each["view"] *= 0.7
    slow.timer.busy = lambda: next(factors)
    slow.frame()
    slow.frame(1.0)
    divisors = slow.move(40)[8:]
    assert sum(a != b for a, b in itertools.pairwise(divisors)) <= 1, str(divisors)


def test_preview_size_changes_with_one_fifth_hysteresis():
    by_size = {d: 4.5 * BUDGETS[2] / d**2 for d in DIVISORS}  # a half: 1.125 of its budget
    assert (
        chosen_divisor(by_size, 2) == 2
        and chosen_divisor(by_size, 3) == 3
        and chosen_divisor(by_size, 1) == 3
    )
    by_size = {d: 3.6 * BUDGETS[2] / d**2 for d in DIVISORS}
    assert chosen_divisor(by_size, 3) == 3 and chosen_divisor(by_size, 1) == 2
    by_size = {d: 3.0 * BUDGETS[2] / d**2 for d in DIVISORS}
    assert chosen_divisor(by_size, 3) == 2
    by_size = {d: 1.1 * BUDGETS[1] / d for d in DIVISORS}
    assert chosen_divisor(by_size, 1) == 1 and chosen_divisor(by_size, 2) == 2
    assert chosen_divisor({d: 9.0 + 0.1 / d**2 for d in DIVISORS}, 4) == 1, "fewer pixels gain nothing"


def test_a_simulation_keeps_its_size(slow: Slow, tmp_path: Path):
    """Another size would begin it again, from second 0."""
    (tmp_path / "count.glsl").write_text(COUNT, encoding="utf-8")
    inside = passes(count=("./count", 'repeat = "frames"', 'feedback = { before = "frame" }'))
    (tmp_path / "counted.toml").write_text(inside, encoding="utf-8")
    (tmp_path / "counting.toml").write_text('format = 1\n[view]\nuse = "./counted"\n', encoding="utf-8")
    slow.session.open(tmp_path / "counting.toml")
    for _ in range(4):
        assert slow.frame(0.05) == SIZE
        slow.session.clock.time += 0.1


def test_too_slow_time_is_paused_once_for_full_picture(slow: Slow, tmp_path: Path):
    (tmp_path / "ramp.glsl").write_text(RAMP.replace("level *", "fract(time) * level *"), encoding="utf-8")
    (tmp_path / "playing.toml").write_text(SKETCH, encoding="utf-8")
    session = slow.session
    session.open(tmp_path / "playing.toml")

    def play(frames: int) -> list[tuple[int, int]]:
        result = []
        for _ in range(frames):
            session.advance(0.05, datetime(2026, 11, 23, tzinfo=UTC))
            result.append(slow.frame(0.05))
        return result

    assert SIZE not in play(4) and not session.clock.playing
    assert [note for note in session.notes if "paused" in note] == [
        "time is paused, so that the picture is drawn in full; Space plays it"
    ]
    stands = session.clock.time
    assert play(8)[-1] == SIZE and session.clock.time == stands and not session.is_preview
    session.clock.toggle()
    assert play(8)[-1] != SIZE and session.clock.playing, "who plays it, knows"
    assert session.clock.time == pytest.approx(stands + 0.4)


def test_time_that_is_fast_enough_is_not_paused(slow: Slow, tmp_path: Path):
    slow.timer.each["view"] /= 20
    (tmp_path / "ramp.glsl").write_text(RAMP.replace("level *", "fract(time) * level *"), encoding="utf-8")
    (tmp_path / "playing.toml").write_text(SKETCH, encoding="utf-8")
    slow.session.open(tmp_path / "playing.toml")
    for _ in range(8):
        slow.session.advance(0.05, datetime(2026, 11, 23, tzinfo=UTC))
        slow.frame(0.05)
    assert slow.session.clock.playing and not slow.session.notes


def test_maps_and_what_reads_pixels_have_them_all(slow: Slow):
    slow.frame()
    slow.frame(1.0)
    slow.move(6)
    slow.session.show("made:made")
    assert slow.frame() == SIZE
    slow.session.show(None)
    inspection = Inspection(slow.session)
    inspection.inspector.toggle()
    inspection.begin()
    assert set(slow.move(4)) == {1}
    inspection.inspector.toggle()
    inspection.begin()
    assert set(slow.move(6)[-2:]) == {3}


def test_compared_pictures_have_the_same_pixels(slow: Slow):
    slow.frame()
    slow.frame(1.0)
    compare = Inspection(slow.session).compare
    kept = slow.session.sketch
    compare.keep()
    compare.follow(slow.session.picture.texture)
    slow.move(6, "made.high")
    slow.session.clock.time = 0.0
    compare.follow(slow.session.picture.texture)
    assert compare.picture.size == SIZE and slow.session.is_preview
    assert slow.session.engine.record.plan.frame_size == slow.session.picture.drawn_size != SIZE
    slow.frame(1.0)
    compare.follow(slow.session.picture.texture)
    assert slow.session.picture.drawn_size == SIZE
    result = np.frombuffer(compare.picture.read(), np.uint8).reshape(*SIZE[::-1], -1)
    expected = slow.session.engine.render(kept, size=SIZE).array
    np.testing.assert_array_equal(result[::-1, :, :3], expected[..., :3])
    compare.release()


@pytest.mark.room("dialects")
def test_shader_sees_mouse_at_same_place_in_smaller_picture(slow: Slow, tmp_path: Path):
    (tmp_path / "pointer.glsl").write_text(POINTER, encoding="utf-8")
    slow.session.open(tmp_path / "pointer.glsl")
    assert slow.frame() != SIZE
    slow.session.hover((480.0, 120.0), pressed=True, clicked=True)
    slow.timer.each = {step.path: 1e-2 for step in slow.session.plan.walk()}
    for _ in range(3):
        slow.session.redraw()
        slow.frame()
    assert slow.session.picture.drawn_size != SIZE
    picture = np.frombuffer(slow.session.picture.texture.read(), np.uint8).reshape(-1, 4)
    np.testing.assert_allclose(picture[0, :2], [0.75 * 255, 0.25 * 255], atol=1)


@pytest.mark.parametrize(("small", "large"), [((40, 30), (120, 90)), ((41, 23), (97, 60))])
def test_a_cubic_surface_is_enlarged_to_itself(
    any_engine: Engine, small: tuple[int, int], large: tuple[int, int]
):
    """Catmull-Rom's splines reproduce parabolas; the border, where texels repeat, is left out."""

    def surface(size: tuple[int, int]) -> np.ndarray:
        x, y = ((np.arange(side) + 0.5) / side for side in size)
        return 0.2 + 0.5 * x[None, :] ** 2 + 0.3 * (1 - y[:, None]) * y[:, None]

    texels = np.round(surface(small) * 255).astype(np.uint8)
    ctx = any_engine.ctx
    enlarger = Enlarger(ctx)
    picture = ctx.texture(small, 4, np.repeat(texels[..., None], 4, 2).tobytes())
    shown = ctx.texture(large, 4)
    target = ctx.framebuffer([shown])
    with any_engine.borrowed():
        enlarger.draw(picture, target)
    result = np.frombuffer(shown.read(), np.uint8).reshape(large[1], large[0], 4)
    for made in (enlarger, target, shown, picture):
        made.release()
    edge = 2 * (-(-large[0] // small[0]))
    inner = (slice(edge, -edge), slice(edge, -edge))
    np.testing.assert_allclose(result[..., 0][inner], 255 * surface(large)[inner], atol=1.8)


def test_grey_pictures_and_coloured_ones_are_enlarged_in_turn(any_engine: Engine):
    ctx, size, large = any_engine.ctx, (6, 4), (13, 11)
    level = np.full((size[1], size[0], 4), (200, 90, 30, 255), np.uint8)
    shown, enlarger = ctx.texture(large, 4), Enlarger(ctx)
    target = ctx.framebuffer([shown])
    grey, coloured = ctx.texture(size, 1, level[..., 0].tobytes(), alignment=1), ctx.texture(size, 4, level)
    for picture, expected in ((grey, (200, 200, 200)), (coloured, (200, 90, 30)), (grey, (200, 200, 200))):
        with any_engine.borrowed():
            enlarger.draw(picture, target)
        result = np.frombuffer(shown.read(), np.uint8).reshape(-1, 4)
        np.testing.assert_allclose(result[:, :3], np.tile(expected, (len(result), 1)), atol=1)
    for made in (enlarger, target, shown, grey, coloured):
        made.release()


def test_pass_costs_interpolate_linearly_and_drop_first_sample():
    costs = PassCosts()
    assert costs.expected("a", 100) is None
    costs.take({"a": 100}, {"a": 900.0})  # with its compiler
    assert costs.expected("a", 200) == 1800.0
    costs.take({"a": 100}, {"a": 30.0})
    assert costs.expected("a", 100) == 30.0 and costs.expected("a", 50) == 15.0
    costs.take({"a": 400}, {"a": 90.0})
    assert costs.expected("a", 200) == pytest.approx(50.0) and costs.expected("a", 900) == pytest.approx(
        190.0
    )
    costs.take({"a": 400}, {"a": 110.0})
    assert costs.expected("a", 400) == 100.0, "slower: it may have been busy"
    costs.take({"a": 400}, {"a": 70.0})
    assert costs.expected("a", 400) == 70.0
