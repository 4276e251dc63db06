"""Sweeps for research: each case is the picture and the heights that its values give, whoever draws it."""

from __future__ import annotations

import re
import sys

import numpy as np
import pytest

import playground
from playground.extras import install_command
from playground.publish import sweep_data
from playground.publish.sweep_data import sweep

xarray = pytest.importorskip("xarray")
SIZE = (48, 27)
SEEDS, RELIEFS = [3, 1], [200.0, 400.0, 800.0]


@pytest.fixture(scope="module")
def sketch() -> playground.Sketch:
    return playground.load("diamond_square").with_values({"size": 33})


@pytest.fixture(scope="module")
def alone(sketch):
    """Give a sweep that one process draws."""
    return sweep(sketch, {"height.seed": SEEDS, "relief": RELIEFS}, size=SIZE, workers=1)


@pytest.mark.slow
def test_each_case_is_what_its_values_give(engine, sketch, alone):
    assert dict(alone.sizes) == {"height.seed": 2, "relief": 3, "row": 27, "column": 48, "channel": 4}
    assert alone["relief"].values.tolist() == RELIEFS and alone["height.seed"].values.tolist() == SEEDS
    assert alone["relief"].attrs["units"] == "m" and alone["height.mean"].attrs["units"] == "m"
    if engine.driver != "fragment":
        return  # the workers choose drivers by themselves; the numbers are compared with one
    for seed in SEEDS:
        for relief in RELIEFS:
            item = sketch.with_values({"height.seed": seed, "relief": relief})
            metres = engine.metres(item, "height").astype(np.float64)
            case = alone.sel({"height.seed": seed, "relief": relief})
            for name in ("mean", "min", "max", "std"):
                expected = getattr(np, name)(metres)
                assert float(case[f"height.{name}"]) == pytest.approx(expected, rel=1e-5), name
            picture = engine.render(item, size=SIZE).array.astype(int)
            assert np.abs(case["picture"].values.astype(int) - picture).max() <= 1


@pytest.mark.slow
def test_more_workers_find_the_same(sketch, alone):
    several = sweep(sketch, {"height.seed": SEEDS, "relief": RELIEFS}, size=SIZE, workers=2)
    xarray.testing.assert_identical(several, alone)
    pictures = alone["picture"].values.reshape(6, -1)
    assert len({picture.tobytes() for picture in pictures}) == 6, "no two are the same picture"


@pytest.mark.slow
def test_vectors_parts_menus_and_arrays_are_coordinates(tmp_path):
    hills = np.hypot(*np.mgrid[-1:1:9j, -1:1:9j])
    dataset = sweep(
        "jacksboro",
        {
            "height.elevation": [hills, hills * hills],
            "light.sun": [(135, 25), {"azimuth": 250.0, "elevation": 12.5}],
            "height.no_data": ["fill"],
        },
        textures=["height", "light"],
        pictures=False,
        workers=1,
    )
    assert dataset["light.sun"].values.tolist() == ["135,25", "250,12.5"]
    assert dataset["light.sun.azimuth"].dims == ("light.sun",)
    assert dataset["light.sun.elevation"].values.tolist() == [25.0, 12.5]
    assert dataset["height.no_data"].values.tolist() == ["fill"]
    assert dataset.sizes["height.elevation"] == 2 and "picture" not in dataset
    assert (dataset["light.mean"].isel({"light.sun": 0}) > dataset["light.mean"].isel({"light.sun": 1})).all()
    means = dataset["height.mean"].isel({"light.sun": 0, "height.no_data": 0}).values
    np.testing.assert_allclose(means, [hills.mean(), (hills * hills).mean()], rtol=1e-5)  # metres


@pytest.mark.slow
def test_a_mistake_of_the_sketch_crosses_from_the_process(sketch):
    with pytest.raises(playground.SketchError, match="no pass 'hight'"):
        sweep(sketch, {"relief": [1.0]}, textures=["hight"], workers=1)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({}, "a sweep of nothing"),
        ({"relief": []}, "expected one value or more"),
        ({"relief": 5.0}, r"expected its values, as \[1, 2, 4\]; found 5.0"),
        ({"relief": [1, 1.0]}, "1 is there twice"),
        ({"height.sead": [1]}, "did you mean 'height.seed'"),
        ({"height.smoothing": [0.5, 7]}, "outside its range"),
        ({"relief": "1..2,x"}, "expected a whole number from 2"),
        ({"relief": np.arange(1, 300.0), "height.seed": range(1, 300)}, "GiB; 4 are the most"),
    ],
)
def test_unsweepable_values_are_refused_before_drawing(sketch, values, sentence, monkeypatch):
    monkeypatch.setattr(sweep_data, "_drawn", lambda *_: pytest.fail("it began"))
    with pytest.raises(playground.ParameterError, match=sentence):
        sweep(sketch, values)


def test_a_part_and_its_whole_are_refused_together(monkeypatch):
    with pytest.raises(
        playground.ParameterError, match=r"light\.sun and of light\.sun\.azimuth: expected one"
    ):
        sweep("jacksboro", {"light.sun": [(10, 20)], "light.sun.azimuth": [10, 20]})
    with pytest.raises(playground.ParameterError, match="workers = 0: expected a whole number from 1"):
        sweep("jacksboro", {"relief": [1.0]}, workers=0)


def test_without_xarray_it_says_what_to_install(sketch, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(playground.PlaygroundError, match=re.escape(install_command("research"))):
        sweep(sketch, {"relief": [1.0]})


def test_the_bar_is_for_terminals(sketch, monkeypatch, capsys):
    for terminal in (False, True):
        monkeypatch.setattr(sys.stderr, "isatty", lambda shown=terminal: shown, raising=False)
        sweep(sketch, {"relief": [1.0]}, pictures=False, workers=1)
        assert ("sweep of" in capsys.readouterr().err) == terminal
