"""Try candidates: draw a case in worker processes, and say how it fails and whether that is the same failure.

A worker is replaced when it crashes or hangs: results, both. A candidate that fails in another way is no
smaller form of the failure in question: taking out a line that prevents a zero divisor makes a NaN of its
own. So each failure says of what came of a candidate what it found there, and whether that is the same.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.context import ContextInfo, context_info, open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.pool import OPEN, Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service
from playground.engine.sandbox import LIMIT_BYTES
from playground.engine.textures import drain, read_picture
from playground.errors import Diagnostic, ParameterError, PlaygroundError, ShaderError
from playground.files import write_file
from playground.sketch.load import load_with
from playground.sketch.model import Sketch
from playground.sketch.techniques import Techniques, WithLibrary
from playground.verify.reduce.case import SHOT, Case, copied
from playground.verify.reduce.edits import NUMBERS, NUMBERS_WITHOUT_ZERO

if TYPE_CHECKING:
    import moderngl


# ── worker processes ─────────────────────────────────────────────────────────


LIMIT = 10.0
"""[s] What one candidate may take before it counts as one that hangs."""

_FIRST_EXTRA = (
    60.0  # [s] more for a process's first answer: it compiles every pass and draws them at full size
)
_CACHE_BYTES = 256 * 2**20
_FILES = re.compile(r"\S+\.(?:glsl|frag|comp|toml)\b(?::\d+)*:?")


@dataclass(frozen=True, kw_only=True)
class DrawTask:
    """Draw one texture of a sketch."""

    sketch: Sketch | str  # loaded, or the path of its file
    ref: str = ""  # pass[:output]; "": the picture, as bytes
    driver: str = "auto"
    frame: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True, eq=False)
class DrawResult:
    """What came of drawing it."""

    kind: str  # drawn | shader | refused | gl-error | crash | hang
    messages: tuple[str, ...] = ()  # of each mistake, without its place
    values: NDArray[Any] | None = None  # float32, or uint8 of a picture
    details: str = ""  # the mistakes with their places


class CandidateProcess(PoolOwner):
    """Draws candidates in a process of its own, with an environment of its own.

    Mesa's shader cache is off there: a text that crashes the compiler must meet the compiler.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(
        self,
        *,
        software: bool = False,
        device: int | None = None,
        environment: Mapping[str, str] | None = None,
        limit: float = LIMIT,
    ) -> None:
        self.limit = limit  # [s]
        self._pool = Pool(
            __name__,
            Limits(memory_bytes=LIMIT_BYTES),
            options=(software, device),
            spare=True,
            environment={"MESA_SHADER_CACHE_DISABLE": "true", **(environment or {})},
        )
        self._warm = False  # the process has answered before

    @property
    def info(self) -> ContextInfo:
        """What draws; raises ``ContextError`` where there is no such renderer."""
        info = self._pool.run(OPEN).get("")
        assert isinstance(info, ContextInfo)
        return info

    @property
    def started(self) -> int:
        """How many processes there were."""
        return self._pool.started

    def draw(self, task: DrawTask) -> DrawResult:
        """Draw, and return what came of it; a crash and a hang are results too."""
        # Where candidates die, a process answers seldom more than once: then the limit is the limit.
        extra = 0.0 if self._warm or self._pool.died else _FIRST_EXTRA
        outcome = self._pool.run(task, seconds=self.limit + extra)
        self._warm = outcome.kind == "answer"
        if outcome.kind == "hang" and outcome.started:
            return DrawResult("hang", details=f"it took more than {self.limit:g} s and was stopped")
        if outcome.kind == "crash" and outcome.started and outcome.error is None:
            return DrawResult("crash", details=f"the process {outcome.ending}")
        result = outcome.get("drawing")
        assert isinstance(result, DrawResult)
        return result

    def renew(self) -> None:
        """Have the next candidate meet a fresh process."""
        self._warm = False
        self._pool.renew()


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    ctx = open_context(software=software, device=device)
    return Service(partial(_draw, ctx, {}, Techniques()), context_info(ctx))


