"""What of many cases is for every day: some of each, never none, and what was slow before stays so."""

from __future__ import annotations

from itertools import product
from types import SimpleNamespace

from .spread import MANY, TESTS, Spread


class Case(SimpleNamespace):
    """A collected test, as far as its marker goes."""

    def get_closest_marker(self, name: str) -> str | None:
        return name if name in self.marks else None

    def add_marker(self, name: str) -> None:
        self.marks.append(name)


def every_day(names: list[str], folder: int = 0) -> list[str]:
    """Return the cases that are left, of a test among the tests (0), or in a folder beside them (1)."""
    path = (TESTS if folder == 0 else TESTS.parent) / "test_a.py"
    cases = [Case(nodeid=f"a.py::test[{name}]", path=path, marks=[]) for name in names]
    Spread().pytest_collection_modifyitems(cases)  # type: ignore[arg-type]
    return [name for name, case in zip(names, cases, strict=True) if not case.marks]


def test_few_cases_and_those_of_other_folders_all_run():
    few, many = [str(i) for i in range(MANY)], [str(i) for i in range(60)]
    assert (every_day(few), every_day(many, 1)) == (few, many)


def test_of_many_a_quarter_run_among_them_the_first_and_every_value_of_each_parameter():
    many = ["-".join(case) for case in product("abcdefgh", "1234", "xyz")]
    left = every_day(many)
    assert left[0] == many[0] and 0.15 < len(left) / len(many) < 0.35
    for at in range(3):
        assert {name.split("-")[at] for name in left} == {name.split("-")[at] for name in many}


def test_what_is_slow_is_not_counted_and_stays_slow():
    marked = [Case(nodeid=f"a.py::test[{i}]", path=TESTS / "a.py", marks=["slow"]) for i in range(60)]
    first = Case(nodeid="a.py::test[first]", path=TESTS / "a.py", marks=[])
    Spread().pytest_collection_modifyitems([*marked, first])  # type: ignore[arg-type]
    assert first.marks == [] and all(case.marks == ["slow"] for case in marked)
