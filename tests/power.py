"""Measure the power of the tests: break the package in hundreds of ways, and count what they notice.

    python tests/power.py mutants mutants.json                   # choose mutants, by a seed
    python tests/power.py run mutants.json before.json --all     # every case of every everyday test
    python tests/power.py run mutants.json sampled.json          # the cases that one commit runs
    python tests/power.py compare before.json after.json         # exit status 1 where a kill was lost

A mutant is one change of one line, by cosmic-ray's operators. ``run`` traces once which test functions
run which lines, by a sample of their cases, then breaks one line after another in a copy of the checkout
and runs the functions that reach it, the quickest first, until one fails or their time is over the budget.
A mutant that stops the tests, or is slower than four times the budget, counts as killed.

It takes hours and is no part of ``.ci/run``. It needs ``pip install "cosmic-ray>=8.4" "coverage>=7.10"``.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from dataclasses import asdict, dataclass
from difflib import SequenceMatcher
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SUBJECTS = {
    "planner": ["playground/engine/planner.py", "playground/engine/sizes.py", "playground/engine/plan.py"],
    "staleness": ["playground/engine/cache_keys.py", "playground/engine/cache.py"],
    "drafts": ["playground/studio/edits/drafts.py", "playground/studio/edits/edits.py"],
    "header": ["playground/shader/header.py", "playground/shader/kernel.py"],
    "save": ["playground/sketch/save.py", "playground/sketch/assign.py"],
    "judge": ["playground/verify/shots/judge.py", "playground/verify/shots/compare.py"],
    "elevation": ["playground/data/elevation.py", "playground/data/grid.py"],
}
"""What is broken, each as often as another: the modules that hold the most of its decisions."""

IGNORED = ("core/NoOp", "core/RemoveDecorator", "core/ExceptionReplacer")
"""Operators whose mutants are the same program, or fail at import."""

KILLED, SURVIVED, UNREACHED, GONE = "killed", "survived", "unreached", "gone"


@dataclass(frozen=True)
class Mutant:
    """One line of the package, and what it becomes."""

    subject: str
    file: str
    line: int  # from 1, when it was chosen
    before: str
    after: str
    operator: str

    @property
    def name(self) -> str:
        """What tells it from every other."""
        return f"{self.file}:{self.line} {self.operator}: {self.before.strip()} -> {self.after.strip()}"

    def place(self, text: str) -> int | None:
        """Return the line that holds it now, from 1, the nearest of equal ones; None: it is gone."""
        lines = [i for i, line in enumerate(text.split("\n"), 1) if line == self.before]
        return min(lines, key=lambda i: abs(i - self.line), default=None)

    def applied(self, text: str) -> str:
        """Return a module's text with the change made."""
        lines = text.split("\n")
        at = self.place(text)
        assert at is not None
        lines[at - 1] = self.after
        return "\n".join(lines)


# ── choosing ─────────────────────────────────────────────────────────────────


def candidates(file: str) -> list[tuple[str, int]]:
    """Return an operator's name and the number of its place, for all that may change in a module."""
    from cosmic_ray import plugins
    from cosmic_ray.ast import ast_nodes, get_ast

    nodes = list(ast_nodes(get_ast((ROOT / file).read_text("utf-8"))))
    found: list[tuple[str, int]] = []
    for name in plugins.operator_names():
        operator_class = plugins.get_operator(name)
        if name not in IGNORED and not operator_class.arguments():
            operator = operator_class()
            places = sum(len(list(operator.mutation_positions(node))) for node in nodes)
            found += [(name, number) for number in range(places)]
    return found


def mutant_of(subject: str, file: str, name: str, number: int) -> Mutant | None:
    """Return one mutant, if it changes one line, compiles, and is another program."""
    from cosmic_ray import plugins
    from cosmic_ray.mutating import mutate_code

    text = (ROOT / file).read_text("utf-8")
    changed = mutate_code(text, plugins.get_operator(name)(), number)
    pair = changed_line(text, changed) if changed else None
    if pair is None:
        return None
    try:
        is_equivalent = evaluated(changed) == evaluated(text)
    except (SyntaxError, SyntaxWarning):
        return None
    return None if is_equivalent else Mutant(subject, file, *pair, name)


def changed_line(text: str, changed: str) -> tuple[int, str, str] | None:
    """Return the one line that differs, from 1, with both its texts; None where more do."""
    before, after = text.split("\n"), changed.split("\n")
    parts = [
        op for op in SequenceMatcher(None, before, after, autojunk=False).get_opcodes() if op[0] != "equal"
    ]
    if len(parts) != 1 or parts[0][2] - parts[0][1] != 1 or parts[0][4] - parts[0][3] != 1:
        return None
    _, i, _, j, _ = parts[0]
    return i + 1, before[i], after[j]