def _draw(
    ctx: moderngl.Context, engines: dict[str, Engine], library: Techniques, task: DrawTask
) -> DrawResult:
    try:
        sketch = load_with(WithLibrary(library), task.sketch) if isinstance(task.sketch, str) else task.sketch
    except PlaygroundError as error:
        return _refused(error, "refused")
    drain(ctx)
    try:
        engine = engines.get(task.driver)
        if engine is None:
            engine = engines[task.driver] = Engine(
                ctx, driver=task.driver, cache_bytes=_CACHE_BYTES, notice=silent
            )
        steps = dict(task.steps)
        if task.ref:
            values: NDArray[Any] = engine.read(sketch, task.ref, size=task.frame, time=task.time, steps=steps)
        else:
            values = read_picture(engine.draw(sketch, size=task.frame, time=task.time, steps=steps))
    except ShaderError as error:
        return _refused(error, "shader")
    except PlaygroundError as error:
        return _refused(error, "refused")
    except MemoryError:
        return DrawResult("refused", ("memory ran out",), details="memory ran out")
    except Exception as error:  # a bug of ours, or moderngl's own
        message = f"{type(error).__name__}: {error}"
        return DrawResult("refused", (message,), details=message)
    if (gl_error := ctx.error) != "GL_NO_ERROR":
        return DrawResult("gl-error", (gl_error,), values, f"OpenGL reports {gl_error}")
    return DrawResult("drawn", values=values)


def _refused(error: PlaygroundError, kind: str) -> DrawResult:
    wrong = [d for d in error.diagnostics if d.severity == "error"]
    return DrawResult(kind, tuple(map(_message, wrong)), details=str(error))


def _message(diagnostic: Diagnostic) -> str:
    """Return a mistake without places in it."""
    return " ".join(_FILES.sub("", diagnostic.message).split())


# ── failures ─────────────────────────────────────────────────────────────────


_ROUNDING = 1e-5  # relative: what rounding explains; what lies beyond is another kind of difference


@dataclass(frozen=True, eq=False)
class Finding:
    """A failure: its kind, as text that stay the same from candidate to candidate, and where it is."""

    kind: str
    details: str = ""  # more of it, for a person
    where: NDArray[np.bool_] | None = None  # (ny, nx) of the texels that are wrong
    messages: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Side:
    """One way to draw a candidate."""

    process: int = 0
    driver: str = "auto"


class FailureKind(ABC):
    """A kind of failure; ``sides`` are the ways in which a candidate must be drawn to see it."""

    sides: tuple[Side, ...] = (Side(),)
    numbers: Sequence[int] = NUMBERS  # of literals that may be put in
    names_all: bool = True  # whether what fails names nothing more that is not declared
    as_picture = False  # whether the picture's bytes are looked at, not a pass's values

    @abstractmethod
    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong with a candidate; None where nothing of this kind is."""

    def same(self, before: Finding, after: Finding) -> bool:
        """Return whether a candidate fails as the one before did, and at no texel that was good."""
        if before.kind != after.kind:
            return False
        if before.where is None or after.where is None or before.where.shape != after.where.shape:
            return True
        return not bool((after.where & ~before.where).any())


class Refused(FailureKind):
    """The compiler refuses, with a message that a pattern finds."""

    def __init__(self, pattern: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._pattern = re.compile(pattern)

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        if results[0].kind != "shader":
            return None
        short = {_short(message): message for message in results[0].messages}
        hit = next((clause for clause, whole in short.items() if self._pattern.search(whole)), None)
        return None if hit is None else Finding(hit, results[0].details, messages=frozenset(short))

    def same(self, before: Finding, after: Finding) -> bool:
        """Return whether it is the same message, and none that was not there before."""
        return before.kind == after.kind and after.messages <= before.messages


class DriverFailure(FailureKind):
    """The driver crashes or hangs."""

    def __init__(self, kind: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._kinds = (kind,) if kind else ("crash", "hang")

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return how it died; None where it did not."""
        return Finding(results[0].kind, results[0].details) if results[0].kind in self._kinds else None


