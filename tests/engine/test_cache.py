"""The cache's bookkeeping, and the states of loops that it keeps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from playground.engine import cache
from playground.engine.engine import Engine
from playground.engine.loops import MAX_STATES, KeptStates
from playground.engine.results import Pool, Result
from playground.sketch.model import Output

from ..loading import load
from ..sketch_texts import passes


def held(engine: Engine) -> int:
    return sum(cached.bytes for cached in engine.cache._cached.values())


@pytest.mark.slow
def test_bytes_are_those_of_what_is_cached(ctx):
    sketch = load("jacksboro").with_values({"size": 65, "view.grid": 33})
    with Engine(ctx, cache_bytes=3 * 2**20) as engine:
        for hour in range(3):
            moved = sketch.with_values({"light.sun": (100.0 + hour, 20.0)})
            engine.render(moved, size=(160, 90))  # mipmaps are made after a texture is put away
            assert engine.cache.bytes == held(engine)
            for iteration in (3, 5, 2):
                engine.read("diamond_square", "height", steps={"height": iteration})
                assert engine.cache.bytes == held(engine)
        assert 0 < engine.cache.bytes <= engine.cache.limit
        engine.cache.clear()
        assert engine.cache.bytes == held(engine) == 0


@pytest.mark.slow
def test_small_results_are_bounded_in_number_too(ctx, monkeypatch):
    monkeypatch.setattr(cache, "MAX_ENTRIES", 24)
    sketch = load("diamond_square").with_values({"size": 17, "view.grid": 17})
    with Engine(ctx) as engine:
        for seed in range(5):
            engine.render(sketch.with_values({"height.seed": seed}), size=(16, 9))
            assert len(engine.cache) <= 24
        engine.render(sketch.with_values({"height.seed": 4}), size=(16, 9))
        assert engine.record.ran == [], "the newest are cached"


@pytest.mark.slow
def test_changing_pass_keeps_few_versions_and_reuses_textures(ctx):
    sketch = load("diamond_square").with_values({"size": 17, "view.grid": 17})
    with Engine(ctx) as engine:
        made = []
        for number in range(20):
            engine.render(sketch.with_values({"light.sun": (10.0 * number, 30.0)}), size=(16, 9))
            made.append(engine.runner.pool.made)
        assert made[-1] == made[cache.VERSIONS], "no texture is made for what is dragged on"
        engine.render(sketch.with_values({"light.sun": (170.0, 30.0)}), size=(16, 9))
        assert "height" not in engine.record.ran and not [p for p in engine.record.ran if "light" in p]
        engine.render(sketch.with_values({"light.sun": (0.0, 30.0)}), size=(16, 9))
        assert [path for path in engine.record.ran if "light" in path], "so long ago is forgotten"
        assert "height" not in engine.record.ran, "what has stayed is one version"


def test_versions_that_a_frame_uses_stay(ctx):
    """A sketch of which one pass is at more sizes, and one that comes again, are not taken for versions."""
    pool = Pool(ctx, 2**20)
    kept = cache.Cache(2**30, pool)
    output = Output("height", "r32f")
    kept.begin()
    for number in range(cache.VERSIONS + 3):
        kept.put(f"{number}", cache.Cached({"a": pool.take((4, 4), [output])}))
    assert len(kept) == cache.VERSIONS + 3, "all are in use"
    kept.end()
    kept.begin()
    kept.get("0")
    kept.put("new", cache.Cached({"a": pool.take((4, 4), [output])}))
    kept.put("other size", cache.Cached({"a": pool.take((8, 4), [output])}))
    kept.end()
    newest = [f"{number}" for number in range(cache.VERSIONS + 1, cache.VERSIONS + 3)]
    assert {key for key in ("0", "new", "other size", *newest) if key in kept} == {
        "0",
        "new",
        "other size",
        *newest,
    }
    assert len(kept) == cache.VERSIONS + 1
    kept.clear()
    pool.clear()


@pytest.mark.parametrize(("passes", "made"), [("a", 3), ("abcd", 4)])
def test_large_textures_of_the_last_frame_are_used_again(ctx, passes, made):
    """One texture fits three times, but no spare one; of a frame of four, the fourth is over the bound."""
    output, item = Output("height", "r32f"), 64 * 64 * 4
    pool = Pool(ctx, item // 8)
    kept = cache.Cache(3 * item, pool)
    for number in range(6):
        kept.begin()
        for name in passes:
            kept.put(f"{name} {number}", cache.Cached({name: pool.take((64, 64), [output])}))
            assert kept.bytes + pool.bytes <= max(3, len(passes)) * item, "never more than a frame needs"
        kept.end()
        assert pool.made <= made, number
    kept.begin()
    kept.put("small", cache.Cached({"small": pool.take((4, 4), [output])}))
    kept.end()
    assert kept.bytes <= 3 * item and pool.bytes <= pool.limit, "a frame of less has the bound hold again"
    kept.clear()
    pool.clear()


@pytest.mark.slow
def test_reused_texture_has_no_stale_mipmaps(ctx):
    sketch = load("jacksboro").with_values({"size": 65, "view.grid": 33})
    suns = [sketch.with_values({"light.sun": (20.0 * number, 15.0)}) for number in range(cache.VERSIONS + 4)]
    with Engine(ctx) as engine, Engine(ctx) as fresh:
        for moved in suns:
            array = engine.render(moved, size=(80, 45)).array
        np.testing.assert_array_equal(array, fresh.render(suns[-1], size=(80, 45)).array)


def test_levels_of_a_texture_that_is_used_again_are_weighed(ctx):
    pool, output = Pool(ctx, 2**20), Output("height", "r32f")
    first = pool.take((8, 8), [output])
    first.textures["height"].build_mipmaps()
    first.mipmapped.add("height")
    weight = first.bytes
    pool.give(first)
    again = pool.take((8, 8), [Output("light", "r32f")])
    assert pool.made == 1 and again.bytes == weight == 256 + 256 // 3
    assert not again.mipmapped and again.textures["light"].filter == (ctx.LINEAR, ctx.LINEAR)
    again.release()


# ── Loops that follow the time go back to earlier states, which change nothing but the cost


GROW = """#pragma kernel(output = "state:r32f")
uniform sampler2D own;     //! input("zero")
uniform float rate = 3.7;  //! slider(3, 4)
float kernel(ivec2 texel) {
    float x = texelFetch(own, texel, 0).r;
    return time == 0.0 ? 0.25 + 0.5 * float(texel.x * 7 + texel.y * 3) / 200.0 : rate * x * (1.0 - x);
}
"""
SHOW = """#pragma kernel(output = "shown:r32f")
uniform sampler2D state;  //! input
float kernel(ivec2 texel) { return 2.0 * texelFetch(state, texel, 0).r; }
"""
TOML = passes(
    grow=("./step", 'repeat = "frames"', 'feedback = { own = "state" }'),
    after=("./show", 'inputs = { state = "grow:shown" }'),
)


@pytest.fixture
def sketch(folder):
    folder.write("grow.glsl", GROW)
    folder.write("show.glsl", SHOW)
    inner = passes(state="./grow", shown="./show") + '[inputs]\nown = "state.own"\n'
    folder.write("step.toml", inner + '[outputs]\nstate = "state:state"\nshown = "shown:shown"\n')
    return folder.sketch(TOML)


def after(engine: Engine, sketch, frame: int) -> np.ndarray:
    return engine.read(sketch, "after", time=frame / 60).copy()


def steps_of(engine: Engine, sketch, frame: int) -> int:
    """Return how many frames a picture runs."""
    before = engine.runs["grow.state"]
    engine.texture(sketch, "after", time=frame / 60)
    return engine.runs["grow.state"] - before


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_times_in_any_order_match_cold_engine_bit_for_bit(ctx, sketch, seed):
    with Engine(ctx) as cold:
        truth = {}
        for frame in range(400):
            truth[frame] = after(cold, sketch, frame)
    frames = np.random.default_rng(seed).integers(0, 400, 60)
    with Engine(ctx) as warm:
        for frame in frames:
            np.testing.assert_array_equal(after(warm, sketch, int(frame)), truth[frame])
    with Engine(ctx) as engine:
        np.testing.assert_array_equal(after(engine, sketch, int(frames[0])), truth[frames[0]])


@pytest.mark.slow
def test_going_back_frame_by_frame_runs_few_frames(any_engine, sketch):
    assert steps_of(any_engine, sketch, 600) == 601
    back = [steps_of(any_engine, sketch, frame) for frame in range(599, -1, -1)]
    # With s states, r runs of each frame go back over (s + r)! / (s! r!) frames (Griewank 1992); 48
    # states and 600 frames need 2. One frame more: a state is only what is fed back.
    assert sum(back) <= 3 * 600
    assert steps_of(any_engine, sketch, 600) < 601, "and what lies ahead is not forgotten"


@pytest.mark.slow
def test_a_jump_back_costs_a_share_of_its_distance(any_engine, sketch):
    steps_of(any_engine, sketch, 3000)
    assert steps_of(any_engine, sketch, 2000) <= 500
    assert steps_of(any_engine, sketch, 2900) <= 1 + 900 // 2


class FakePool:
    def __init__(self) -> None:
        self.released: list[Result] = []

    def give(self, result: Result) -> None:
        self.released.append(result)


class Sized(Result):
    @property
    def bytes(self) -> int:
        return 4 * self.size[0]


def of_bytes(count: int) -> dict[str, Result]:
    return {"a": Sized((count // 4, 1), (), {})}


@pytest.mark.slow
@pytest.mark.parametrize("last", [600, 36_000])
def test_gaps_grow_with_the_distance(last):
    kept = KeptStates(10**9, FakePool())  # type: ignore[arg-type]
    for number in range(1, last):
        kept.keep("loop", "key", number, of_bytes(4), last)
    numbers = (0, *kept.numbers("loop", "key"), last)
    assert len(numbers) == MAX_STATES + 2
    # Evenly in the logarithm, each state would be q times as far away as the next; where one goes, q².
    share = last ** (2 / MAX_STATES) - 1
    for before, number in itertools.pairwise(numbers[:-1]):
        assert number - before <= 1 + share * (last - number + 1)


@pytest.mark.parametrize("last", [40, 600, 36_000])
def test_kept_states_of_long_run_are_few_with_growing_gaps(last):
    kept = KeptStates(10**9, FakePool())  # type: ignore[arg-type]
    due = [n for n in range(1, last) if kept.is_due("loop", "key", n, last) and not kept_at(kept, n, last)]
    assert due == list(kept.numbers("loop", "key")), "none is kept that would go again"
    # Evenly in the logarithm, each state would be q times as far away as the next.
    share = last ** (1 / MAX_STATES) - 1
    for before, number in itertools.pairwise((0, *due, last)):
        assert number - before <= 1 + share * (last - number + 1)
    assert not any(kept.is_due("loop", "key", number, last) for number in due), "it is there"


def kept_at(kept: KeptStates, number: int, last: int) -> None:
    kept.keep("loop", "key", number, of_bytes(4), last)


def test_states_are_bounded_in_bytes_and_of_the_last_two_keys():
    pool = FakePool()
    kept = KeptStates(100, pool)  # type: ignore[arg-type]
    for number in range(1, 50):
        kept.keep("loop", "one", number, of_bytes(8), number + 1)
        assert kept.bytes <= 100
    assert len(kept) == 12
    for number in range(1, 50):
        kept.keep("loop", "two", number, of_bytes(8), number + 1)
        assert kept.bytes <= 100
    assert len(kept.numbers("loop", "one")) in (5, 6, 7), "they share"
    kept.keep("loop", "three", 1, of_bytes(8), 2)
    assert not kept.numbers("loop", "one"), "gone when the key has changed twice"
    assert len(pool.released) == 99 - len(kept), "each is given back, once"
    kept.clear()
    assert (len(pool.released), len(kept), kept.bytes) == (99, 0, 0)


def test_a_state_that_is_larger_than_the_bound_is_not_kept():
    kept = KeptStates(100, FakePool())  # type: ignore[arg-type]
    kept.keep("loop", "key", 1, of_bytes(104), 2)
    assert (len(kept), kept.bytes) == (0, 0)


def test_the_cache_counts_and_drops_them(ctx, sketch):
    with Engine(ctx, cache_bytes=40 * 17 * 17 * 4) as engine:
        steps_of(engine, sketch, 200)
        states = engine.cache.states
        assert 2 <= len(states) <= 10, "a quarter of the bytes"
        assert engine.cache.bytes <= engine.cache.limit
        bare = engine.cache.bytes - states.bytes
        engine.cache.limit = bare + 17 * 17 * 4
        assert steps_of(engine, sketch, 200) == 0
        assert engine.cache.bytes <= engine.cache.limit
        assert len(states) <= 1
        engine.cache.clear()
        assert engine.cache.bytes == 0


def test_changed_value_restarts_loop_and_forget_frees_old_states(any_engine, sketch):
    steps_of(any_engine, sketch, 100)
    assert steps_of(any_engine, sketch.with_values({"grow.state.rate": 3.5}), 50) == 51
    assert steps_of(any_engine, sketch, 50) < 51, "of two versions, both are kept"
    any_engine.forget_unused()
    assert steps_of(any_engine, sketch.with_values({"grow.state.rate": 3.5}), 40) == 41


def test_failed_frame_after_rewind_leaves_no_partial_state(any_engine, sketch, monkeypatch):
    truth = {frame: after(any_engine, sketch, frame) for frame in (30, 50)}
    steps_of(any_engine, sketch, 100)
    run = any_engine.runner.run

    def fails(step, *arguments, **named):
        if step.path == "grow.shown":
            raise RuntimeError("on purpose")
        return run(step, *arguments, **named)

    with monkeypatch.context() as broken:
        broken.setattr(any_engine.runner, "run", fails)
        with pytest.raises(RuntimeError, match="on purpose"):
            any_engine.texture(sketch, "after", time=50 / 60)
    for frame, expected in truth.items():
        np.testing.assert_array_equal(after(any_engine, sketch, frame), expected)


def test_a_film_goes_on_from_frame_to_frame(any_engine, sketch):
    for frame in range(0, 120, 2):
        any_engine.texture(sketch, "after", time=frame / 60)
        any_engine.forget_unused()
    assert any_engine.runs["grow.state"] == 119