def evaluated(text: str) -> str:
    """Return what of a module is ever evaluated: all but its annotations. Raises ``SyntaxError``."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # as "is" beside a literal
        compile(text, "", "exec")
    tree = ast.parse(text)
    for node in ast.walk(tree):
        for name in ("annotation", "returns"):
            if getattr(node, name, None) is not None:
                setattr(node, name, ast.Constant(None))
    return ast.dump(tree)


def choose(count: int, seed: int) -> list[Mutant]:
    """Return that many mutants, as many of each subject as of another, at most one a line; by a seed."""
    chosen: dict[tuple[str, int], Mutant] = {}
    for index, (subject, files) in enumerate(SUBJECTS.items(), 1):
        every = [(file, *candidate) for file in files for candidate in candidates(file)]
        random.Random(f"{seed} {subject}").shuffle(every)
        for candidate in every:
            if len(chosen) == count * index // len(SUBJECTS):
                break
            mutant = mutant_of(subject, *candidate)
            if mutant is not None:
                chosen.setdefault((mutant.file, mutant.line), mutant)
        print(f"{subject}: of {len(every)} changes", file=sys.stderr)
    return list(chosen.values())


# ── running ──────────────────────────────────────────────────────────────────


@dataclass
class Reach:
    """Which test functions run which lines, and how long each takes."""

    lines: dict[str, dict[int, list[str]]]  # file → line → test functions, as pytest names them
    seconds: dict[str, float]

    def tests_of(self, mutant: Mutant, line: int, budget: float) -> list[str]:
        """Return the functions that reach a mutant, the quickest first, within a budget [s]."""
        of_file = self.lines.get(mutant.file, {})
        tests = of_file.get(line) or sorted({test for tests in of_file.values() for test in tests})
        chosen: list[str] = []
        total = 0.0
        for test in sorted(tests, key=lambda test: self.seconds.get(test, budget)):
            total += self.seconds.get(test, budget)
            if chosen and total > budget:
                break
            chosen.append(test)
        return chosen


def trace(copy: Path, options: list[str], tests: list[str]) -> Reach:
    """Run the tests once under coverage."""
    import coverage

    settings = copy / "power.coveragerc"
    settings.write_text(
        "[run]\nsource = playground\nparallel = true\npatch = subprocess\ndynamic_context = test_function\n"
    )
    junit = copy / "power.xml"
    traced = [sys.executable, "-m", "coverage", "run", f"--rcfile={settings}", "-m", "pytest", "-q", *options]
    subprocess.run([*traced, f"--junitxml={junit}", *tests], cwd=copy, env=environment(copy), check=False)
    combine = [sys.executable, "-m", "coverage", "combine", "-q", f"--rcfile={settings}"]
    subprocess.run(combine, cwd=copy, check=True)
    seconds: dict[str, float] = defaultdict(float)
    names: dict[str, str] = {}  # as coverage names a function → as pytest does
    for case in ElementTree.parse(junit).iter("testcase"):
        if case.find("failure") is not None or case.find("error") is not None:
            continue  # it would fail of every mutant
        module, function = case.get("classname", ""), case.get("name", "").partition("[")[0]
        test = f"{module.replace('.', '/')}.py::{function}"
        names[f"{module}.{function}"] = test
        seconds[test] += float(case.get("time", 0))
    data = coverage.CoverageData(basename=str(copy / ".coverage"))
    data.read()
    lines: dict[str, dict[int, list[str]]] = {}
    for file in data.measured_files():
        short = Path(file).relative_to(copy).as_posix()
        contexts = data.contexts_by_lineno(file)
        lines[short] = {
            line: sorted({names[c] for c in found if c in names}) for line, found in contexts.items()
        }
    return Reach(lines, dict(seconds))


def environment(copy: Path) -> dict[str, str]:
    """Return the environment of a run in a copy of the checkout: its own package first, no bytecode kept."""
    return {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}


def copied(folder: Path) -> Path:
    """Copy what git tracks, and what pages were built of, into a folder."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    for name in files.decode("utf-8").split("\0"):
        if name and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    return folder


