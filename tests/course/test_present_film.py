"""A presentation as a film: each beat as long as it is read, picture and strip, subtitles next to it."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.course.read import read_lesson
from playground.course.talk.beats import seconds_of
from playground.course.talk.film import FPS, film_of, write_presentation
from playground.engine.engine import Engine

from .lesson_desk import shelved

av = pytest.importorskip("av")
SIZE = 192, 108


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shelved(monkeypatch, tmp_path)
    return tmp_path


@pytest.mark.slow
def test_a_lesson_is_filmed_with_its_notes_as_subtitles(folder: Path, any_engine: Engine) -> None:
    film = film_of(read_lesson("halving", "fr"), folder / "talk.mp4", SIZE)
    video, subtitles = write_presentation(any_engine, film)
    with av.open(str(video)) as container:
        stream = container.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert stream.average_rate == FPS
    assert len(pictures) == sum(film.counts)
    starts = np.cumsum([0, *film.counts])
    for beat, count in zip(film.beats, film.counts, strict=True):
        assert count >= round(seconds_of(beat) * FPS) and count >= 3 * FPS
    edge = film.sizes.picture[1]

    def change(one: int, other: int, *, strip: bool) -> float:
        pair = [
            pictures[n].astype(int)[edge + 4 :] if strip else pictures[n].astype(int)[:edge]
            for n in (one, other)
        ]
        return float(np.abs(pair[0] - pair[1]).mean())

    sweep = next(n for n, beat in enumerate(film.beats) if beat.kind == "sweep")
    first, last = starts[sweep], starts[sweep + 1] - 1
    assert change(first, last, strip=False) > 2, "the value moves"
    assert change(first, last, strip=True) < 1, "its strip stays"
    assert change(last, starts[sweep + 1], strip=True) > 1, "another beat says something else"
    bug = next(n for n, beat in enumerate(film.beats) if beat.kind == "fix")
    assert change(starts[bug] - 1, starts[bug], strip=False) > 1, "the fixed picture is another"
    text = subtitles.read_text("utf-8")
    assert subtitles.name == "talk.srt" and "Une moyenne divise par leur nombre." in text
    assert "{{" not in text and text.index("Quatre coins") < text.index("Rugosité.")
    end = text.rstrip().rsplit("-->", 1)[1].split()[0]
    hours, minutes, seconds = end.replace(",", ".").split(":")
    assert int(hours) * 3600 + int(minutes) * 60 + float(seconds) == pytest.approx(film.seconds, abs=0.002)
    assert Fraction(len(pictures)) / FPS == Fraction(film.seconds).limit_denominator(100)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("halvin",), "no lesson 'halvin'; did you mean 'halving'?"),
        (("halving", "--from", "99"), "--from 99: lesson halving has beats 1 to "),
        (("halving", "--lang", "frr"), "--lang frr: no such language; did you mean 'fr'?"),
        (("halving", "--video", "talk.mov"), "a video is written to a name ending in .mp4"),
        (("halving", "--video", "talk.mp4", "--size", "161x90"), "both must be even"),
    ],
)
def test_a_mistake_is_a_sentence(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], words: str
) -> None:
    assert main(["lesson", "present", *arguments]) == 2
    error = capsys.readouterr().err
    assert words in error and "Traceback" not in error
