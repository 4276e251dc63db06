"""Numbers that are not finite: found at rest, a pass a frame, named, and gone once fixed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.non_finite import NotFinite
from playground.studio.bench import Workbench
from playground.studio.interface import WindowControls
from playground.studio.problems.non_finite import REST, FiniteWatch, summary
from playground.studio.problems.panel import place_in, ref_of
from playground.studio.session import Session

from ..sketch_texts import map_of, passes
from .panel_desk import Bare

FIRST = """// first.glsl -- with a hole
#pragma kernel(output = "first:r32f")
uniform float root = 0.0; //! slider(-1, 1)
float kernel(ivec2 texel) { return texel / 2 == ivec2(6, 15) ? sqrt(root) : 0.5; }
"""
SECOND = """// second.glsl -- one more
#pragma kernel(output = "second:r32f")
uniform sampler2D first; //! input
float kernel(ivec2 texel) { return 1.0 + texelFetch(first, texel, 0).r; }
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(first=("./first", "set = { root = -0.5 }"), second=("./second", 'inputs = { first = "first" }'))
    + map_of("second", channel="red")
)


class Harness:
    """A session, the watch on it, and a clock that the test moves."""

    def __init__(self, engine: Engine, folder: Path) -> None:
        for name, text in (("first.glsl", FIRST), ("second.glsl", SECOND), ("sketch.toml", SKETCH)):
            (folder / name).write_text(text, encoding="utf-8")
        self.time = 100.0
        self.session = Session(engine, folder, now=lambda: self.time)
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=folder, now=lambda: self.time
        )
        self.watch = FiniteWatch(lambda: self.time)

    def run_frames(self, seconds: float = 0.0, held: bool = False) -> None:
        self.time += seconds
        self.session.frame((40, 40))
        self.watch.update(self.session, held=held)

    def rest(self) -> list[str]:
        self.run_frames()
        self.run_frames(2 * REST)
        for _ in range(20):
            self.run_frames()
        return [result.path for result in self.watch.non_finite]


@pytest.fixture
def harness(any_engine: Engine, tmp_path: Path) -> Iterator[Harness]:
    made = Harness(any_engine, tmp_path)
    yield made
    made.session.release()


def test_the_first_pass_is_named_and_what_follows_is_counted(harness: Harness) -> None:
    assert harness.rest() == ["first", "second"]
    first = harness.watch.non_finite[0]
    assert (first.output, first.texel, first.value, first.count) == ("first", (12, 30), "NaN", 4)
    expected = "pass 'first' makes NaN at texel (12, 30), 4 texels; first of 2 passes"
    assert summary(harness.watch.non_finite) == expected
    assert harness.watch.patience is None, "nothing more is waited for"


def test_non_finite_scan_waits_for_idle_and_reads_pass_by_pass(harness: Harness) -> None:
    harness.run_frames()
    harness.run_frames(REST / 2)
    assert harness.watch.looks == 0 and harness.watch.patience is not None
    harness.run_frames(REST, held=True)
    assert harness.watch.looks == 0
    for number in range(1, 3):
        harness.run_frames(REST if number == 1 else 0.0)
        assert harness.watch.looks == number
    harness.session.drafts.set("first.root", 0.25)
    harness.run_frames()
    assert harness.watch.looks == 2, "another picture: what was under way is of no use"


def test_it_goes_once_fixed(harness: Harness) -> None:
    assert harness.rest()
    harness.session.drafts.set("first.root", 0.25)
    assert harness.rest() == []
    harness.session.drafts.set("first.root", -0.25)
    assert harness.rest() == ["first", "second"]


def test_texture_map_shows_non_finite_texels_in_magenta(harness: Harness) -> None:
    assert harness.rest()
    first = harness.watch.non_finite[0]
    harness.bench.session.show(ref_of(first))
    assert harness.rest() == ["first", "second"], "what the map does not need is as it was"
    frame = harness.session.read()
    assert frame is not None
    magenta = (frame.array[..., :3] == (255, 0, 255)).all(axis=2)
    assert 0 < magenta.sum() <= 16
    x, y = place_in(first, (0.0, 0.0, 40.0, 40.0))
    assert magenta[int(y), int(x)]
    harness.session.drafts.set("first.root", 0.25)
    assert harness.rest() == []


def test_a_texture_that_was_read_since_changes_nothing(harness: Harness) -> None:
    harness.run_frames()
    harness.session.read_values("first:first")
    ran = list(harness.session.engine.record.ran)
    runs = dict(harness.session.engine.runs)
    assert harness.rest() == ["first", "second"]
    assert dict(harness.session.engine.runs) == runs and harness.session.engine.record.ran == ran, (
        "nothing ran again"
    )


def test_time_that_runs_is_looked_at_now_and_then(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Session, "animated", True)
    harness.session.clock.playing = True
    harness.run_frames(held=True)
    assert harness.watch.looks == 0
    harness.run_frames()
    seen = harness.watch.looks
    assert harness.watch.non_finite and seen > 0
    for _ in range(10):
        harness.session.redraw()
        harness.run_frames(0.05)
    assert harness.watch.looks == seen
    harness.run_frames(3.0)
    assert harness.watch.looks > seen


