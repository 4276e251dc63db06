"""Check shots for pytest in one process: render, compare, write references if wanted, explain.

Nothing passes in silence. A picture that is missing, broken or not the one expected fails the
test and is shown; one that gives no picture fails in its own word, ``crash``, ``hang`` or
``error``; without the expected renderer a test fails where ``CI`` is set and is skipped, with
the reason, elsewhere. Each check leaves a record in the results folder.

A check of a picture in Python does not end its test, so that one run shows all that differ. Where the test
then ends well, or is skipped, it fails for them; where something is raised in it, that is shown,
with a note of them. What is found after the test itself, as in a fixture's clean-up, is an error there.
A test that ends well and has checked nothing fails, too: it would pass whatever is drawn.
"""

from __future__ import annotations

import os
import shlex
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn, TypeVar

import pytest

from playground.engine.context import ContextInfo
from playground.engine.plain_forms import PlainForms, silent
from playground.engine.process.worker import UnexpectedError
from playground.errors import (
    ContextError,
    DataError,
    PlaygroundError,
)
from playground.paths import shown
from playground.verify.shots.first_difference import NoTrace, search_for
from playground.verify.shots.names import Claim, Claims, keeping, writing
from playground.verify.shots.plugin_constants import (
    FIXTURE,
    REFERENCE_RENDERER,
    SUMMARY_LINE,
    UNCHANGED,
    UNCHECKED,
    UNCOMPARED,
    UPDATE_FAILED,
)
from playground.verify.shots.recording import Recorder, typed
from playground.verify.shots.references import (
    PIXELS,
    Fallback,
    accepted,
    fallback_for,
    fallbacks_of,
    read_fallbacks,
    reference_path,
    write_reference,
)
from playground.verify.shots.suite import Outcome, RenderedShot, RendererProcess, ShotCase, check
from playground.verify.shots.verdicts import VERDICTS, word_of

# ── failures of a test, told at its end ──────────────────────────────────────


_NOTHING_CHECKED = (
    "this test takes `shot` and checks nothing: expected shot.check(…) or shot.animation(…); "
    "a test without a reference draws with playground.render"
)
_CHECKS: pytest.StashKey[bool] = pytest.StashKey()  # whether there was one; there once a test has the fixture
_ENDED_WELL: pytest.StashKey[bool] = pytest.StashKey()
_FAILURES: pytest.StashKey[list[str]] = pytest.StashKey()


def add_failure(node: pytest.Item, message: str) -> None:
    """Record that a picture of a test failed."""
    node.stash.setdefault(_FAILURES, []).append(message)


def expect_check(node: pytest.Item) -> None:
    """Begin a test that is to check something."""
    node.stash[_CHECKS] = False


def add_check(node: pytest.Item) -> None:
    """Record that a test has checked something."""
    node.stash[_CHECKS] = True


def fail_for_what_is_left(node: pytest.Item) -> None:
    """Fail now for the pictures that no one has been told of, or for none where the test ended well."""
    message = _take_failures(node)
    if not message and node.stash.get(_ENDED_WELL, False) and not node.stash[_CHECKS]:
        message = _NOTHING_CHECKED
    if message:
        pytest.fail(message, pytrace=False)


def _may_be_checked_later(item: pytest.Item) -> bool:
    """Return whether another fixture of a test takes ``shot``: its clean-up may check a picture."""
    fixtures = getattr(item, "_fixtureinfo", None)
    definitions = fixtures.name2fixturedefs if fixtures is not None else {}
    return any(FIXTURE in each.argnames for several in definitions.values() for each in several)


def _take_failures(node: pytest.Item) -> str:
    """Return the failures of a test, which are then told; "" for none."""
    failures = node.stash.get(_FAILURES, [])
    node.stash[_FAILURES] = []
    return "\n\n".join([f"{len(failures)} pictures of this test fail:", *failures][len(failures) < 2 :])


