"""Find what fails, and in which pass: the case that the search begins with.

Passes are tried in the order in which they run, so the first that fails has been given
nothing wrong. What fails only sometimes is refused, since no candidate could be believed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from playground.engine.context import ContextInfo
from playground.engine.frame import Frame
from playground.errors import DataError, ParameterError, nearest
from playground.shader.wrap import COMPUTE, FRAGMENT
from playground.sketch.model import Sketch
from playground.verify.reduce.candidate import (
    LIMIT,
    CandidateProcess,
    CommandFailure,
    Differs,
    DrawTask,
    DriverFailure,
    FailureKind,
    Finding,
    NotFinite,
    OffReference,
    Probe,
    Refused,
    Side,
)
from playground.verify.reduce.case import Case, inline_sketch
from playground.verify.shots.compare import TOLERANCE
from playground.verify.shots.suite import ShotCase, check

KINDS = ("", "shot", "drivers", "against", "nan", "error", "crash", "hang", "command")
"""What failing may mean; "" is to look for it."""


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """What failing means."""

    kind: str = ""  # one of KINDS
    pattern: str = ""  # of an error's message
    command: str = ""
    tolerance: float = 0.0
    anywhere: bool = False  # NaN at other texels than before counts too


@dataclass(frozen=True, kw_only=True)
class Question:
    """What fails, and how to look for it."""

    sketch: Sketch
    criterion: Criterion = Criterion()
    shot: str = ""
    frame: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    steps: Mapping[str, int] = field(default_factory=dict)
    path: str = ""  # the pass to look at; "": the first that fails
    driver: str = ""  # "": both, one after the other
    environment: Mapping[str, str] = field(default_factory=dict)  # of the other side
    other_device: int | None = None
    software: bool = False
    device: int | None = None
    limit: float = LIMIT  # [s] a candidate


@dataclass(frozen=True, eq=False)
class InitialCase:
    """A case that fails, and what tries others."""

    case: Case
    finding: Finding
    probe: Probe
    renderers: tuple[ContextInfo, ...]  # of each side; none where a command judges


class CandidateBench:
    """The folder and the processes that candidates are tried in; use it with ``with``."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self._stack = ExitStack()
        self._folder = Path()
        self.processes: list[CandidateProcess] = []

    def __enter__(self) -> CandidateBench:
        question = self.question
        self._folder = Path(self._stack.enter_context(TemporaryDirectory(prefix="playground-reduce-")))
        make = {"software": question.software, "limit": question.limit}
        self.processes = [self._stack.enter_context(CandidateProcess(device=question.device, **make))]  # type: ignore[arg-type]
        if question.criterion.kind == "against":
            device = question.device if question.other_device is None else question.other_device
            other = CandidateProcess(device=device, environment=question.environment, **make)  # type: ignore[arg-type]
            self.processes.append(self._stack.enter_context(other))
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def begin(self) -> InitialCase:
        """Return the case to shrink; raise ``DataError`` where nothing fails, or only sometimes."""
        question = self.question
        sketch = (
            question.sketch.for_shot(question.sketch.shot(question.shot))
            if question.shot
            else question.sketch
        )
        case = inline_sketch(sketch, frame=question.frame, time=question.time, steps=dict(question.steps))
        refused = ""
        for failure, candidate in self._possible(case):
            probe = Probe(failure, self.processes, self._folder, question.limit)
            finding = probe.find(candidate)
            refused = refused or probe.refused
            if finding is None:
                continue
            probe.renew()
            again = probe.find(candidate)
            if again is None or not failure.same(finding, again):
                raise DataError(f"it fails only sometimes ({finding.kind}): one try proves nothing")
            if question.criterion.kind == "command":
                return InitialCase(candidate, finding, probe, ())
            renderers = tuple(self.processes[number].info for number in range(len(self.processes)))
            return InitialCase(candidate, finding, probe, renderers)
        if refused:
            raise DataError(f"{question.sketch.name} cannot be drawn, and so cannot be judged: {refused}")
        raise DataError(_nothing(question))

    def _possible(self, case: Case) -> Iterator[tuple[FailureKind, Case]]:
        """Yield what may be the failure, and where, in the order in which it is looked for."""
        question = self.question
        if question.criterion.kind == "command":
            yield CommandFailure(question.criterion.command), self._chosen(case)[-1]
        elif question.criterion.kind == "shot":
            yield self._off_reference(), case
        elif question.criterion.kind:
            for failure in self._failures(question.criterion.kind):
                yield from ((failure, candidate) for candidate in self._chosen(case))
        else:
            # A pass may fail in any way before the next is drawn, which may take long.
            failures = [failure for kind in ("error", "crash", "nan") for failure in self._failures(kind)]
            yield from ((failure, candidate) for candidate in self._chosen(case) for failure in failures)
            yield from (
                (failure, candidate)
                for failure in self._failures("drivers")
                for candidate in self._chosen(case)
            )

    def _chosen(self, case: Case) -> list[Case]:
        """Return the case looking at each pass, or at the one that was named."""
        names = [pass_.name for pass_ in case.passes]
        if not self.question.path:
            return [case.looking_at(name) for name in names]
        target_name = self.question.path.replace(".", "_")
        inside = [name for name in names if name == target_name or name.startswith(f"{target_name}_")]
        if not inside:
            raise ParameterError(f"--pass {self.question.path}: no such pass{nearest(target_name, names)}")
        return [case.looking_at(name) for name in inside]

    def _failures(self, kind: str) -> list[FailureKind]:
        question = self.question
        if kind == "against":
            driver = question.driver or "auto"
            names = (
                "here",
                " ".join(f"{k}={v}" for k, v in question.environment.items()) or "the other device",
            )
            return [Differs((Side(0, driver), Side(1, driver)), names, question.criterion.tolerance)]
        compute = self.processes[0].info.compute
        if kind == "drivers":
            if not compute:
                if question.criterion.kind:
                    opengl = self.processes[0].info.opengl
                    raise DataError(f"this context is {opengl}; the compute driver needs 4.3")
                return []
            sides = (Side(0, FRAGMENT), Side(0, COMPUTE))
            return [Differs(sides, (FRAGMENT, COMPUTE), question.criterion.tolerance)]
        drivers = [question.driver] if question.driver else [FRAGMENT, *([COMPUTE] if compute else [])]
        if kind == "nan":
            return [NotFinite(driver, question.criterion.anywhere) for driver in drivers]
        if kind == "error":
            return [Refused(question.criterion.pattern, driver) for driver in drivers]
        word = kind if question.criterion.kind else ""  # a hang counts too where no kind was named
        return [DriverFailure(word, driver) for driver in drivers]

    def _off_reference(self) -> FailureKind:
        question = self.question
        shot = question.sketch.shot(question.shot)
        process = self.processes[0]
        shown = question.sketch.for_shot(shot)
        steps = tuple(question.steps.items())
        result = process.draw(
            DrawTask(
                sketch=shown,
                ref="",
                driver=question.driver or "auto",
                frame=shot.size,
                time=shot.time,
                steps=steps,
            )
        )
        if result.values is None:
            raise DataError(f"shot '{shot.name}' gives no picture: {result.details.splitlines()[0]}")
        case = ShotCase(question.sketch, shot)
        outcome = check(case, Frame(result.values, question.sketch.name, shot.time), process.info)
        if outcome.reference is None:
            raise DataError(
                f"shot '{shot.name}' has no reference for {process.info.slug}: nothing to differ from"
            )
        if outcome.ok:
            raise DataError(f"shot '{shot.name}' is as its reference; nothing fails")
        failure = OffReference(result.values, [outcome.reference.pixels], TOLERANCE)
        if not failure.wrong.any():
            raise DataError(f"shot '{shot.name}' fails, but no pixel is off by more than {TOLERANCE} of 255")
        failure.sides = (Side(0, question.driver or "auto"),)
        return failure


def _nothing(question: Question) -> str:
    """Return the message that nothing fails, in the words of the question."""
    name = question.sketch.name
    if question.criterion.kind == "shot":
        return (
            f"shot '{question.shot}' of {name} is off its reference, but not once its techniques are inlined;"
            " a compute shader that replaces a whole technique may be the cause: try --driver fragment"
        )
    nothing = {
        "": "it compiles and draws, every value is finite, and both drivers give the same bits",
        "drivers": "both drivers give the same",
        "against": "both sides give the same",
        "nan": "every value of every pass is finite",
        "error": f"the compiler refuses nothing with a message that {question.criterion.pattern!r} finds",
        "crash": "the driver does not crash",
        "hang": f"nothing takes longer than {question.limit:g} s",
        "command": "the command says that all is well",
    }[question.criterion.kind]
    return f"{name} does not fail: {nothing}"
