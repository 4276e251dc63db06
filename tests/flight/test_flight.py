"""A whole flight: what is recorded comes again, pictures have no holes, memory stays within its bound."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.engine.textures import read_picture
from playground.errors import DataError
from playground.flight.craft import STEP, Controls
from playground.flight.flight import Flight, count_frames, fly_again, write_frames
from playground.flight.record import Header, Moment, Record, Recorder, read_record
from playground.flight.scene import visibility_range

from ..loading import load

SIZE = (160, 90)


def weave(seconds: float, hour: float | None = None, radius: float = 2.0) -> Record:
    """Return a flight that weaves between the hills."""
    rng = np.random.default_rng(11)
    lines, steps = [], round(seconds / STEP)
    while steps > 0:
        count = min(int(rng.integers(5, 40)), steps)
        hands = Controls(*(int(n) for n in rng.integers(-60, 61, 4)))
        lines.append((count, Moment(hands, hour if len(lines) == 2 else None)))
        steps -= count
    return Record(Header("small", SIZE, {}, radius), tuple(lines))


# ── records ──────────────────────────────────────────────────────────────────


def test_what_is_recorded_is_read_again(tmp_path):
    moments = [Moment(Controls(10, -20, 30, 0))] * 50 + [Moment(Controls(), hour=17.5)]
    moments += [Moment(Controls())] * 9 + [Moment(Controls(100, 100, -100, 7), reset=True, hour=3.0)]
    header = Header("flight", (320, 180), {"daylight.hour": 8.0}, 3.0, (1.5, -2.0, 900.0, 90.0))
    with Recorder(tmp_path / "a.jsonl", header) as recorder:
        for moment in moments:
            recorder.add(moment)
    record = read_record(tmp_path / "a.jsonl")
    assert record.header == header and list(record) == moments and record.steps == 61
    rows = (tmp_path / "a.jsonl").read_text().splitlines()
    assert len(rows) == 7 and json.loads(rows[1]) == [50, 10, -20, 30, 0]


def test_flight_record_is_on_disk_within_one_second_unclosed(tmp_path):
    """A flight may end by a signal or a crash; steps alike wait no longer than others."""
    recorder = Recorder(tmp_path / "a.jsonl", Header("flight"))
    for _ in range(150):
        recorder.add(Moment(Controls(30)))
    assert read_record(tmp_path / "a.jsonl").steps == 120
    recorder.close()
    assert list(read_record(tmp_path / "a.jsonl")) == [Moment(Controls(30))] * 150


def test_a_line_that_was_cut_while_it_was_written_is_left_out(tmp_path):
    path = tmp_path / "cut.jsonl"
    path.write_text(GOOD + "\n[30, 0, 0, 0, 0]\n[3, 0, 0", encoding="utf-8")
    assert read_record(path).steps == 30


def test_a_file_that_is_there_is_never_written_over(tmp_path):
    (tmp_path / "mine.toml").write_text("precious")
    with pytest.raises(DataError, match="is there already; a flight is written to a new file"):
        Recorder(tmp_path / "mine.toml", Header("flight"))
    assert (tmp_path / "mine.toml").read_text() == "precious"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
def test_a_full_disk_is_reported_with_the_file_s_name():
    with pytest.raises(DataError, match="/dev/full: cannot be written: No space left"):
        Recorder("/dev/full", Header("flight"))


GOOD = Header("flight").line()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is no flight: its first line"),
        ("hello\n", "is no flight"),
        ('{"a": 1}\n', "is no flight"),
        (GOOD.replace('"version": 1', '"version": 9'), "of version 9; this playground reads version 1"),
        (GOOD.replace(str(STEP), "0.1"), "steps of 0.1 s"),
        (GOOD.replace("[640, 360]", "[640]"), "first line should have"),
        (GOOD + "\n[1, 0, 0]\n", r":2: \[1, 0, 0\]: expected \[steps, throttle"),
        (GOOD + "\n[1, 0, 0, 0, 0]\n[0, 0, 0, 0, 0]\n", ":3: .*1 to 86400 steps"),
        (GOOD + "\n[1, 0, 0, 101, 0]\n", "from -100 to 100"),
        (GOOD + "\n[1, 0, 0.5, 0, 0]\n", "in whole numbers"),
        (GOOD + '\n{"hours": 3}\n', "expected"),
        (GOOD + '\n{"hour": 1e999}\n', "expected"),
        (GOOD + "\n[1, 0, 0,\n", "is no JSON"),
        (GOOD + "\n[86400, 0, 0, 0, 0]" * 251 + "\n", "longer than a hundred hours"),
        (GOOD + "\n" + "[" * 100_000 + "\n", ":2: .*nested deeper than 64"),
        (GOOD + "\n" + "[" * 500 + "]" * 500 + "\n", ":2: .*nested deeper than 64"),
        (GOOD.replace('"values": {}', '"values": {"a": ' + "[" * 90 + "]" * 90 + "}"), "is no flight"),
    ],
)
def test_a_record_that_is_wrong_says_where_in_one_sentence(tmp_path, text, message):
    path = tmp_path / "bad.jsonl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match=message) as caught:
        read_record(path)
    assert str(caught.value).count("\n") == 0 and "bad.jsonl" in str(caught.value)


def test_a_record_that_is_not_there_or_is_no_text_says_so(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_record(tmp_path / "none.jsonl")
    (tmp_path / "png.jsonl").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(DataError, match="is no text"):
        read_record(tmp_path / "png.jsonl")
    with pytest.raises(DataError, match="cannot be written"):
        Recorder(tmp_path / "no" / "folder.jsonl", Header("flight"))


# ── replay ───────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_replay_is_bit_identical_cold_or_warm_at_any_interval(ctx, terrain_of, tmp_path):
    record, sketch = weave(4.0, 15.0, 1.2), terrain_of(daylight=True)
    seen = []
    with Engine(ctx, cache_bytes=2 * 2**20) as warm:
        for _ in range(2):  # the second time, parts are in the engine's memory
            pictures = write_frames(warm, sketch, record, tmp_path / str(len(seen)), every=80)
            seen.append([path.read_bytes() for path in pictures])
    with Engine(ctx, cache_bytes=1) as cold:
        rare = write_frames(cold, sketch, record, tmp_path / "rare", every=240)
    assert seen[0] == seen[1] and len(seen[0]) == count_frames(record, 80) == 4
    assert [path.name for path in rare] == ["frame-000000.png", "frame-000240.png"]
    assert [path.read_bytes() for path in rare] == [seen[0][0], seen[0][3]]
    picture, _ = read_png(rare[0])
    assert picture.shape == (90, 160, 4) and len({p for p in seen[0]}) == 4


@pytest.mark.slow
def test_recorded_live_flight_replays_same_path(small_engine, terrain_of, tmp_path):
    """Live, parts come by time and not by number: the way flown does not know of it."""
    sketch, record = terrain_of(), weave(6.0)
    with (
        Flight(small_engine, sketch, radius=2.0) as flight,
        Recorder(tmp_path / "a.jsonl", Header("small", SIZE, {}, 2.0)) as recorder,
    ):
        for number, moment in enumerate(record):
            recorder.add(moment)
            flight.step(moment, 0)
            if number % 7 == 0:
                flight.parts.tend_for(0.0)
        flown = flight.craft
    ends = [f.craft for f in fly_again(small_engine, sketch, read_record(tmp_path / "a.jsonl"))]
    assert len(ends) == 2 and ends[-1] == flown and flown.steps == 360


def test_reset_goes_back_to_the_start(small_engine, terrain_of):
    with Flight(small_engine, terrain_of(daylight=True), radius=1.5) as flight:
        first = flight.craft
        for _ in range(30):
            flight.step(Moment(Controls(50, 50, 50, 50), hour=20.0), 0)
        assert flight.hour == 20.0 and flight.craft.east != first.east
        flight.step(Moment(Controls(), reset=True), 0)
        assert flight.hour == 9.0 and flight.craft.steps == 31
        assert math.hypot(flight.craft.east - first.east, flight.craft.north - first.north) < 3


@pytest.mark.slow
def test_a_flight_of_ten_minutes_at_full_speed_keeps_its_memory(small_engine, terrain_of):
    """190 km over parts of 2.4 km: more than 100 of them pass, and no more than 30 are cached."""
    sketch = terrain_of(intervals=8, apron=2, spacing=300.0)
    steps = 600 * 60
    hands = [(steps // 3, Moment(Controls(100))), (steps // 3, Moment(Controls(100, 0, 4)))]
    record = Record(Header("small", SIZE, {}, 1.0), (*hands, (steps // 3, Moment(Controls(100, 2)))))
    flights = fly_again(small_engine, sketch, record)
    flight = next(flights)
    slots = flight.parts.limit
    flight = next(flights)
    assert flight.craft.steps == steps and flight.craft.seconds == pytest.approx(600.0)
    assert flight.parts.made > 100 and len(flight.parts.all_slots) <= slots < 30
    assert flight.parts.bytes == len(flight.parts.all_slots) * next(iter(flight.parts.slots.values())).bytes
    assert small_engine.cache.bytes <= small_engine.cache.limit
    assert small_engine.runner.pool.bytes <= small_engine.runner.pool.limit
    assert small_engine.runs["height.detail"] <= 3
    flights.close()


# ── pictures ─────────────────────────────────────────────────────────────────


@pytest.fixture
def flight(small_engine, terrain_of):
    with Flight(small_engine, terrain_of(), radius=3.0) as made:
        made.make_all()
        yield made


def rows_below_horizon(flight, size):
    """Return, for each pixel, how far the ray through it goes to height 0 [m]; inf above the horizon."""
    from playground.flight.craft import through

    lens = through(flight.craft, size, 50_000.0)
    x, y = np.meshgrid(
        (np.arange(size[0]) + 0.5) / size[0] * 2 - 1, 1 - (np.arange(size[1]) + 0.5) / size[1] * 2
    )
    away = np.stack([x, y, np.ones_like(x), np.ones_like(x)], -1) @ lens.near_from_clip.T.astype(float)
    away = away[..., :3] / away[..., 3:]
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    down = np.where(away[..., 2] < -1e-6, away[..., 2], -1e-6)
    return np.where(away[..., 2] < -1e-6, flight.craft.up / -down, np.inf) * np.hypot(
        away[..., 0], away[..., 1]
    )


def holes_within(flight, parts, size=SIZE):
    """Return how many pixels are magenta where a ray meets height 0 within so many parts."""
    picture = read_picture(flight.draw(size, bare=True)).astype(int)
    magenta = (picture[..., 0] > 250) & (picture[..., 1] < 5) & (picture[..., 2] > 250)
    return np.count_nonzero(magenta & (rows_below_horizon(flight, size) < parts * flight.plot.width))


@pytest.mark.slow
def test_there_is_no_hole_below_the_horizon_near_the_eye(flight):
    """Drawn over magenta, at every attitude: none of it where a ray meets height 0 within the parts made."""
    holes = looked = drawn = 0
    for number, moment in enumerate(weave(20.0)):
        flight.step(moment, 1)
        if number % 60:
            continue
        holes += holes_within(flight, 1.8)
        looked += np.count_nonzero(rows_below_horizon(flight, SIZE) < 1.8 * flight.plot.width)
        drawn += flight.scene.drawn
    assert holes == 0 and looked > 20_000 and drawn > 40


@pytest.mark.slow
def test_the_hole_finder_finds_a_hole(flight):
    part = flight.parts.part_at(flight.craft.east, flight.craft.north)
    ahead = (part[0], part[1] + 1)
    flight.parts.slots.pop(ahead)
    assert holes_within(flight, 1.8) > 50


@pytest.mark.slow
@pytest.mark.parametrize("skirt", [None, 0.0])
def test_skirts_close_cracks_between_levels(small_engine, terrain_of, monkeypatch, skirt):
    """Rough terrain, seen from low over borders of two levels; heights 0 to 900 m over 60 m of spacing."""
    if skirt is not None:
        monkeypatch.setattr("playground.flight.scene.SKIRT", skirt)
    rough = {"height.rough": 1.0, "height.valleys": 1.0, "height.gain": 0.9}
    cracks = 0
    with Flight(small_engine, terrain_of(**rough), radius=3.0) as flight:
        flight.make_all()
        for view in range(6):
            up = flight.floor(flight.craft.east, flight.craft.north) + 100.0 + 150.0 * (view % 3)
            flight.craft = replace(flight.craft, up=up, heading=view * 1.05, pitch=-0.25)
            cracks += holes_within(flight, 2.0, (640, 360))
    assert cracks == 0 if skirt is None else cracks > 10


def test_what_is_not_made_yet_is_neither_black_nor_magenta(small_engine, terrain_of):
    with Flight(small_engine, terrain_of(), radius=3.0) as flight:
        assert len(flight.parts) <= 1
        picture = read_picture(flight.draw(SIZE)).astype(int)
        lowest = picture[60:, :, :3]
        assert lowest.sum(axis=-1).min() > 60
        assert not ((picture[..., 0] > 200) & (picture[..., 1] < 60)).any()


@pytest.mark.slow
def test_where_the_terrain_ends_nothing_is_seen_of_it(flight):
    """Parts wholly beyond what one sees may shine as they like; any part nearer would be noticed."""
    flight.craft = replace(flight.craft, up=1100.0, pitch=-0.35, heading=0.4)
    width, here = flight.plot.width, np.array([flight.craft.east, flight.craft.north])
    whole = read_picture(flight.draw(SIZE)).astype(int)
    nearest = {
        part: np.hypot(*np.maximum(np.abs((np.array(part) + 0.5) * width - here) - width / 2, 0))
        for part in flight.parts.slots
    }
    beyond = [
        p for p, away in nearest.items() if away >= 0.98 * visibility_range(flight.parts.radius) * width
    ]
    changes = []
    for shining in (beyond, [p for p, away in nearest.items() if 0 < away < 1.5 * width]):
        for part in shining:
            flight.parts.slots[part].ground.write(np.full((17, 17, 4), 9.0, np.float16).tobytes())
            flight.parts.slots[part].ground.build_mipmaps()
        changes.append(np.abs(read_picture(flight.draw(SIZE)).astype(int) - whole).max())
    assert len(beyond) >= 4 and changes[0] <= 1 and changes[1] > 50


def test_near_terrain_has_more_triangles_and_rear_is_culled(flight):
    flight.draw(SIZE)
    whole = len(flight.parts.visible) * 2 * flight.plot.intervals**2
    assert 0 < flight.scene.triangles < whole / 2
    assert 0 < flight.scene.drawn < 0.7 * len(flight.parts.visible)


OWN = """// mine.glsl -- waves without end, and a hole where nothing is a number.
#include "terrain/parts.glsl"
#pragma kernel(output = "height:r32f")
uniform ivec2 part = ivec2(0);  //! Which part of the terrain
float kernel(ivec2 texel) {
    ivec2 node = node_of(texel, part, 0, size);
    if (node == ivec2(21, 40)) return uintBitsToFloat(0x7fc00000u);
    return 0.5 + 0.4 * sin(float(node.x) * 0.31) * cos(float(node.y) * 0.23);
}
"""


def test_own_terrain_can_be_flown_and_its_holes_crash_no_craft(small_engine, tmp_path):
    (tmp_path / "mine.glsl").write_text(OWN, encoding="utf-8")
    text = (
        'format = 1\nsize = 17\nextent = 640.0\nrelief = 200.0\n[[pass]]\nname = "height"\nuse = "./mine"\n'
    )
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")
    with Flight(small_engine, load(tmp_path / "own.toml"), radius=2.0, start=(840.0, 1450, 0, 0)) as flight:
        flight.make_all()
        assert np.isnan(small_engine.read(flight.plot.at((1, 2)), "height")[8, 5])
        for _ in range(120):
            flight.step(Controls(0, -100, 0, 0))
            assert flight.craft.up > flight.floor(flight.craft.east, flight.craft.north) >= 0.0
        assert flight.craft.north > 1660 and read_picture(flight.draw(SIZE))[..., :3].std() > 5
