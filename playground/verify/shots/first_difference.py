"""Name the line at which a failing shot parts from its reference: for the worst pixel, the first other value.

A reference is a picture, so the run that drew it is run again, from the texts that git has: those of the
commit that wrote the reference, where the hash in the reference says that they drew it, else the last
committed ones, which the answer says. From the worst pixel the search goes up the inputs that differ between
the two runs, to the pass whose inputs are the same, of a repeat to its first iteration that differs; there
both runs are traced at one texel.

It explains a failure and never changes it: what cannot be traced is said in a sentence, and time is bounded.
"""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import TEXTS, reading_unsaved
from playground.engine.frame import reduced
from playground.engine.plan import LoopStep, Plan, Step, drawn_size, every_node
from playground.engine.textures import read_picture, read_texture
from playground.engine.trace.instrument import ALL
from playground.engine.trace.listing import event_text, text_of
from playground.engine.trace.model import Event, first_difference
from playground.engine.unfinished import PassesUnfinished
from playground.errors import PlaygroundError
from playground.paths import GLSL, shown
from playground.shader.parameter import spell
from playground.sketch.flat import Ref
from playground.sketch.load import load
from playground.sketch.model import Shot, Sketch, TexelKernel
from playground.verify.shots.compare import TOLERANCE

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.engine.non_finite import NotFinite
    from playground.engine.trace.model import Trace
    from playground.verify.shots.references import Reference

SECONDS = 10.0
"""[s] that one search may take; most take one or two."""

_GIT_SECONDS = 10.0  # that git may take for one answer
_BLOB = re.compile(rb"[0-9a-f]+ blob ([0-9]+)")  # what git says before a file
_MAX_VALUES = 4  # parameters that are named
_MAX_FILES = 2_000  # texts that may have changed since


class NoTrace(PlaygroundError):
    """Why a failing shot has no first line that differs, as a sentence."""


# ── the texts of the reference's run ─────────────────────────────────────────


class Revision(NamedTuple):
    """The texts of a commit, as far as they are others than those in the folder now."""

    commit: str  # short
    texts: tuple[tuple[Path, str], ...]  # by absolute path
    wrote_reference: bool  # else it is the last one


@dataclass(frozen=True)
class Search:
    """The question of where a shot parts from its reference's run, for a process that renders."""

    sketch: Sketch
    shot: Shot
    pixel: tuple[int, int]  # x and y, from the top left
    expected: tuple[int, ...]  # what the reference has there, as bytes
    drawn: str  # hash of what the reference was drawn from; "": it does not say
    same_build: bool  # of the renderer drew the reference, as far as it says
    revisions: tuple[Revision, ...]  # the likeliest first
    seconds: float = SECONDS


@dataclass(frozen=True)
class Difference:
    """Where a shot parts from its reference's run."""

    sentence: str  # what differs
    at: str  # pass, texel and iteration
    run: str = ""  # which run the reference's is; "": only one is looked at
    values: tuple[str, ...] = ()  # the pass's own that are others, as text
    path: str = ""  # absolute, of the author's file; "" where no line is known
    line: int = 0  # from 1
    now: str = ""  # that line
    before: str = ""  # and that of the reference's run

    @property
    def lines(self) -> tuple[str, ...]:
        """Return it as text, a line each."""
        run = (f"the reference's run: {self.run}",) if self.run else ()
        where = f"{shown(self.path)}:{self.line}: " if self.path else ""
        codes = [f"{name:<7} {code}" for name, code in (("now", self.now), ("before", self.before)) if code]
        values = [f"{'values':<7} {value}" for value in self.values]
        return f"{where}{self.sentence}  ({self.at})", *codes, *values, *run


def search_for(
    sketch: Sketch, shot: Shot, reference: Reference, pixel: tuple[int, int], *, same_build: bool
) -> Search:
    """Return what to search for a shot that differs from its reference at a pixel, from the top left.

    Raises ``NoTrace`` where git has no texts.
    """
    revisions = tuple(_revisions(reference.path, [Path(sketch.folder), GLSL]))
    expected = tuple(reference.pixels[pixel[1], pixel[0]].tolist())
    return Search(sketch, shot, pixel, expected, reference.fingerprint.drawn, same_build, revisions)


def _revisions(reference: Path, folders: Sequence[Path]) -> Iterator[Revision]:
    """Yield the commit that wrote a reference, then the last one; raise ``NoTrace`` without any."""
    top = _git(reference.parent, "rev-parse", "--show-toplevel")
    if not top:
        raise NoTrace("the reference lies in no repository of git, so the texts that drew it are not known")
    root = Path(top.decode().rstrip("\n"))
    names = [name for folder in folders if (name := _name_in(folder, root))]
    last = _git(root, "rev-parse", "--short", "HEAD").decode().strip()
    if not last or not names:
        raise NoTrace("nothing is committed yet, so the texts that drew the reference are not known")
    edited = _git(root, "status", "--porcelain", "--", str(reference)).strip()
    wrote = b"" if edited else _git(root, "log", "-1", "--format=%h", "--", str(reference))
    for commit in dict.fromkeys(filter(None, [wrote.decode().strip(), last])):
        yield Revision(commit, _texts_of(root, commit, names), commit == wrote.decode().strip())