# ── checks ───────────────────────────────────────────────────────────────────


TRACE_SECONDS = 60.0
"""[s] that the failures of one process may take to be traced."""


Result = TypeVar("Result")


@dataclass(frozen=True)
class _Raised:
    """What was raised in a test instead of an image."""

    error: PlaygroundError
    word: str
    message: str
    case: ShotCase


_RAISED: pytest.StashKey[_Raised] = pytest.StashKey()
_CHECKER: pytest.StashKey[Checker] = pytest.StashKey()


def checker_of(config: pytest.Config) -> Checker:
    """Return what checks shots in this process; its child process starts with the first of them."""
    if _CHECKER not in config.stash:
        checker = config.stash[_CHECKER] = Checker(config)
        config.add_cleanup(checker.close)  # also after Ctrl-C
        config.pluginmanager.register(checker)
    return config.stash[_CHECKER]


class Checker:
    """Checks shots for the tests of one process; its child process draws them."""

    def __init__(self, config: pytest.Config) -> None:
        self.expected: str = config.getoption("--shots-renderer")
        self.any_renderer: bool = config.getoption("--shots-any-renderer")
        self.updating: bool = config.getoption("--shots-update") or config.getoption(UPDATE_FAILED)
        self.fallbacks = read_fallbacks(config.getini("shots_fallbacks"))
        self.plain: bool = config.getoption("--shots-plain")
        software = ContextInfo(0, self.expected, "", "", 0).software
        others = self.any_renderer or self.fallbacks
        renderer = "any" if not software else "either" if others else "software"
        self.renderer_process = RendererProcess(config.getoption("--shots-timeout"), renderer)
        self.recorder = Recorder(config)
        # Those alone are written that failed in the run before.
        self._failed = self.recorder.failed() if config.getoption(UPDATE_FAILED) else None
        self.claims = Claims(self.recorder.run)
        self._plain_forms: PlainForms | None = None
        self._seconds_to_trace = TRACE_SECONDS
        self._written: set[Path] = set()

    def close(self) -> None:
        """End the child process."""
        self.renderer_process.close()

    def shot(self, node: pytest.Item, case: ShotCase) -> None:
        """Draw a shot and hold it to its reference."""
        start = time.perf_counter()
        case = replace(case, sketch=case.sketch.plainly(self.plain))
        renderer = self.renderer(node, case)
        self._say_plain_forms(node, case, renderer)
        rendered = _result_or_error(lambda: self.renderer_process.render(case))
        self.show_what_was_printed(node)
        if isinstance(rendered, PlaygroundError):
            self._without_picture(node, case, rendered, start)
        if failure := self.failure(node, case, rendered, renderer, start):
            pytest.fail(failure, pytrace=False)

    def failure(
        self, node: pytest.Item, case: ShotCase, frame: RenderedShot, renderer: ContextInfo, start: float
    ) -> str:
        """Return why a picture fails; "" where a reference matches, or ``--shots-update`` writes one.

        ``start`` is when drawing began, of `time.perf_counter`.
        """
        outcome = _result_or_error(lambda: self._compare(node, case, frame, renderer))
        if isinstance(outcome, PlaygroundError):
            return self.record_missing(node, case, outcome, start)
        command = self.accepting(node, outcome)
        stands_in = self._stands_in(outcome)
        traced = () if outcome.ok else self._traced(case, outcome)
        seconds = time.perf_counter() - start
        unrecorded = self.recorder.record(node, outcome, seconds, command, stands_in, traced)
        if outcome.ok and outcome.tolerance and not (outcome.tolerated or self.updating):
            line = f"{case}: the tolerance is not needed: the picture passes without it"
            node.user_properties.append((SUMMARY_LINE, line))
        return "" if outcome.ok else _joined(self._explained(node, outcome, traced), unrecorded)

    def claim(self, node: pytest.Item, case: ShotCase, renderer: ContextInfo, own: bool) -> str:
        """Return why a test may not check a picture under its name, which another test has; else ""."""
        return self._refusal(Claim(case.shot.name, node.nodeid, own), case, renderer)

    def _refusal(self, claim: Claim, case: ShotCase, renderer: ContextInfo) -> str:
        references = reference_path(case.sketch, case.shot.name, renderer.slug).parent
        return self.claims.refusal(claim, references, self.recorder.place(case))

    def renderer(self, node: pytest.Item, case: ShotCase) -> ContextInfo:
        """Return what draws in the child process, if it is expected; else skip the test, or fail it."""
        start = time.perf_counter()
        result = _result_or_error(lambda: self.renderer_process.renderer)
        if isinstance(result, ContextError):
            self._without(node, case, str(result))
        if isinstance(result, PlaygroundError):
            self.show_what_was_printed(node)
            self._without_picture(node, case, result, start)
        return self.expect(node, case, result)

    def expect(self, node: pytest.Item, case: ShotCase, renderer: ContextInfo) -> ContextInfo:
        """Return a renderer whose pictures may be compared; else skip the test, or fail it."""
        may = self.any_renderer or fallbacks_of(self.fallbacks, renderer.slug)
        if renderer.slug != self.expected and not may:
            self._without(node, case, f"OpenGL gave {renderer.renderer}")
        return renderer

    def _say_plain_forms(self, node: pytest.Item, case: ShotCase, renderer: ContextInfo) -> None:
        """Report, once in this process, which fast variants do not run."""
        if self._plain_forms is None:
            self._plain_forms = PlainForms(silent, compute=renderer.compute, draws=renderer.software)
        self._plain_forms.notice = lambda message: node.user_properties.append((SUMMARY_LINE, message))
        self._plain_forms.report(case.sketch)

    def show_what_was_printed(self, node: pytest.Item) -> None:
        """Add what the child printed to the test's report, where pytest shows it if the test fails."""
        printed = self.renderer_process.printed()
        if printed.strip():
            node.add_report_section("call", "of the process that draws", printed)

    def accepting(self, node: pytest.Item, outcome: Outcome) -> str:
        """Return the command that would accept the picture; "" where none would."""
        if outcome.ok or self.plain or not VERDICTS[outcome.word].acceptable:
            return ""
        options = ["--shots-update"]
        if self.expected != REFERENCE_RENDERER:
            options.append(f"--shots-renderer={self.expected}")
        named = fallbacks_of(self.fallbacks, outcome.renderer.slug)
        if outcome.renderer.slug != self.expected and self.any_renderer and not named:
            options.append("--shots-any-renderer")
        return f"pytest {' '.join(options)} {shlex.quote(typed(node))}"

    # ── in words ─────────────────────────────────────────────────────────────

    def fail(self, node: pytest.Item, case: ShotCase, message: str) -> NoReturn:
        """Fail a test in which no picture was compared, with a record that reports it."""
        unrecorded = self.recorder.record_none(node, case, "error", message, 0.0)
        pytest.fail(_joined(message, unrecorded), pytrace=False)

    def raised(self, node: pytest.Item, case: ShotCase, error: PlaygroundError) -> PlaygroundError:
        """Return what a test is to raise for a mistake, with its word; it is recorded if the test fails."""
        word, message = word_of(error), str(error)
        raised = error if word == "error" else type(error)(f"{word}: {message}")
        node.stash[_RAISED] = _Raised(raised, word, message, case)
        return raised.with_traceback(None)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, None, None]:
        """Run the test, then fail it for its pictures."""
        skipped = ""
        try:
            yield
        except pytest.skip.Exception as reason:
            if not item.stash.get(_FAILURES, []):
                raise
            skipped = f"\n\nthen the test was skipped: {reason}"
        except Exception as error:
            if message := _take_failures(item):
                error.add_note(f"\nBefore that:\n{message}")
            raise
        except pytest.fail.Exception as failed:
            if message := _take_failures(item):
                failed.msg = f"{failed.msg}\n\nBefore that:\n{message}"
            raise
        if message := _take_failures(item):
            pytest.fail(message + skipped, pytrace=False)
        if not item.stash.get(_CHECKS, True) and not _may_be_checked_later(item):
            item.user_properties.append((UNCHECKED, ""))
            pytest.fail(_NOTHING_CHECKED, pytrace=False)
        item.stash[_ENDED_WELL] = True

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> None:
        """Write the record of a test that failed for what `raised` gave it."""
        raised = item.stash.get(_RAISED, None)
        if raised and call.when == "call" and call.excinfo and call.excinfo.value is raised.error:
            self.recorder.forget_earlier(item, raised.case)
            self.recorder.record_none(item, raised.case, raised.word, raised.message, call.duration)

    def _without(self, node: pytest.Item, case: ShotCase, text: str) -> NoReturn:
        message = f"the expected renderer is missing: shots are compared on {self.expected}; {text}"
        if os.environ.get("CI", "").lower() not in ("", "0", "false"):
            self.fail(node, case, f"{message} (a failure, for CI is set)")
        node.user_properties.append((UNCOMPARED, message))
        pytest.skip(message)

    def _without_picture(
        self, node: pytest.Item, case: ShotCase, error: PlaygroundError, start: float
    ) -> NoReturn:
        """Fail the test for a shot of which there is no picture, or that cannot be compared."""
        pytest.fail(self.record_missing(node, case, error, start), pytrace=False)

    def record_missing(self, node: pytest.Item, case: ShotCase, error: PlaygroundError, start: float) -> str:
        """Record a shot of which there is no picture, or that cannot be compared, and say why."""
        word = word_of(error)
        unrecorded = self.recorder.record_none(node, case, word, str(error), time.perf_counter() - start)
        message = f"{case}: {error}" if word == "error" else f"{case}: {word}: {error}"
        return _joined(message, unrecorded)

    def _compare(
        self, node: pytest.Item, case: ShotCase, frame: RenderedShot, renderer: ContextInfo
    ) -> Outcome:
        """Compare a frame with its references, which are written first if that is wanted and needed."""
        fallback = self._fallback(case, renderer)
        reference_renderer = self.expected if self.any_renderer else renderer.slug
        if fallback:
            reference_renderer = fallback.references
        strictly = fallback is not None and fallback.strictness == PIXELS
        outcome = check(case, frame, renderer, reference_renderer, by_pixels=strictly)
        if outcome.ok and self.updating:
            refusal = self._refusal(keeping(case.shot.name, node.nodeid), case, renderer)
            if refusal and not check(case, frame, renderer).ok:  # it was written meanwhile
                raise DataError(refusal, file=outcome.own_path)
            node.user_properties.append((UNCHANGED, str(case)))
        elif self._may_write(outcome):
            self._write(node, outcome)
            return check(case, frame, renderer)  # what was written is what will be read
        return outcome

    def _may_write(self, outcome: Outcome) -> bool:
        """Whether a reference is to be made of a picture that does not pass."""
        if not self.updating or not VERDICTS[outcome.word].acceptable:
            return False
        return self._failed is None or self.recorder.name_of(outcome.case) in self._failed

    def _fallback(self, case: ShotCase, renderer: ContextInfo) -> Fallback | None:
        """Return the line of the table by which a picture is compared; None for one's own references."""
        if accepted(case.sketch, case.shot.name, renderer.slug):
            return None
        return fallback_for(
            self.fallbacks,
            renderer.slug,
            lambda references: bool(accepted(case.sketch, case.shot.name, references)),
        )

    def _stands_in(self, outcome: Outcome) -> str:
        """Return whose references stood in for those of the renderer that drew, and by what; "" for none."""
        own = reference_path(outcome.case.sketch, outcome.case.shot.name, outcome.renderer.slug).parent
        if outcome.reference is None or outcome.reference.path.parent == own:
            return ""
        fallback = self._fallback(outcome.case, outcome.renderer)
        why = f"as shots_fallbacks has it ({fallback})" if fallback else "as --shots-any-renderer allows"
        how = "pixel by pixel" if fallback and fallback.strictness == PIXELS else "by structure only"
        references = outcome.reference.path.parent.name
        return f"drawn by {outcome.renderer.slug}, compared {how} with {references}'s references, {why}"

    def _write(self, node: pytest.Item, outcome: Outcome) -> None:
        case, pixels = outcome.case, outcome.frame.array
        path = outcome.own_path
        if refusal := self._refusal(writing(case.shot.name, node.nodeid, pixels), case, outcome.renderer):
            raise DataError(refusal, file=path)
        if path in self._written:
            return
        fingerprint = outcome.fingerprint
        written, removed = write_reference(
            case.sketch, case.shot.name, outcome.renderer, pixels, fingerprint.drawn, fingerprint.fonts
        )
        self._written.add(written)
        node.user_properties.append((SUMMARY_LINE, f"wrote {shown(written)}  ({outcome.message})"))
        for other in removed:
            line = f"removed {shown(other)}  (it let the picture before this one pass)"
            node.user_properties.append((SUMMARY_LINE, line))

    def _traced(self, case: ShotCase, outcome: Outcome) -> tuple[str, ...]:
        """Return lines that name the first value that differs from the reference's run, or why none do."""
        if outcome.word == "nan":
            bad = outcome.frame.first_bad if isinstance(outcome.frame, RenderedShot) else None
            return () if bad is None else bad.lines
        reference, seen = outcome.reference, outcome.perceived
        position = seen.place if seen is not None else outcome.comparison.position
        if position is None or reference is None or self.updating or case.shot not in case.sketch.shots:
            return ()
        start = time.perf_counter()
        try:
            if self._seconds_to_trace <= 0.0:
                raise NoTrace(f"the shots before it took the {TRACE_SECONDS:g} s that a run has for that")
            same_build = outcome.fingerprint.same_build(reference.fingerprint)
            search = search_for(case.sketch, case.shot, reference, position, same_build=same_build)
            return self.renderer_process.locate(search).lines
        except PlaygroundError as error:
            return (f"no trace: {error.diagnostics[0].message}",)
        except UnexpectedError:  # a trace explains a failure, and is none itself
            return ("no trace: the process that draws could not make it",)
        finally:
            self._seconds_to_trace -= time.perf_counter() - start

    def _explained(self, node: pytest.Item, outcome: Outcome, traced: Sequence[str]) -> str:
        lines = [f"{outcome.case}: {outcome.message}"]
        if self.updating and not VERDICTS[outcome.word].acceptable:
            lines.append("    not written: a broken picture is never a reference")
        elif self.updating:
            lines.append("    not written: it had not failed before")
        lines.append(f"    reference   {shown(outcome.path)}")
        lines += [f"                {line}" for line in outcome.differences]
        heads = ["first NaN" if outcome.word == "nan" else "first other", *[""] * len(traced)]
        lines += [f"    {head:<11} {line}" for head, line in zip(heads, traced, strict=False)]
        lines += [f"    {word:<11} {path}" for word, path in self.recorder.pictures(outcome.case)]
        command = self.accepting(node, outcome)
        if command:
            lines.append(f"    accept it   {command}")
        return "\n".join(lines)


def _result_or_error(function: Callable[[], Result]) -> Result | PlaygroundError:
    """Return the error that a function raises: a test that failed while it is handled would show it twice."""
    try:
        return function()
    except PlaygroundError as error:
        return error


def _joined(message: str, unrecorded: str) -> str:
    """Return why a test fails; ``unrecorded`` says why its result could not be recorded, if it could not."""
    return f"{message}\n    {unrecorded}" if unrecorded else message
