"""The cache's bookkeeping: its bytes are those of what it holds, after any changes."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine import cache
from playground.engine.engine import Engine
from playground.engine.results import Pool
from playground.sketch.model import Output

from ..loading import load


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