def outcome(mutant: Mutant, copy: Path, reach: Reach, options: list[str], budget: float) -> dict[str, Any]:
    """Break the copy, run what reaches the break, and mend it."""
    file = copy / mutant.file
    text = file.read_text("utf-8") if file.exists() else ""
    line = mutant.place(text)
    if line is None:
        return {"outcome": GONE}
    tests = reach.tests_of(mutant, line, budget)
    if not tests:
        return {"outcome": UNREACHED}
    names = copy / "power.tests"
    names.write_text("\n".join(tests), "utf-8")
    file.write_text(mutant.applied(text), "utf-8")
    started = time.monotonic()
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *options, f"@{names}"]
    try:
        with subprocess.Popen(
            command, cwd=copy, env=environment(copy), text=True, start_new_session=os.name != "nt",
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        ) as process:  # fmt: skip
            try:
                printed, _ = process.communicate(timeout=30 + 4 * budget)
                status = process.returncode
            except subprocess.TimeoutExpired:
                end(process)
                printed, status = "slower than four times the budget", 1
    finally:
        file.write_text(text, "utf-8")
    failed = [line for line in printed.splitlines() if line.startswith(("FAILED", "ERROR"))]
    by = failed[0] if failed else "" if status == 0 else printed.strip().splitlines()[-1]
    survived = status in (0, 5)  # 5: no case of these functions is in this run
    return {
        "outcome": SURVIVED if survived else KILLED,
        "by": "" if survived else by,
        "tests": len(tests),
        "seconds": round(time.monotonic() - started, 1),
    }


def end(process: subprocess.Popen[str]) -> None:
    """End a process with all that it started."""
    if os.name == "nt":
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def run(mutants: list[Mutant], target: Path, *, options: list[str], budget: float, tests: list[str]) -> None:
    """Run the tests against each mutant; what is known is written after each, and the next run goes on."""
    results: dict[str, Any] = json.loads(target.read_text("utf-8")) if target.exists() else {}
    with tempfile.TemporaryDirectory(prefix="power-") as folder:
        copy = copied(Path(folder).resolve())
        reach = trace(copy, ["--seed", "1"], tests)
        for number, mutant in enumerate(mutants, 1):
            if mutant.name not in results:
                results[mutant.name] = outcome(mutant, copy, reach, options, budget)
                partial = target.with_suffix(".partial")
                partial.write_text(json.dumps(results, indent=1), "utf-8")
                partial.replace(target)
            print(f"{number}/{len(mutants)} {results[mutant.name]['outcome']}: {mutant.name}", flush=True)
    print(summary(results))


def summary(results: dict[str, Any]) -> str:
    """Return how many of the mutants had each outcome."""
    counts = {kind: 0 for kind in (KILLED, SURVIVED, UNREACHED, GONE)}
    for result in results.values():
        counts[result["outcome"]] += 1
    return ", ".join(f"{count} {kind}" for kind, count in counts.items())


def compare(before: dict[str, Any], after: dict[str, Any]) -> int:
    """Print both counts and each kill that was lost; return how many were."""
    print(f"before: {summary(before)}\nafter:  {summary(after)}")
    lost = [
        name
        for name, result in before.items()
        if result["outcome"] == KILLED and after.get(name, {}).get("outcome") in (SURVIVED, UNREACHED)
    ]
    for name in lost:
        print(f"lost: {name}\n      by {before[name]['by']}")
    return len(lost)


def main() -> int:
    """Run the command line; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("mutants", help="choose mutants")
    making.add_argument("file", type=Path)
    making.add_argument("--count", type=int, default=300)
    making.add_argument("--seed", type=int, default=1)
    running = commands.add_parser("run", help="run the tests against each mutant")
    running.add_argument("mutants", type=Path)
    running.add_argument("results", type=Path, help="another run goes on from what is in it")
    running.add_argument("--all", action="store_true", help="every case of every everyday test")
    running.add_argument("--seed", default="1", help="of the cases that are sampled")
    running.add_argument("--budget", type=float, default=30.0, help="seconds of tests a mutant")
    running.add_argument(
        "--tests", nargs="*", default=[], help="run these instead of all, as pytest names them"
    )
    comparing = commands.add_parser("compare", help="list the kills that were lost")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    arguments = parser.parse_args()
    if arguments.command == "mutants":
        mutants = choose(arguments.count, arguments.seed)
        arguments.file.write_text(json.dumps([asdict(mutant) for mutant in mutants], indent=1), "utf-8")
        return 0
    if arguments.command == "compare":
        files = (arguments.before, arguments.after)
        before, after = (json.loads(file.read_text("utf-8")) for file in files)
        return 1 if compare(before, after) else 0
    mutants = [Mutant(**each) for each in json.loads(arguments.mutants.read_text("utf-8"))]
    options = ["--all", "-m", "not slow"] if arguments.all else ["--seed", arguments.seed]
    run(mutants, arguments.results, options=options, budget=arguments.budget, tests=arguments.tests)
    return 0


if __name__ == "__main__":
    sys.exit(main())
