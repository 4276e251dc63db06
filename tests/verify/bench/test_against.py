"""Two runs are compared: by ratios to peers, and only where their samples do not overlap."""

from __future__ import annotations

from playground.verify.bench.context import Samples
from playground.verify.bench.results import Figure, Results, changes, read, write
from playground.verify.bench.rows import Goal

NONE = Goal()


def run_of(*figures, date="2026-01-01T00:00:00+00:00"):
    return Results(date, "1.0", {"renderer": "r"}, 3, list(figures))


def figure(ours, theirs=None, name="row", goal=NONE):
    peers = {"peer": Samples(theirs, theirs)} if theirs else {}
    return Figure("suite", name, "what", 1025, "ms", goal, {"auto": Samples(ours, ours)}, peers)


def words(now, before):
    return [(change.word, change.by_peer) for change in changes(run_of(now), run_of(before))]


def test_a_machine_half_as_fast_slows_peers_too():
    once, twice, four = [10.0, 10.1, 10.2], [20.0, 20.2, 20.4], [40.0, 40.4, 40.8]
    assert words(figure(twice, four), figure(once, twice)) == [("alike", "peer")]
    assert words(figure(twice), figure(once)) == [("slower", "")]
    assert words(figure(once, four), figure(once, twice)) == [("faster", "peer")]


def test_overlapping_or_within_ten_percent_samples_are_no_change():
    assert words(figure([5.0, 12.0, 20.0]), figure([6.0, 10.0, 18.0])) == [("alike", "")]
    assert words(figure([10.50, 10.51, 10.52]), figure([10.0, 10.01, 10.02])) == [("alike", "")]


def test_a_figure_that_the_other_run_lacks_is_not_compared():
    assert changes(run_of(figure([1.0], name="new")), run_of(figure([1.0], name="old"))) == []


def test_what_is_written_is_read_again(tmp_path):
    made = run_of(figure([1.0, 2.0], [3.0], goal=Goal(times=2.0, than="peer")))
    write(made, tmp_path / "run.json")
    assert read(tmp_path / "run.json") == made


def test_a_goal_holds_at_its_own_size_alone():
    met = figure([1.0], [2.0], goal=Goal(times=2.0, than="pe"))
    assert met.met is True
    assert figure([1.1], [2.0], goal=Goal(times=2.0, than="pe")).met is False
    assert figure([1.1], [2.0], goal=Goal(times=2.0, than="other")).met is None
    assert figure([3.0], goal=Goal(most=4.0)).met is True
    assert figure([5.0], goal=Goal(most=4.0)).met is False
    met.size = 257
    assert met.met is None
