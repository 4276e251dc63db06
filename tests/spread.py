"""Sample the many cases of one test: a run has a part of them, the next commit another part.

Where one function is called with many parameters, as for every size, seed and sketch, a bug shows in most of
its cases. The everyday run has a sixth of them, the slow run another sixth, and of a test that is slow
anyway a sixth. The commit's hash and the case's name choose, so one commit always has the same cases and a
few commits have all. Each tenth commit runs them all, and so does ``--all``. Cases named on the command line
and those of tests marked ``always`` are never left out.
"""

from __future__ import annotations

import subprocess
from collections import defaultdict
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
MAX_UNSAMPLED = 2  # cases of a function that all run
PARTS = 6  # of the cases of a function
FULL_INTERVAL = 10  # commits from one full run to the next


def git(*arguments: str) -> str:
    """Return what git prints about this checkout, or nothing where there is no git or no checkout."""
    try:
        result = subprocess.run(
            ["git", *arguments], cwd=TESTS, capture_output=True, text=True, encoding="utf-8", check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return ""
    return result.stdout.strip()


class Spread:
    """Divides the cases of each test between the everyday run, the slow run and other commits' runs."""

    def __init__(
        self,
        seed: str = "",
        every_case: bool = False,
        arguments: Iterable[str] = (),
        *,
        half: int | None = None,
    ) -> None:
        """Sample by a seed, or else by the commit; ``arguments`` are those of the command line.

        With a ``half``, 1 or 2, the functions of the other half are left out; another seed halves otherwise.
        """
        self.seed = seed or git("rev-parse", "--short=12", "HEAD") or "none"
        commits = "" if seed else git("rev-list", "--count", "HEAD")
        self.every_case = every_case or (commits != "" and int(commits) % FULL_INTERVAL == 0)
        self.half = half
        self.named = tuple(name.replace("\\", "/").rpartition("/")[2] for name in arguments if "[" in name)

    def pytest_report_header(self) -> str:
        """Print the seed, and how to repeat the run."""
        half = f", half {self.half} of the functions" if self.half else ""
        if self.every_case:
            return f"cases: all{half}, of seed {self.seed}; --seed {self.seed} samples them"
        seed = f"seed {self.seed}; --seed {self.seed} repeats this run, --all runs every case"
        return f"cases: sampled{half}, {seed}"

    def part(self, item: pytest.Item) -> int:
        """Return the part of its test's cases that a case belongs to."""
        return sha256(f"{self.seed} {item.nodeid}".encode()).digest()[0] % PARTS

    def is_of_other_half(self, item: pytest.Item) -> bool:
        """Return whether a case's function is in the half that does not run."""
        if self.half is None:
            return False
        function = item.nodeid.partition("[")[0]
        return sha256(f"{self.seed} {function}".encode()).digest()[1] % 2 != self.half - 1

    def is_left_out(self, item: pytest.Item, part: int) -> bool:
        """Return whether a case is in another part than the slow run's, and may be left out."""
        return (
            not self.every_case
            and self.part(item) != part
            and item.get_closest_marker("always") is None
            and not (self.named and item.nodeid.endswith(self.named))
        )

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Mark what the everyday run leaves to the slow run; deselect what both leave to other commits."""
        functions = defaultdict(list)
        for item in items:
            if item.path.is_relative_to(TESTS):
                is_slow = item.get_closest_marker("slow") is not None
                functions[item.nodeid.partition("[")[0], is_slow].append(item)
        left_out = {item for item in items if self.is_of_other_half(item)}
        for (_, is_slow), cases in functions.items():
            if len(cases) <= MAX_UNSAMPLED:
                continue
            if is_slow:
                others = [item for item in cases if self.is_left_out(item, part=0)]
                left_out.update(others if len(others) < len(cases) else cases[1:])
                continue
            for item in cases[1:]:  # the first case is for every day
                if self.part(item) != 0:
                    item.add_marker("slow")
                    if self.is_left_out(item, part=1):
                        left_out.add(item)
        if left_out:
            config.hook.pytest_deselected(items=list(left_out))
            items[:] = [item for item in items if item not in left_out]