def test_a_map_is_placed_as_its_kernel_places_it() -> None:
    wide = NotFinite("p", "o", (0, 0), "NaN", 1, (200, 100))
    assert place_in(wide, (10.0, 20.0, 100.0, 100.0)) == (10.25, 20 + 100 - 25.25)
    named = replace(wide, path="a.b", output="c", value="infinity")
    assert summary((named,)) == "pass 'a.b', output 'c', makes infinity at texel (0, 0), 1 texel"


def test_the_words_lead_to_the_texture_and_back(
    any_engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from playground.studio.problems import panel as finite

    Harness(any_engine, tmp_path).session.release()
    bare = Bare(any_engine, tmp_path / "sketch.toml")
    try:
        bare._watch(finite.imgui, "small_button")
        watch = FiniteWatch(lambda: bare.time)
        draw = bare.draw

        def both() -> None:
            draw()
            watch.update(bare.session, held=False)
            finite.draw_not_finite(watch, bare.session, bare.theme, (400.0, 0.0, 880.0, 720.0))

        monkeypatch.setattr(bare, "draw", both)
        bare.run_frames(120)
        bare.click("Show it")
        assert bare.session.view.map is not None and bare.session.view.map.ref == "first:first"
        bare.click("Back to the picture")
        assert bare.session.view.map is None
    finally:
        bare.close()


def test_nothing_is_done_before_there_is_a_picture() -> None:
    nothing = SimpleNamespace(shown=None, plan=None)
    watch = FiniteWatch(lambda: 0.0)
    watch.update(nothing, held=False)  # type: ignore[arg-type]
    assert watch.patience is None and watch.looks == 0


LIT = """// lit.glsl -- light with a hole
#pragma kernel(output = "frame:rgba16f")
uniform float root = 0.0; //! slider(-1, 1)
uniform sampler2D height; //! input
vec4 kernel(ivec2 texel) {
    float found = texelFetch(height, ivec2(0), 0).r;
    return texel == ivec2(7, 5) ? vec4(sqrt(root)) : vec4(found, 0.25, 0.0, 1.0);
}
"""
SHOWN = """// shown.glsl -- what a screen takes
#pragma kernel(output = "frame:rgba8")
uniform sampler2D picture; //! input
vec4 kernel(ivec2 texel) { return clamp(texelFetch(picture, texel, 0), 0.0, 1.0); }
"""
VIEW = (
    passes(lit="./lit", shown=("./shown", 'inputs = { picture = "lit" }'))
    + """[inputs]
height = "lit.height"
[parameters]
root = "lit.root"
"""
)
IN_VIEW = """format = 1
size = 33
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "./look"
inputs = { height = "height" }
set = { root = -1.0 }
"""


@pytest.mark.parametrize(
    ("wired", "by_hand"),
    [
        ("", False),
        ('inputs = { height = "height" }\n', True),
        ('inputs = { "lit.height" = "height" }\n', False),
    ],
)
def test_a_hole_that_the_view_makes_is_shown_too(
    any_engine: Engine, tmp_path: Path, wired: str, by_hand: bool
) -> None:
    """Whichever way the view's inputs are wired, and whether its values come from the file or the hand."""
    sketch = IN_VIEW.replace('inputs = { height = "height" }\n', wired)
    if by_hand:
        sketch = sketch.replace("set = { root = -1.0 }\n", "")
    for name, text in (("lit.glsl", LIT), ("shown.glsl", SHOWN), ("look.toml", VIEW)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    harness = Harness(any_engine, tmp_path)
    (tmp_path / "sketch.toml").write_text(sketch, encoding="utf-8")
    harness.session.drafts.reload()
    harness.run_frames()
    if by_hand:
        harness.session.drafts.set("view.root", -1.0)
    harness.rest()
    (result,) = harness.watch.non_finite
    assert (result.path, result.texel, result.size, result.value) == ("view.lit", (7, 5), (40, 40), "NaN")
    ref = ref_of(result)
    assert ref == "view.lit:frame" and harness.session.can_show(ref)
    harness.bench.session.show(ref)
    harness.run_frames()
    assert (
        harness.session.view.map is not None and harness.session.error is None and not harness.session.notes
    )
    frame = harness.session.read()
    assert frame is not None
    magenta = np.argwhere((frame.array[::-1, :, :3] == (255, 0, 255)).all(axis=2))
    assert magenta.tolist() == [[5, 7]], "the texel itself, in a picture of its size"
    harness.rest()
    assert harness.watch.non_finite == (result,), "it has its own name, under any name in the map"
    harness.bench.session.show(None)
    harness.run_frames()
    harness.rest()
    assert harness.watch.non_finite == (result,)
    harness.session.release()


def test_what_the_view_lacks_cannot_be_shown(any_engine: Engine, tmp_path: Path) -> None:
    harness = Harness(any_engine, tmp_path)
    harness.run_frames()
    session = harness.session
    assert session.can_show("view:frame") and session.can_show("first:first")
    for wrong in ("view:light", "view.lit:frame", "other:frame", "first.view:first", "view"):
        assert not session.can_show(wrong)
    session.release()
