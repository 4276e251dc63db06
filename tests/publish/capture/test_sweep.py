"""Sweeps: the given values are drawn, and written below; mistakes in one message."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.errors import ParameterError
from playground.publish.series import Paper, Series, Sheet, render_sweep, write_series
from playground.publish.sweep import columns_of, read_sweep

from ...loading import load
from ...sketch_texts import LIT_NOISE, SMALL_VIEW
from .series import pictures

SKETCH = "format = 1\nsize = 33\n" + LIT_NOISE + SMALL_VIEW


@pytest.fixture
def sketch(tmp_path: Path):
    (tmp_path / "small.toml").write_text(SKETCH, encoding="utf-8")
    return load(tmp_path / "small.toml")


def test_what_a_sweep_says(sketch):
    def values(text, steps=9):
        return read_sweep(sketch, text, steps).values

    assert values("light.gain=0.5..2.5", 5) == (0.5, 1.0, 1.5, 2.0, 2.5)
    assert values("light.gain=2..1,3") == (2.0, 1.5, 1.0)
    assert values("light.gain=1,2,4") == (1.0, 2.0, 4.0)
    assert values("height.seed=1..4,10") == (1, 2, 3, 4), "whole numbers, none twice"
    assert values("light.sun=135,25;250,12") == ((135.0, 25.0), (250.0, 12.0))
    assert values("light.sun.elevation=5..60", 12) == tuple(5.0 + 5.0 * k for k in range(12))
    assert values("view.sea=true,false") == (True, False)
    assert values("view.tone=none,film") == (0, 2)
    assert values("size=33,65") == ((33, 33), (65, 65))
    assert read_sweep(sketch, "view.tone=none,film").labels == ("none", "film")
    assert read_sweep(sketch, "light.sun_colour=#ff0000;#00ff00").labels == ("#ff0000", "#00ff00")
    assert len(read_sweep(sketch, "view.haze=0..1").values) == 9


def test_a_part_of_a_vector_leaves_the_rest(sketch):
    started = sketch.with_values({"light.sun": (200.0, 40.0)})
    column = Series.of_values(started, ["light.sun.elevation=5,60"])
    overrides = [dict(case.sketch.overrides)["light.sun"] for case in column.cases]
    assert overrides == [(200.0, 5.0), (200.0, 60.0)]
    grid = Series.of_values(started, ["light.sun.elevation=5,60", "light.sun.azimuth=0,90"])
    assert grid.columns == 2
    assert [dict(case.sketch.overrides)["light.sun"] for case in grid.cases] == [
        (0.0, 5.0),
        (0.0, 60.0),
        (90.0, 5.0),
        (90.0, 60.0),
    ]
    assert grid.cases[2].caption == ("light.sun.elevation = 5", "light.sun.azimuth = 90")


@pytest.mark.parametrize(
    ("count", "columns"), [(1, 1), (2, 2), (3, 3), (4, 2), (7, 3), (9, 3), (12, 4), (36, 6)]
)
def test_columns(count, columns):
    assert columns_of(count) == columns


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("light.gain", "expected PATH=FROM..TO"),
        ("=1..2", "expected PATH=FROM..TO"),
        ("light.gian=1..2", "did you mean 'light.gain'?"),
        ("light.sun.elevatoin=1..2", "light.sun has no part 'elevatoin'; did you mean 'elevation'?"),
        ("light.gain.x=1..2", "light.gain has no part 'x'"),
        ("light.gain=1..x", "expected two numbers, as 5..60"),
        ("light.gain=1..2,one", "'one' steps"),
        ("light.gain=1..2,1", "1 steps: expected 2 to"),
        ("light.gain=0..900", "is outside its range"),
        ("light.sun=1..2", "a range needs a number"),
        ("light.sun.elevation=50,100", "elevation 100 is outside -90 to 90"),
        ("light.gain=one", "expected a number"),
    ],
)
def test_a_mistake_is_one_sentence(sketch, text, message):
    with pytest.raises(ParameterError) as caught:
        Series.of_values(sketch, [text])
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_too_many(sketch):
    first, other = "light.gain=1..2,21", "view.haze=0..1,20"
    with pytest.raises(ParameterError, match="420 pictures are more than the 400"):
        Series.of_values(sketch, [first, other])
    with pytest.raises(ParameterError, match="expected two parameters"):
        Series.of_values(sketch, [first, first])
    with pytest.raises(ParameterError, match="3 sweeps"):
        Series.of_values(sketch, [first, other, first])


def test_a_sheet_holds_the_pictures_and_words_below_them(any_engine: Engine, sketch, tmp_path: Path):
    series = Series.of_values(sketch, ["light.gain=1,2,3,4"], size=(160, 90))
    write_series(any_engine, series, Sheet(tmp_path / "sheet.png"))
    png = read_png(tmp_path / "sheet.png")[0][..., :3]
    pitch = 90 + (png.shape[0] - 8) // 2 - 90
    assert png.shape[1] == 2 * (160 + 8) + 8
    for number, value in enumerate((1.0, 2.0, 3.0, 4.0)):
        down, along = divmod(number, 2)
        y, x = 8 + down * pitch, 8 + along * 168
        alone = any_engine.render(sketch.with_values({"light.gain": value}), size=(160, 90)).array
        np.testing.assert_array_equal(png[y : y + 90, x : x + 160], alone[..., :3])
        words = png[y + 90 : y + pitch - 8, x : x + 160]
        assert words.max() > 180 and words.min() < 40 and 0.01 < (words > 120).mean() < 0.4
        edges = words[:, [0, -1]]
        assert edges.max() < 60, "the words fit under the picture"


def test_small_pictures_have_legible_words(sketch):
    paper = Paper(Series.of_values(sketch, ["light.sun.elevation=5..60,4"], size=(96, 54)))
    for _ in range(4):
        paper.add(np.full((54, 96, 4), 128, np.uint8))
    assert (paper.array[8 + 54 : 8 + 54 + 14] > 150).any()


def test_pictures_come_in_order_and_the_terrain_is_made_once(any_engine: Engine, sketch):
    result = pictures(any_engine, Series.of_values(sketch, ["light.gain=1..4,4"], size=(32, 18)))
    means = [picture[..., :3].mean() for picture in result]
    assert means == sorted(means) and any_engine.runs["height"] == 1


def test_a_sweep_as_a_film(any_engine: Engine, sketch, tmp_path: Path):
    pytest.importorskip("av")
    from playground.publish.video import VideoFile, count_pictures

    series = Series.of_values(sketch, ["light.gain=1..4,5"], size=(64, 36))
    write_series(any_engine, series, VideoFile(tmp_path / "a.mp4"))
    assert count_pictures(tmp_path / "a.mp4") == (5, Fraction(4))


def test_render_sweep_needs_no_engine(sketch, tmp_path: Path):
    path = render_sweep(
        sketch, tmp_path / "a.png", "light.gain=1,2", "view.haze=0..1", steps=2, size=(64, 36)
    )
    assert read_png(path)[0].shape[1] == 2 * 72 + 8
