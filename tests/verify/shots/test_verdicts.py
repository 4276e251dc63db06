"""The table of verdicts: each way a check can end has all that a report, and accepting, need of it."""

from __future__ import annotations

import re
from pathlib import Path

from playground.errors import DataError, OpenGLFault, PlaygroundError, SandboxCrash, SandboxTimeout
from playground.verify.shots import page
from playground.verify.shots.verdicts import PASSED, VERDICTS, verdict_on, word_of

from .conftest import WORDS_FOR_PICTURES

STYLE = (Path(page.__file__).parent / "report.css").read_text()


def test_one_verdict_passes() -> None:
    assert [word for word, verdict in VERDICTS.items() if verdict.passes] == [PASSED]


def test_each_verdict_has_all_it_needs() -> None:
    for word, verdict in VERDICTS.items():
        assert re.fullmatch(r"[a-z-]+", word), "a file name, an attribute and a property of JUnit XML hold it"
        assert verdict.label and verdict.meaning.endswith("."), word
        assert f".chip.{verdict.chip} {{" in STYLE, word
        assert verdict.acceptable is not verdict.refusal.endswith("."), word
        assert not (verdict.passes and verdict.refusal), word
        assert verdict.measured or not (verdict.passes or verdict.tolerable), f"{word} follows from numbers"
        assert word in WORDS_FOR_PICTURES or verdict.refusal, f"{word}: no picture to make a reference of"


def test_no_two_verdicts_read_alike() -> None:
    assert len({verdict.label for verdict in VERDICTS.values()}) == len(VERDICTS)
    assert len({verdict.meaning for verdict in VERDICTS.values()}) == len(VERDICTS)


def test_an_error_has_the_word_of_its_class() -> None:
    ends: dict[PlaygroundError, str] = {
        SandboxCrash("a"): "crash",
        SandboxTimeout("a"): "hang",
        OpenGLFault("a"): "gl-error",
        DataError("a"): "error",
    }
    assert {error: word_of(error) for error in ends} == ends


def test_an_unknown_word_of_a_record_fails() -> None:
    verdict = verdict_on("melted")
    assert verdict.label == "melted" and not verdict.passes and verdict.acceptable
    assert f".chip.{verdict.chip} {{" in STYLE