def _name_in(folder: Path, root: Path) -> str:
    """Return a folder's name in a repository; "" where it lies in another, or in none."""
    folder = folder.resolve()
    return folder.relative_to(root).as_posix() if folder.is_relative_to(root) else ""


def _texts_of(root: Path, commit: str, names: Sequence[str]) -> tuple[tuple[Path, str], ...]:
    """Return the texts in some folders that are others than now, or gone now, by absolute path."""
    listed = _git(
        root, "diff", "--name-only", "--no-renames", "--diff-filter=MDT", "-z", commit, "--", *names
    )
    paths = [name for name in listed.decode(errors="replace").split("\0") if name.endswith(TEXTS)]
    if len(paths) > _MAX_FILES:
        return ()
    asked = "".join(f"{commit}:{name}\n" for name in paths).encode()
    answer, texts = _git(root, "cat-file", "--batch", given=asked), []
    for name in paths:
        head, _, answer = answer.partition(b"\n")
        if blob := _BLOB.fullmatch(head):
            size = int(blob[1])
            texts.append((root / name, answer[:size].decode("utf-8", "replace")))
            answer = answer[size + 1 :]
    return tuple(texts)


def _git(folder: Path, *arguments: str, given: bytes = b"") -> bytes:
    """Return what git answers; b"" where it has no answer, or is not there."""
    quiet = {"GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C", "GIT_TERMINAL_PROMPT": "0"}
    command = ["git", "-C", str(folder), "-c", "core.quotePath=false", *arguments]
    try:
        done = subprocess.run(
            command, input=given, capture_output=True, timeout=_GIT_SECONDS, env=os.environ | quiet
        )
    except (OSError, subprocess.SubprocessError):
        return b""
    return done.stdout if done.returncode == 0 else b""


# ── in the process that renders ──────────────────────────────────────────────


@dataclass(frozen=True)
class _Run:
    """One of the two runs: a plan whose textures can be read."""

    engine: Engine
    plan: Plan
    texts: Mapping[Path, str]  # in place of what files hold

    def stopped(self, path: str, steps: int) -> _Run:
        """Return the same run, a repeat of it stopped after so many steps."""
        plan = self.plan
        with reading_unsaved(self.texts):
            stopped = self.engine.plan(
                plan.sketch, plan.frame_size, plan.time, {**plan.steps, path: steps}, interpolated=False
            )
        return replace(self, plan=stopped)

    def array(self, ref: Ref) -> NDArray[np.float32]:
        """Return a texture's texels, (ny, nx, components), row 0 south."""
        with reading_unsaved(self.texts):
            array = read_texture(self.engine.texture_of(self.plan, ref))
        return array[..., None] if array.ndim == 2 else array

    def gives(self, pixel: tuple[int, int], expected: tuple[int, ...]) -> bool:
        """Return whether its picture has a pixel, to within the rounding of one level."""
        texture = self.engine.texture_of(self.plan, self.plan.picture)
        pixels = reduced(read_picture(texture), self.plan.sketch.picture.supersample)
        apart = np.abs(pixels[pixel[1], pixel[0]].astype(int) - expected)
        return int(apart.max()) <= TOLERANCE

    def trace(self, path: str, texel: tuple[int, int], functions: str | None) -> Trace:
        """Return every value of one texel of a pass, in its last iteration."""
        with reading_unsaved(self.texts):
            return self.engine.tracer.trace(self.plan, path, texel, None, functions)


def _run(engine: Engine, sketch: Sketch, shot: Shot, texts: Mapping[Path, str]) -> _Run:
    """Draw a shot of a sketch."""
    with reading_unsaved(texts):
        size = drawn_size(sketch, shot.size)
        engine.draw(sketch, size=size, time=shot.time, steps=dict(shot.steps))
    plan = engine.record.plan
    assert plan is not None
    return _Run(engine, plan, texts)


class _Origin(NamedTuple):
    """Where two runs part: what the pass reads is the same in both."""

    now: _Run
    before: _Run
    path: str
    texel: tuple[int, int]  # from the south-west
    iteration: int | None  # of a repeat, from 0: the first that differs


