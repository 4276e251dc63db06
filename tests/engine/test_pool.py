"""Textures are used again; where a pool clears, what they held is gone."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

from playground.engine.results import Pool, Swap
from playground.sketch.model import Output


@pytest.mark.parametrize("clears", [False, True])
def test_a_pool_that_clears_gives_zeros_for_what_was_full(ctx: moderngl.Context, clears: bool):
    outputs = (Output("height", "r32f"), Output("colour", "rgba16f"))
    pool = Pool(ctx, 2**20)
    pool.clears = clears
    first = pool.take((5, 3), outputs)
    first.framebuffer(ctx).use()
    first.framebuffer(ctx).clear(1.0, 1.0, 1.0, 1.0)
    pool.give(first)
    again = pool.take((5, 3), outputs)
    assert pool.made == 1 and again.textures["height"] is first.textures["height"]
    result = {name: texture.read() for name, texture in again.textures.items()}
    full = np.ones(15, np.float32).tobytes(), np.ones(60, np.float16).tobytes()
    expected = (bytes(60), bytes(120)) if clears else full  # without clearing, it is as it was left
    assert (result["height"], result["colour"]) == expected
    again.release()


def test_a_repeat_that_fails_gives_all_its_textures_back(ctx: moderngl.Context):
    outputs, pool = (Output("height", "r32f"),), Pool(ctx, 2**20)
    with pytest.raises(ZeroDivisionError), Swap(pool, (5, 3), outputs, pool.take((5, 3), outputs)) as swap:
        for iteration in range(3):
            swap.target()
            if iteration == 2:
                raise ZeroDivisionError
            swap.advance()
    assert len(pool) == pool.made
    with Swap(pool, (5, 3), outputs, None) as swap:
        for _ in range(3):
            swap.target()
            swap.advance()
    assert swap.before is not None and len(pool) == pool.made - 1
    pool.give(swap.before)
    pool.clear()
