"""Which of many cases a run has: some of each test, never none, all of them over time, and all on demand."""

from __future__ import annotations

import math
import subprocess
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import pytest

from . import spread
from .spread import FULL_INTERVAL, MAX_UNSAMPLED, PARTS, TESTS, Spread

UNSAMPLED_CASES = [str(i) for i in range(MAX_UNSAMPLED)]
MANY = ["-".join(case) for case in product("abcdefgh", "1234", "xyz")]


class Case(SimpleNamespace):
    """A collected test, as far as its markers go."""

    __hash__ = object.__hash__

    def get_closest_marker(self, name: str) -> str | None:
        return name if name in self.marks else None

    def add_marker(self, name: str) -> None:
        self.marks.append(name)


def runs(names: list[str], spread: Spread, *marks: str, folder: Path = TESTS) -> tuple[list[str], list[str]]:
    """Return the cases of the everyday run and those of the slow run."""
    cases = [
        Case(nodeid=f"tests/test_a.py::test[{name}]", path=folder / "test_a.py", marks=[*marks])
        for name in names
    ]
    left_out: list[Case] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: left_out.extend(items))
    items = list(cases)
    spread.pytest_collection_modifyitems(SimpleNamespace(hook=hook), items)  # type: ignore[arg-type]
    assert {id(case) for case in cases} == {id(case) for case in items + left_out}
    kept = [(name, "slow" in case.marks) for name, case in zip(names, cases, strict=True) if case in items]
    return [name for name, slow in kept if not slow], [name for name, slow in kept if slow]


def test_few_cases_and_those_of_other_folders_all_run():
    assert runs(UNSAMPLED_CASES, Spread("1")) == (UNSAMPLED_CASES, [])
    assert runs(UNSAMPLED_CASES, Spread("1"), "slow") == ([], UNSAMPLED_CASES)
    assert runs(MANY, Spread("1"), folder=TESTS.parent) == (MANY, [])


@pytest.mark.parametrize("seed", ["1", "2"])
def test_each_run_has_about_one_part(seed: str):
    everyday, slow = runs(MANY, Spread(seed))
    assert everyday[0] == MANY[0] and not set(everyday) & set(slow)
    for part in (everyday, slow, runs(MANY, Spread(seed), "slow")[1]):
        share, deviation = 1 / PARTS, math.sqrt(1 / PARTS * (1 - 1 / PARTS) / len(MANY))
        assert abs(len(part) / len(MANY) - share) < 3 * deviation
        assert {name[-1] for name in part} == set("xyz")


def test_sixteen_seeds_reach_almost_every_case_and_one_repeats():
    parts = [runs(MANY, Spread(str(seed)), "slow")[1] for seed in range(16)]
    # A case is missed by sixteen independent sixths with the probability (5 / 6) ** 16 = 0.054.
    assert len(set().union(*parts)) > 0.85 * len(MANY)
    assert parts[3] == runs(MANY, Spread("3"), "slow")[1] != parts[4]


@pytest.mark.parametrize("seed", [str(seed) for seed in range(8)])
def test_three_slow_cases_are_never_all_left_out(seed: str):
    assert runs(["a", "b", "c"], Spread(seed), "slow")[1]


def test_all_always_and_named_cases_run():
    everyday, slow = runs(MANY, Spread("1", every_case=True))
    assert sorted(everyday + slow) == sorted(MANY) and everyday == runs(MANY, Spread("1"))[0]
    assert runs(MANY, Spread("1"), "slow", "always") == ([], MANY)
    left_out = next(name for name in MANY if name not in runs(MANY, Spread("1"), "slow")[1])
    assert left_out in runs(MANY, Spread("1", arguments=[f"tests/test_a.py::test[{left_out}]"]), "slow")[1]


def test_two_halves_are_the_whole_and_a_function_is_in_one():
    cases = [
        Case(nodeid=f"tests/test_{file}.py::test[{case}]", path=TESTS / f"test_{file}.py", marks=[])
        for file in range(200)
        for case in UNSAMPLED_CASES
    ]
    halves = []
    for half in (1, 2):
        items = list(cases)
        hook = SimpleNamespace(pytest_deselected=lambda items: None)
        Spread("1", half=half).pytest_collection_modifyitems(SimpleNamespace(hook=hook), items)  # type: ignore[arg-type]
        halves.append({case.nodeid for case in items})
    assert not halves[0] & halves[1] and halves[0] | halves[1] == {case.nodeid for case in cases}
    functions = {name.partition("[")[0] for name in halves[0]}
    assert 60 < len(functions) < 140  # of 200, at random: five standard deviations are 35
    assert len(halves[0]) == len(functions) * len(UNSAMPLED_CASES)
    assert "half 2 of the functions" in Spread("1", half=2).pytest_report_header()


def test_the_commit_is_the_seed_and_each_tenth_is_full(monkeypatch: pytest.MonkeyPatch):
    answers = {"rev-parse": "abcdef", "rev-list": str(FULL_INTERVAL * 7)}
    monkeypatch.setattr(spread, "git", lambda command, *_: answers[command])
    assert runs(MANY, Spread(), "slow") == ([], MANY)
    assert not Spread("abcdef").every_case, "a seed that is given is a sample"
    answers["rev-list"] = str(FULL_INTERVAL * 7 + 1)
    assert runs(MANY, Spread(), "slow") == runs(MANY, Spread("abcdef"), "slow") != ([], MANY)
    assert "--seed abcdef " in Spread().pytest_report_header()


def test_without_git_there_is_still_a_seed(monkeypatch: pytest.MonkeyPatch):
    def missing(*_: object, **__: object) -> None:
        raise FileNotFoundError

    monkeypatch.setattr(subprocess, "run", missing)
    assert Spread().seed == "none" and not Spread().every_case