def locate(engine: Engine, search: Search) -> Difference:
    """Return where a shot parts from its reference's run; raise ``NoTrace``."""
    stop = time.monotonic() + search.seconds
    before_piece, engine.options.piece = engine.options.piece, lambda: time.monotonic() > stop
    try:
        return _located(engine, search)
    except PassesUnfinished:
        raise NoTrace(f"the two runs take longer than {search.seconds:g} s") from None
    finally:
        engine.options.piece = before_piece


def _located(engine: Engine, search: Search) -> Difference:
    shot, sketch = search.shot, search.sketch.for_shot(search.shot)
    before, revision, proof = _reference_run(engine, search)
    now = _run(engine, sketch, shot, {})
    if engine.picture_hash(now.plan) == engine.picture_hash(before.plan):
        other = "the playground has changed, or a file" if search.same_build else "another renderer drew it"
        raise NoTrace(f"texts and values are those of the reference (commit {revision.commit}): {other}")
    ref = now.plan.picture
    texel = _texel_of(search.pixel, now, before)
    return _found(_origin(now, before, ref, texel), f"texts of commit {revision.commit}, {proof}")


def _reference_run(engine: Engine, search: Search) -> tuple[_Run, Revision, str]:
    """Return the run that drew the reference, as near as git has it, and what makes it that."""
    runs = []
    for revision in search.revisions:
        texts = dict(revision.texts)
        try:
            with reading_unsaved(texts):
                sketch = load(search.sketch.file).plainly(search.sketch.plain)
                shot = next((s for s in sketch.shots if s.name == search.shot.name), None)
            if shot is not None and shot.size == search.shot.size:
                run = _run(engine, sketch.for_shot(shot), shot, texts)
                if search.drawn and engine.picture_hash(run.plan) == search.drawn:
                    return run, revision, "which drew it, as its hash says"
                if run.gives(search.pixel, search.expected):
                    return run, revision, "which give its pixel"
                runs.append((run, revision))
        except PlaygroundError:
            continue  # texts of that commit that this version does not take
    if not runs:
        raise NoTrace("the texts of the reference's commit give no picture of this shot and size any more")
    run, revision = runs[-1]
    return run, revision, "the last one; whether they drew the reference is not known"


def _texel_of(pixel: tuple[int, int], now: _Run, before: _Run) -> tuple[int, int]:
    """Return the texel of the picture under a pixel: of several the one that differs most."""
    times = now.plan.sketch.picture.supersample
    left, low = pixel[0] * times, now.plan.frame_size[1] - (pixel[1] + 1) * times
    if times == 1:
        return left, low
    block = np.s_[low : low + times, left : left + times]
    x, y = _worst(now.array(now.plan.picture)[block], before.array(before.plan.picture)[block])
    return left + x, low + y