class NotFinite(FailureKind):
    """A value is NaN or infinite.

    No texel may become bad that was good, and what was bad in places may not become bad
    everywhere; nor are zeros put in, which make NaNs of their own. ``anywhere`` lets go of
    the first two: what is left is smaller, and may be a NaN of another making.
    """

    numbers = NUMBERS_WITHOUT_ZERO

    def __init__(self, driver: str = "auto", anywhere: bool = False) -> None:
        self.sides = (Side(driver=driver),)
        self._anywhere = anywhere

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = results[0].values
        if results[0].kind != "drawn" or values is None or values.dtype.kind != "f":
            return None
        wrong = _flat(~np.isfinite(values))
        if not wrong.any():
            return None
        kind = "NaN" if _flat(np.isnan(values)).any() else "infinite"
        whole = bool(wrong.all())
        count = int(wrong.sum())
        details = f"{count} of {wrong.size} texels are {kind}; first at {_first(wrong)}"
        if self._anywhere:
            return Finding(kind, details)
        return Finding(f"{kind} {'everywhere' if whole else 'in places'}", details, wrong)


class Differs(FailureKind):
    """Two ways to draw give other numbers, or only one of them draws at all.

    Where they agreed they must go on to agree, and what rounding explains is another
    kind of difference than what it does not.
    """

    def __init__(self, sides: tuple[Side, Side], names: tuple[str, str], tolerance: float = 0.0) -> None:
        self.sides = sides
        self._names = names
        self._tolerance = tolerance

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return how far they are apart; None where they are not."""
        left, other = results
        if left.kind != "drawn" or other.kind != "drawn":
            if left.kind == other.kind:
                return None
            bad, name = (left, self._names[0]) if left.kind != "drawn" else (other, self._names[1])
            if bad.kind == "refused" or "drawn" not in (left.kind, other.kind):
                return None
            message = _short(bad.messages[0]) if bad.messages else bad.details
            return Finding(f"only by {name}: {bad.kind} {message}", bad.details)
        assert left.values is not None and other.values is not None
        if left.values.shape != other.values.shape:
            return None
        return self._compared(left.values, other.values)

    def _compared(self, left: NDArray[Any], other: NDArray[Any]) -> Finding | None:
        first, second = left.astype(np.float64), other.astype(np.float64)
        good = np.isfinite(first) & np.isfinite(second)
        # NaN equals NaN, with any bits; an infinity is itself.
        with np.errstate(invalid="ignore"):
            alike = (first == second) | (np.isnan(first) & np.isnan(second))
            apart = np.where(good, np.abs(first - second), 0.0)
        wrong = ~alike & (~good | (apart > self._tolerance))
        if not wrong.any():
            return None
        scale = np.maximum(np.abs(first), np.abs(second), where=good, out=np.ones_like(first))
        wide = wrong & good & (apart > _ROUNDING * np.maximum(scale, 1e-30))
        flat = _flat(wrong)
        places = "everywhere" if flat.all() else "in places"
        if (wrong & ~good).any():
            kind = f"not finite by one of them {places}"
        elif wide.any():
            kind = f"differs widely {places}"
        else:
            kind = "differs in the last bits"
        worst = np.unravel_index(
            int(np.argmax(np.where(wrong, np.where(good, apart, np.inf), -1.0))), wrong.shape
        )
        details = (
            f"{int(flat.sum())} of {flat.size} texels differ, the most at {_place(worst)}:"
            f" {first[worst]:.9g} by {self._names[0]}, {second[worst]:.9g} by {self._names[1]}"
        )
        # Which texels rounding meets changes with every edit.
        return Finding(kind, details, None if kind.endswith("bits") else flat)


class OffReference(FailureKind):
    """A shot is not its reference: the pixels that were wrong must stay wrong in the same way.

    Any other picture would differ from the reference too, so the requirement is how each
    wrong pixel looks; those that were right are free.
    """

    as_picture = True

    def __init__(
        self, picture: NDArray[np.uint8], references: Sequence[NDArray[np.uint8]], tolerance: int
    ) -> None:
        self._picture = picture.astype(np.int16)
        self._tolerance = tolerance
        wrong = np.ones(picture.shape[:2], bool)
        for reference in references:
            if reference.shape == picture.shape:
                apart = np.abs(reference.astype(np.int16) - self._picture)
                wrong &= (apart > tolerance).any(axis=2)
        self.wrong = wrong

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = results[0].values
        if results[0].kind != "drawn" or values is None or values.shape != self._picture.shape:
            return None
        apart = np.abs(values.astype(np.int16) - self._picture)[self.wrong]
        if not self.wrong.any() or bool((apart > self._tolerance).any()):
            return None
        count = int(self.wrong.sum())
        details = f"{count} of {self.wrong.size} pixels are off the reference, first at {_first(self.wrong)}"
        return Finding("off its reference", details, self.wrong)


class CommandFailure(FailureKind):
    """A command of the user's says that a candidate fails."""

    sides = ()
    names_all = False  # it may be content with a text that does not compile

    def __init__(self, command: str) -> None:
        self.command = command

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return None: nothing is drawn, and the command's exit status tells."""
        return None


