"""An ISF shader in the window: its inputs are widgets, an event is of one frame, a save is seen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from tests.isf_texts import TEXTS, VERTEX

from ..studio.panel_desk import Bare

COUNTING = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "again", "TYPE": "event", "LABEL": "Again!"},
  {"NAME": "mode", "TYPE": "long", "VALUES": [3, 7], "LABELS": ["three", "seven"], "DEFAULT": 3},
  {"NAME": "at", "TYPE": "point2D"}, {"NAME": "tint", "TYPE": "color"}, {"NAME": "on", "TYPE": "bool"}],
  "PASSES": [{"TARGET": "count", "PERSISTENT": true, "FLOAT": true, "WIDTH": "1", "HEIGHT": "1"}, {}]}*/
void main() {
    float now = IMG_PIXEL(count, vec2(0.5)).r;
    if (PASSINDEX == 0) gl_FragColor = vec4(again ? 0.0 : now + 1.0);
    vec4 others = tint + vec4(at, float(mode), on ? 1.0 : 0.0);
    if (PASSINDEX != 0) gl_FragColor = vec4(now / 255.0, 0.0, 0.0, 1.0) + 0.0 * others;
}
"""


@pytest.fixture
def opened(tmp_path: Path, any_engine: Engine):
    desks: list[Bare] = []

    def made(text: str, vertex: str = "") -> Bare:
        if vertex:
            (tmp_path / "a.vs").write_text(vertex, encoding="utf-8")
        (tmp_path / "a.fs").write_text(text, encoding="utf-8")
        desks.append(Bare(any_engine, tmp_path / "a.fs"))
        return desks[-1]

    yield made
    for item in desks:
        item.close()


def count(bare: Bare) -> int:
    frame = bare.session.read()
    assert frame is not None
    return int(frame.array[0, 0, 0])


def test_an_event_begins_anew_in_the_frame_that_is_shown(opened) -> None:
    bare = opened(COUNTING)
    bare.session.clock.time, bare.session.clock.paused = 0.5, True
    bare.run_frames(3)
    assert count(bare) == 31
    label = next(label for label in bare.places if label.startswith("Again!"))
    bare.point(label)
    bare.press(True)
    bare.press(False)
    seen = []
    for frame in range(31, 35):
        bare.session.clock.time = frame / 60
        bare.run_frames()
        seen.append(count(bare))
    assert seen == [0, 1, 2, 3]


def test_its_inputs_are_widgets_of_the_panel(opened) -> None:
    bare = opened(COUNTING)
    bare.run_frames(3)
    labels = " ".join(bare.places)
    assert "Again!" in labels and "at-x" in labels
    assert bare.session.error is None


@pytest.mark.parametrize("name", ["with_vertex", "persistent", "inputs", "audio", "transition", "imported"])
def test_it_is_drawn_in_the_window(opened, name: str) -> None:
    bare = opened(TEXTS[name], VERTEX.get(name, ""))
    bare.run_frames(3)
    frame = bare.session.read()
    assert bare.session.error is None and frame is not None
    assert len(np.unique(frame.array[..., :3].reshape(-1, 3), axis=0)) > 1


def test_a_saved_vertex_shader_is_followed(opened, tmp_path: Path) -> None:
    bare = opened(TEXTS["with_vertex_1"], VERTEX["with_vertex_1"])
    bare.run_frames(3)
    assert tmp_path / "a.vs" in bare.session.drafts.files