def _differing(one: NDArray[np.float32], other: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return where texels differ, (ny, nx); NaN equals NaN."""
    differs: NDArray[np.bool_] = np.any((one != other) & ~(np.isnan(one) & np.isnan(other)), axis=2)
    return differs


def _worst(one: NDArray[np.float32], other: NDArray[np.float32]) -> tuple[int, int]:
    """Return column and row of the texel that differs most."""
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(one - other)
    apart[np.isnan(apart)] = np.inf
    by = np.where(_differing(one, other), apart.max(axis=2), np.float32(-1.0))
    y, x = divmod(int(by.argmax()), by.shape[1])
    return x, y


def _origin(now: _Run, before: _Run, ref: Ref, texel: tuple[int, int]) -> _Origin:
    """Go up the inputs that differ, from a texel that does, to the pass where that begins."""
    iteration: int | None = None
    while True:
        if iteration is None and (repeat := _repeat_of(now.plan, ref.path)):
            now, before, iteration = _first_iteration(now, before, ref, repeat)
            texel = _nearest(now, before, ref, texel)
        step, other = now.plan.step(ref.path), before.plan.step(ref.path)
        if step is None or other is None:
            raise NoTrace(f"pass {ref.path} is not in the reference's run")
        upstream = _upstream(now, before, step, other, texel)
        if upstream is None:
            return _Origin(now, before, ref.path, texel, iteration)
        if _repeat_of(now.plan, upstream[0].path) != _repeat_of(now.plan, ref.path):
            iteration = None
        ref, texel = upstream


def _upstream(
    now: _Run, before: _Run, step: Step, other: Step, texel: tuple[int, int]
) -> tuple[Ref, tuple[int, int]] | None:
    """Return the input of a step that differs between the runs, best at the texel itself; None for none."""
    found: tuple[Ref, tuple[int, int]] | None = None
    theirs = dict(other.inputs)
    for name, source in step.inputs:
        if not isinstance(source, Ref) or theirs.get(name) != source:
            continue  # what a loop feeds back is the same at its first iteration; another wire is the origin
        if before.plan.step(source.path) is None:
            continue
        ours, other_array = now.array(source), before.array(source)
        if ours.shape != other_array.shape:
            raise NoTrace(f"pass {source.path} has another size than in the reference's run")
        differs = _differing(ours, other_array)
        x, y = texel
        if step.size == (ours.shape[1], ours.shape[0]) and differs[y, x]:
            return source, texel
        if found is None and differs.any():
            found = source, _worst(ours, other_array)
    return found


def _nearest(now: _Run, before: _Run, ref: Ref, texel: tuple[int, int]) -> tuple[int, int]:
    """Return a texel if it differs, else the one that differs most."""
    one, other = now.array(ref), before.array(ref)
    return texel if _differing(one, other)[texel[1], texel[0]] else _worst(one, other)


def _repeat_of(plan: Plan, path: str) -> str:
    """Return the path of the repeat that a pass is or is in, the outermost; "" for none."""
    for node in plan.nodes:
        if isinstance(node, LoopStep):
            if any(inside.path == path for inside in every_node((node,))):
                return node.path
        elif node.path == path and isinstance(node.kernel, TexelKernel) and node.total > 1:
            return path
    return ""


def _first_iteration(now: _Run, before: _Run, ref: Ref, repeat: str) -> tuple[_Run, _Run, int]:
    """Return the runs stopped after the first iteration in which an output differs, and its number from 0."""

    def differ(steps: int) -> bool:
        return bool(
            _differing(now.stopped(repeat, steps).array(ref), before.stopped(repeat, steps).array(ref)).any()
        )

    node = now.plan.node(repeat)
    assert node is not None
    low, high = 0, node.repeat  # after `low` steps the same, after `high` others
    if high > 1 and differ(1):
        high = 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if differ(middle) else (middle, high)
    return now.stopped(repeat, high), before.stopped(repeat, high), high - 1


# ── what differs ─────────────────────────────────────────────────────────────


def _found(origin: _Origin, run: str) -> Difference:
    """Return where two runs part; ``run`` says which the reference's is."""
    x, y = origin.texel
    iteration = "" if origin.iteration is None else f", iteration {origin.iteration}"
    at = f"pass {origin.path}, texel ({x}, {y}){iteration}"
    values = _other_values(origin)
    try:
        traces = [
            run.trace(origin.path, origin.texel, _functions(origin)) for run in (origin.now, origin.before)
        ]
    except PlaygroundError as error:
        return Difference(f"its values cannot be traced: {error.diagnostics[0].message}", at, run, values)
    events = first_difference(*traces)
    if events is None:
        return Difference("every recorded value is the same, but not what is given", at, run, values)
    now, before = events
    codes = [_code(trace, event) for trace, event in zip(traces, events, strict=True)]
    event = now or before
    assert event is not None
    return Difference(_sentence(now, before), at, run, values, event.path, event.line, *codes)


def _other_values(origin: _Origin) -> tuple[str, ...]:
    """Return the parameters of a pass whose values are others in the reference's run, as text."""
    now, before = (run.plan.step(origin.path) for run in (origin.now, origin.before))
    assert now is not None and before is not None
    names = [
        name for name, value in now.values.items() if name in before.values and before.values[name] != value
    ]
    values = [f"{name} = {spell(now.values[name])}, was {spell(before.values[name])}" for name in names]
    return tuple(values[:_MAX_VALUES])


def first_not_finite(engine: Engine, found: NotFinite) -> Difference | None:
    """Return where a number that is not finite begins, in the run of the last frame that gave one."""
    try:
        trace = engine.trace_frame(found.path, texel=found.texel)
    except PlaygroundError:
        return None
    event = trace.first_not_finite()
    if event is None:
        return None
    x, y = found.texel
    at = f"pass {found.path}, texel ({x}, {y})"
    return Difference(event_text(event), at, "", (), event.path, event.line, _code(trace, event))


def _functions(origin: _Origin) -> str | None:
    """Return which functions are traced: all where an included file differs, which compile longer."""
    texts = []
    for run in (origin.now, origin.before):
        step = run.plan.step(origin.path)
        assert step is not None
        source = step.kernel.source
        texts.append([line.code for line in source.lines if line.file != source.path and line.code.strip()])
    return None if texts[0] == texts[1] else ALL


def _code(trace: Trace, event: Event | None) -> str:
    """Return the line of an event."""
    lines = () if event is None else trace.files.get(event.path, ())
    return lines[event.line - 1].strip() if event is not None and event.line <= len(lines) else ""


def _sentence(now: Event | None, before: Event | None) -> str:
    """Return how two events differ."""
    if now is None or before is None:
        return f"only the {'reference' if now is None else 'new'} run goes on here"
    if (now.kind, now.name) == (before.kind, before.name):
        return f"{event_text(now)}, in the reference's run {text_of(before.value)}"
    return f"{event_text(now)}, where the reference's run has {event_text(before)}"
