"""A crash report names the signal or the status, and quotes what was printed last."""

from __future__ import annotations

import pytest

from playground.engine.process.crash_report import CrashReport

GAVE_UP = "ended its process: the driver or its compiler gave up, or memory ran out"


@pytest.mark.parametrize(
    ("status", "ending"),
    [
        (7, "ended with status 7"),
        (0, "ended with status 0"),
        (-11, "was ended by SIGSEGV"),
        (-1000, "was ended by signal 1000"),
        (0xC0000005, "was ended by an access violation"),
        (None, "died"),
    ],
)
def test_the_ending_is_a_signal_or_a_status(status: int | None, ending: str):
    assert CrashReport(status).ending == ending


@pytest.mark.parametrize(
    ("status", "output", "cause"),
    [
        (-11, "", "crashed the driver or its compiler (SIGSEGV)"),
        (
            -6,
            "first\nnir\n",
            "crashed the driver or its compiler (SIGABRT; its last output: nir)",
        ),
        (
            -6,
            "LLVM ERROR: out of memory",
            "ran out of memory (SIGABRT; its last output: LLVM ERROR: out of memory)",
        ),
        (0xC00000FD, "", "crashed the driver or its compiler (a stack overflow)"),
        (-9, "", "was killed by the system (SIGKILL); did memory run out?"),
        (
            3,
            "",
            "ended its process: the driver or its compiler gave up, or memory ran out (ended with status 3)",
        ),
        (None, "", "ended its process: the driver or its compiler gave up, or memory ran out (died)"),
    ],
)
def test_the_cause_is_guessed_from_the_signal_and_the_last_line(status: int | None, output: str, cause: str):
    assert CrashReport(status, output).cause() == cause


def test_the_last_lines_are_quoted_and_a_place_is_named():
    report = CrashReport(-11, "".join(f"line {number}\n\n" for number in range(20)))
    assert report.last_lines == "".join(f"\n    | line {number}" for number in range(8, 20))
    assert (
        CrashReport(-11)
        .cause(" in the sandbox")
        .startswith("crashed the driver or its compiler in the sandbox")
    )
