"""Runs are timed alternately; medians, quartiles and growth are those of NumPy."""

from __future__ import annotations

import time

import numpy as np
import pytest

from playground.verify.bench.context import Samples, alternate, beyond
from playground.verify.bench.results import Figure, Results, growth
from playground.verify.bench.rows import Goal


def test_runs_take_turns_and_the_first_rounds_do_not_count():
    called: list[str] = []
    runs = {name: lambda name=name: called.append(name) for name in ("ours", "theirs", "slow")}
    samples = alternate(runs, 3, once=("slow",), unmeasured=2)
    assert called == [*["ours", "theirs"] * 2, "ours", "theirs", "slow", *["ours", "theirs"] * 2]
    assert [len(samples[name].wall) for name in runs] == [3, 3, 1]
    assert len(samples["ours"].processor) == 3


def test_the_clock_and_the_processors_are_told_apart():
    result = alternate({"asleep": lambda: time.sleep(0.05)}, 1, unmeasured=0)["asleep"]
    assert result.wall[0] >= 50 > result.processor[0]


def test_a_part_is_taken_off_round_by_round():
    samples = beyond(Samples([9.0, 19.0], [7.0, 8.0]), Samples([4.0, 13.0], [3.0, 3.5]))
    assert samples.wall == [5.0, 6.0] and samples.processor == [4.0, 4.5]


@pytest.mark.parametrize("count", [3, 4, 7, 20])
def test_medians_and_quartiles_are_numpys(count):
    values = np.random.default_rng(count).random(count).tolist()
    samples = Samples(values, [2 * value for value in values])
    assert samples.median() == pytest.approx(np.median(values))
    assert samples.quartiles() == pytest.approx((np.quantile(values, 0.25), np.quantile(values, 0.75)))
    assert samples.median("processor") == pytest.approx(2 * np.median(values))


def test_growth_is_texel_cost_ratio_of_largest_to_smallest_size():
    def figure(size: int, milliseconds: float) -> Figure:
        return Figure("s", "row", "what", size, "ms", Goal(), {"auto": Samples([milliseconds])})

    results = Results("2026-01-01T00:00:00+00:00", "1", {}, 1, [figure(100, 2.0), figure(400, 64.0)])
    assert growth(results, [100, 200, 400]) == [("row", pytest.approx(2.0))]
    assert growth(results, [100]) == []
