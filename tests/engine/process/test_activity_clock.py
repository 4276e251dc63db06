"""The time of each pass is its own: all its steps, none of the others', none of what it waited."""

from __future__ import annotations

import pytest

from playground.engine.process import activity_clock
from playground.engine.process.activity_clock import ActivityClock


class Time:
    """Stands in for the clock, and for how long a process has waited for a processor."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.ran = self.waited = 0.0

    def monotonic(self) -> float:
        return self.now

    def times(self) -> dict[str, tuple[int, int]]:
        return {"1": (round(self.ran * 1e9), round(self.waited * 1e9))}

    def passes(self, seconds: float, waited: float = 0.0) -> None:
        self.now += seconds
        self.ran += seconds - waited
        self.waited += waited


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Time:
    made = Time()
    monkeypatch.setattr(activity_clock, "time", made)
    return made


def test_each_pass_has_its_own_time(time: Time):
    clock = ActivityClock(time.times)
    assert clock.seconds == 0.0
    for path in ("height", "horizon", "light"):
        clock.begin(path)
        time.passes(8.0)
        assert clock.seconds == pytest.approx(8.0)
    clock.begin("view")
    assert clock.seconds == 0.0
    assert clock.total == pytest.approx(24.0)


def test_the_steps_of_a_loop_add_up(time: Time):
    clock = ActivityClock(time.times)
    for _ in range(300):
        for path, seconds in (("rain", 0.01), ("flow", 0.04)):
            clock.begin(path)
            time.passes(seconds)
    assert clock.seconds == pytest.approx(300 * 0.04)
    clock.begin("rain")
    assert clock.seconds == pytest.approx(300 * 0.01)
    assert clock.total == pytest.approx(300 * 0.05)
    clock.clear()
    assert clock.total == 0.0
    clock.begin("rain")
    assert clock.seconds == 0.0


def test_what_a_pass_waited_for_a_processor_is_left_out_but_for_a_share(time: Time):
    clock = ActivityClock(time.times)
    clock.begin("a")
    time.passes(40.0, waited=39.0)
    assert clock.seconds == pytest.approx(40.0 / 8), "and no more: what never ends must be stopped"
    clock.begin("b")
    time.passes(40.0, waited=30.0)
    assert clock.seconds == pytest.approx(10.0), "what the pass before waited is not this one's"


def test_a_reader_amid_the_end_of_an_activity_counts_nothing_twice(time: Time):
    """Another thread may read the clock anywhere in ``begin``: here, where that reads what was waited."""
    totals: list[float] = []

    def times() -> dict[str, tuple[int, int]]:
        nonlocal reads
        reads, amid = False, reads
        if amid:
            totals.append(clock.total)
        reads = amid
        return time.times()

    reads = False
    clock = ActivityClock(times)
    clock.begin("start")
    time.passes(8.0)
    reads = True
    clock.begin("height")
    assert totals and totals == pytest.approx([8.0] * len(totals))
