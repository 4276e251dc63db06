"""The words of a beat do not wait for its picture."""

from __future__ import annotations

import pytest

from playground.course.talk.stage import Presenting, Stage
from playground.course.window.figure_view import FigureView

AREA = 0.0, 0.0, 320.0, 180.0


def test_beat_loads_sketch_after_text_and_skipped_beats_none(
    harness, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(harness.bench, harness.reader, lambda: None)
    assert harness.reader.open("halving", page=0, show=False)
    stage.begin(Presenting(notes=False))
    shown: list[str] = []
    monkeypatch.setattr(FigureView, "show", lambda view, scene, key, texts=None: shown.append(key[0]))

    def frame() -> bool:
        """Run a frame of the window; return whether it draws words alone."""
        turned = []
        harness.run_frames(1, around=lambda draw: turned.append((stage.act(AREA), stage.turned())[1]))
        return turned[0]

    frames = frame(), frame()
    assert frames == (True, False) and len(shown) == 1
    shown.clear()
    pictures = [
        n for n, beat in enumerate(stage.presenter.beats) if beat.kind in ("figure", "compare", "answer")
    ]
    stage.presenter.go(pictures[-2])
    stage.presenter.go(len(stage.presenter.beats) - 1)
    assert shown == [] and stage.patience == 0.0
    assert frame() and shown == [], "words"
    assert not frame() and shown == [stage.presenter.beat.still.block], "the picture, of the last beat alone"
    assert stage.patience > 0.0
