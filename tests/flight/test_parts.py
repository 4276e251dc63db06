"""The parts around the eye: which are made and dropped, what they hold, and that they come back the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.textures import read_texture
from playground.errors import SketchError
from playground.flight.layout import plot_of
from playground.flight.parts import Parts

from ..loading import load


@pytest.fixture
def parts(small_engine, terrain_of):
    made = Parts(small_engine, plot_of(terrain_of(), small_engine), 3.0)
    yield made
    made.release()


def middle(plot, part):
    return tuple((n + 0.5) * plot.width for n in part)


def contents(slot):
    return read_texture(slot.heights), read_texture(slot.ground)


def test_a_plot_is_the_sketch_less_its_apron(small_engine, terrain_of):
    plot = plot_of(terrain_of(intervals=24, apron=5, spacing=40.0), small_engine)
    assert (plot.intervals, plot.apron, plot.ground, plot.width) == (24, 5, 25, 960.0)
    assert plot.spacing == pytest.approx(40.0) and plot.part_paths == ("height.part", "colour.part")
    assert plot.at((3, -4)).overrides == (("height.part", (3, -4)), ("colour.part", (3, -4)))
    assert plot.hour == "" and plot_of(terrain_of(daylight=True), small_engine).hour == "daylight.hour"


def test_a_part_is_cut_out_of_what_the_sketch_makes(parts):
    plot, engine = parts.plot, parts.engine
    slot = parts.make((5, 2))
    sketch = plot.at((5, 2))
    cut = slice(plot.apron, plot.apron + plot.intervals + 1)
    height = engine.read(sketch, "height")[cut, cut]
    lit = engine.read(sketch, "colour")[cut, cut, :3] * engine.read(sketch, "light")[cut, cut, :3]
    result, ground = contents(slot)
    np.testing.assert_array_equal(result, height)
    np.testing.assert_array_equal(slot.nodes, height)
    np.testing.assert_allclose(ground[..., :3], lit, rtol=2e-3, atol=1e-4)
    np.testing.assert_allclose(slot.mean[:3], lit.mean(axis=(0, 1)), rtol=0.15)


def test_colour_finer_than_the_height_is_cut_at_its_own_texels(small_engine, terrain_of, tmp_path):
    text = tmp_path / "fine.toml"
    sketch = terrain_of()
    source = Path(sketch.file).read_text("utf-8")
    text.write_text(
        source.replace('use = "texturing/endless_ground"\n', 'use = "texturing/endless_ground"\nsize = 65\n')
    )
    plot = plot_of(load(text), small_engine)
    made = Parts(small_engine, plot, 1.0)
    assert plot.ground == 33
    _, ground = contents(made.make((0, 0)))
    colour = small_engine.read(plot.at((0, 0)), "colour")[16:49, 16:49, :3]
    light = small_engine.read(plot.at((0, 0)), "light")[8:25, 8:25, :3]
    np.testing.assert_allclose(ground[::2, ::2, :3], colour[::2, ::2] * light, rtol=2e-3, atol=1e-4)
    between = colour[::2, 1::2] * (light[:, :-1] + light[:, 1:]) / 2
    np.testing.assert_allclose(ground[::2, 1::2, :3], between, rtol=4e-3, atol=1e-3)
    made.release()


def test_neighbours_share_their_border_to_the_last_bit(parts):
    here, east, north = (contents(parts.make(p))[0] for p in ((-1, -1), (0, -1), (-1, 0)))
    np.testing.assert_array_equal(here[:, -1], east[:, 0])
    np.testing.assert_array_equal(here[-1], north[0])


def test_nearest_parts_come_first_and_visible_before_rear(parts):
    parts.look(*middle(parts.plot, (0, 0)), 0.0)  # to the north
    first = parts.visible[0]
    assert first == (0, 0)
    assert parts.visible.index((0, 2)) < parts.visible.index((0, -2))
    assert parts.tend(4) == 4 and set(parts.slots) == set(parts.visible[:4])
    far = [np.hypot(*p) for p in parts.visible]
    assert max(far) <= 3.0 and len(parts.visible) == 29


@pytest.mark.slow
def test_dropped_part_is_rebuilt_with_same_bits(small_engine, terrain_of):
    with Engine(small_engine.ctx, cache_bytes=2**20) as forgetful:
        parts = Parts(forgetful, plot_of(terrain_of(), forgetful), 2.0)
        first = contents(parts.make((0, 0)))
        for step in range(2, 14, 3):
            parts.look(*middle(parts.plot, (step, step // 2)), 1.0)
            parts.tend(100)
        assert (0, 0) not in parts.slots
        again = contents(parts.make((0, 0)))
        for a, b in zip(first, again, strict=True):
            np.testing.assert_array_equal(a, b)
        parts.release()


@pytest.mark.slow
def test_memory_is_bounded_and_the_farthest_go_first(parts):
    for step in range(0, 16, 2):
        parts.look(*middle(parts.plot, (step, 0)), 1.57)
        parts.tend(100)
        assert len(parts) <= parts.limit
        assert set(parts.visible) <= set(parts.slots)
    slot = next(iter(parts.slots.values()))
    assert parts.bytes == parts.limit * slot.bytes
    assert min(p[0] for p in parts.slots) > 6


def test_work_for_some_time_ends_where_whole_parts_would(small_engine, terrain_of):
    """In stages, with no time left for more than one a picture, the same parts come with the same bits."""
    plot = plot_of(terrain_of(), small_engine)
    whole, staged = Parts(small_engine, plot, 1.5), Parts(small_engine, plot, 1.5)
    for parts in (whole, staged):
        parts.look(*middle(plot, (4, 4)), 0.3)
    whole.tend(100)
    stages = 0
    while staged.missing:
        stages += staged.tend_for(0.0)
    assert stages == 4 * len(staged.visible) == 4 * staged.made
    assert staged.tend_for(1.0) == 0, "nothing is left to do"
    for part in whole.visible:
        for a, b in zip(contents(whole.slots[part]), contents(staged.slots[part]), strict=True):
            np.testing.assert_array_equal(a, b)
    whole.release()
    staged.release()


def test_new_hour_relights_nearest_first_and_keeps_terrain(small_engine, terrain_of):
    plot = plot_of(terrain_of(daylight=True), small_engine)
    parts = Parts(small_engine, plot, 1.0)
    parts.look(*middle(plot, (0, 0)), 0.0)
    parts.tend(100)
    before = {p: contents(parts.slots[p]) for p in parts.visible}
    heights = small_engine.runs["height.shape"]
    parts.hour = 15.0
    assert parts.missing == len(parts.visible) == 5
    parts.tend(1)
    assert parts.slots[(0, 0)].hour == 15.0 and parts.missing == 4
    parts.tend(100)
    assert parts.missing == 0 and small_engine.runs["height.shape"] == heights
    for part, (height, ground) in before.items():
        now = contents(parts.slots[part])
        np.testing.assert_array_equal(now[0], height)
        assert np.abs(now[1] - ground).max() > 0.01
    parts.release()


def test_the_ground_at_a_place_is_the_highest_node_around_it(parts):
    plot = parts.plot
    rng = np.random.default_rng(2)
    for east, north in rng.uniform(-3, 3, (50, 2)) * plot.width:
        part = parts.part_at(east, north)
        nodes = parts.make(part).nodes if part not in parts.slots else parts.slots[part].nodes
        x = int((east - part[0] * plot.width) // plot.spacing)
        y = int((north - part[1] * plot.width) // plot.spacing)
        expected = nodes[y : y + 2, x : x + 2].max() * plot.relief
        assert parts.ground_at(east, north) == pytest.approx(float(expected))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('name = "height"', 'name = "land"'), "no pass named 'height'"),
        (("generation/endless", "generation/white_noise"), "has no parameter 'part'"),
        (("apron = 8, hills", "apron = 16, hills"), "leave a part of 0 intervals"),
        (("size = 33", "size = [33, 65]"), "parts are as wide as they are long"),
        (
            ('use = "texturing/endless_ground"', 'use = "texturing/endless_ground"\nsize = 50'),
            "50 x 50 texels",
        ),
    ],
)
def test_a_sketch_that_cannot_be_flown_over_says_why(small_engine, terrain_of, tmp_path, change, message):
    text = Path(terrain_of().file).read_text("utf-8")
    path = tmp_path / "other.toml"
    text = text.replace(*change)
    if "white_noise" in change[1]:
        text = text.replace('set = { apron = 8, hills = 64, "detail.octaves" = 3 }\n', "")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SketchError, match="cannot be flown over: ") as caught:
        plot_of(load(path), small_engine)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_every_pass_gets_the_height_s_apron(small_engine, terrain_of):
    """A colour made with another would not meet its neighbour's."""
    sketch = terrain_of(intervals=16, apron=8).with_values({"colour.apron": 3})
    plot = plot_of(sketch, small_engine)
    assert dict(plot.at((0, 0)).overrides)["colour.apron"] == 8


def test_shadows_that_reach_beyond_the_apron_are_refused(small_engine, terrain_of):
    sketch = terrain_of(intervals=16, apron=8).with_values({"light.max_distance": 9})
    with pytest.raises(SketchError, match=r"shadows reach 9 texels .* only 8 .* set light.max_distance=8"):
        plot_of(sketch, small_engine)
    assert plot_of(sketch.with_values({"light.max_distance": 8}), small_engine).apron == 8


def test_parts_exceeding_memory_are_refused_before_building(small_engine, terrain_of):
    plot = replace(plot_of(terrain_of(), small_engine), intervals=1024, ground=2049)
    with pytest.raises(SketchError, match=r"are more than 2 GiB; --radius 2 would fit"):
        Parts(small_engine, plot, 16.0)
