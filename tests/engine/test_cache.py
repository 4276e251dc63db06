"""The cache's bookkeeping: its bytes are those of what it holds, after any changes."""

from __future__ import annotations

from playground.engine import cache
from playground.engine.engine import Engine
from playground.sketch.load import load


def held(engine: Engine) -> int:
    return sum(cached.bytes for cached in engine.internal.cache._cached.values())


def test_bytes_are_those_of_what_is_cached(ctx):
    sketch = load("jacksboro").with_values({"size": 65, "view.grid": 33})
    with Engine(ctx, cache_bytes=3 * 2**20) as engine:
        for hour in range(3):
            moved = sketch.with_values({"light.sun": (100.0 + hour, 20.0)})
            engine.render(moved, size=(160, 90))  # mipmaps are made after a texture is put away
            assert engine.internal.cache.bytes == held(engine)
            for iteration in (3, 5, 2):
                engine.read("diamond_square", "height", steps={"height": iteration})
                assert engine.internal.cache.bytes == held(engine)
        assert 0 < engine.internal.cache.bytes <= engine.internal.cache.limit
        engine.internal.cache.clear()
        assert engine.internal.cache.bytes == held(engine) == 0


def test_small_results_are_bounded_in_number_too(ctx, monkeypatch):
    monkeypatch.setattr(cache, "MOST", 24)
    sketch = load("diamond_square").with_values({"size": 17, "view.grid": 17})
    with Engine(ctx) as engine:
        for seed in range(5):
            engine.render(sketch.with_values({"height.seed": seed}), size=(16, 9))
            assert len(engine.internal.cache) <= 24
        engine.render(sketch.with_values({"height.seed": 4}), size=(16, 9))
        assert engine.internal.ran == [], "the newest are cached"