def _short(message: str) -> str:
    """Return a message's first clause: what follows lists candidates, or advises."""
    return message.partition(";")[0].strip()


def _flat(wrong: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (ny, nx): whether any component of a texel is wrong."""
    return np.asarray(wrong.any(axis=2)) if wrong.ndim == 3 else wrong


def _first(wrong: NDArray[np.bool_]) -> str:
    return _place(np.unravel_index(int(np.argmax(wrong)), wrong.shape))


def _place(index: Sequence[Any]) -> str:
    return f"({int(index[1])}, {int(index[0])})"


# ── a case against a failure ─────────────────────────────────────────────────


CANNOT_SAY = 125
"""Exit status of a command that cannot judge a candidate, as ``git bisect run`` has it."""


class Probe:
    """Tries cases against one failure."""

    def __init__(
        self, failure: FailureKind, processes: Sequence[CandidateProcess], folder: Path, limit: float
    ) -> None:
        self.failure = failure
        self.folder = folder
        self.limit = limit  # [s] of a command
        self._processes = processes
        self.refused = ""  # the error of a case that is no sketch, if there was one
        self._written: dict[str, str] = {}

    def find(self, case: Case) -> Finding | None:
        """Return how a case fails; None where it does not, or not in this way."""
        self.write(case)
        if isinstance(self.failure, CommandFailure):
            return self._commanded(self.failure.command)
        results: list[DrawResult] = []
        for side in self.failure.sides:
            task = task_of(case, str(self.folder / case.file), side.driver, self.failure.as_picture)
            results.append(self._processes[side.process].draw(task))
            if results[-1].kind == "refused":
                self.refused = results[-1].details
                return None
        return self.failure.finding(results)

    def renew(self) -> None:
        """End the processes, so that the next case gets new ones."""
        for process in self._processes:
            process.renew()

    def write(self, case: Case) -> None:
        """Write this case into the folder, and remove the files of the one before."""
        texts = case.texts()
        for name in self._written.keys() - texts.keys():
            (self.folder / name).unlink(missing_ok=True)
        for name, text in texts.items():
            if self._written.get(name) != text:
                write_file(self.folder / name, text)
        for name, source in copied(case.files, texts):
            if not (self.folder / name).exists():
                (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, self.folder / name)
        self._written = texts

    def _commanded(self, command: str) -> Finding | None:
        """Run the user's command in the folder: status 0 is good, 125 no answer, up to 127 a failure."""
        try:
            done = subprocess.run(
                command,
                shell=True,
                cwd=self.folder,
                env={**os.environ, "PLAYGROUND_SHOT": SHOT},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=self.limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        status = done.returncode
        if status < 0 or status > 127:
            raise ParameterError(
                f"--command ended with status {status}: expected 0 where all is well, 1 to 127 where it"
                f" fails, {CANNOT_SAY} where it cannot say"
            )
        if sys.platform != "win32" and status in (126, 127):
            raise ParameterError(f"--command could not be run: the shell ended with status {status}")
        return (
            None if status in (0, CANNOT_SAY) else Finding("fails", f"the command ended with status {status}")
        )


def task_of(case: Case, sketch: str, driver: str, as_picture: bool = False) -> DrawTask:
    """Return the task to draw a case that is in a file."""
    names = {pass_.name for pass_ in case.live}
    steps = tuple((path, steps) for path, steps in case.steps if path in names)
    ref = "" if as_picture else "view" if case.file != "sketch.toml" else case.target
    return DrawTask(sketch=sketch, ref=ref, driver=driver, frame=case.frame, time=case.time, steps=steps)
