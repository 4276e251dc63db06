"""What is wrong with a sketch just now, as a list to look through: errors and warnings, by file.

The messages are those that the terminal prints, where each error comes once while it lasts.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from playground.allowed_files import reading_unsaved, root_of, unsaved_texts
from playground.data.content_hash import content_hash
from playground.data.live_inputs import LiveInputs
from playground.engine.plan import Plan
from playground.engine.plan_warnings import source_warnings
from playground.engine.sketch_warnings import warnings_of_kernel
from playground.errors import Diagnostic, PlaygroundError
from playground.files import read_regular
from playground.memo import FILES
from playground.paths import GLSL, without_part
from playground.sketch.model import Graph, Kernel, Sketch, kernels_of
from playground.sketch.techniques import Techniques
from playground.sketch.warnings import warnings_of_sketch
from playground.studio.language import counted, tr
from playground.studio.reload.dependencies import path_named

AROUND = 2
"""Lines shown above and below the one that is wrong."""


@dataclass
class Problems:
    """The list, which of it is looked at, and whether it is open."""

    errors: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    open: bool = False
    at: int = -1  # which is looked at; -1: none yet
    heights: dict[tuple[int, float], float] = field(default_factory=dict)  # of each as drawn, by width
    moved: bool = False  # it was moved to another, which must come into view
    is_quiet: bool = False  # code is being typed, with mistakes behind its lines: the list does not open
    unsaved: Mapping[Path, str] = field(default_factory=dict)  # texts in place of what files hold, by path
    _error: PlaygroundError | None = None
    _also: tuple[Diagnostic, ...] = ()  # mistakes in files after the first wrong one

    @property
    def all(self) -> tuple[Diagnostic, ...]:
        """Everything, file by file: files with errors first, in each the errors first."""
        return tuple(d for _, mine in self.by_file() for d in mine)

    def take(
        self,
        error: PlaygroundError | None,
        warnings: Iterable[Diagnostic] = (),
        sketch: Sketch | None = None,
    ) -> None:
        """Take in what is wrong now. A new error opens the list; once fixed, an open list closes.

        ``sketch`` is the one that is shown: what else of its files cannot be read is reported as well.
        """
        with reading_unsaved(self.unsaved):
            self._take(error, warnings, sketch)

    def _take(
        self, error: PlaygroundError | None, warnings: Iterable[Diagnostic], sketch: Sketch | None
    ) -> None:
        if error is not self._error:
            self._also = () if error is None else unreadable(sketch)
        diagnostics = () if error is None else tuple(dict.fromkeys((*error.diagnostics, *self._also)))
        errors = tuple(d for d in diagnostics if d.severity == "error")
        mild = [*(d for d in diagnostics if d.severity != "error"), *warnings]
        keys = {(d.file, d.line, d.message) for d in errors}
        before = self.errors, self.warnings
        self.warnings = tuple(
            moved
            for d in dict.fromkeys(mild)
            if (d.file, d.line, d.message) not in keys and (moved := self.moved_with_its_line(d)) is not None
        )
        if error is not self._error:
            self._error, self.errors = error, errors
            self.at = min(self.at, len(self.all) - 1)
            self.open = error is not None and (self.open or not self.is_quiet)
        elif not self.errors and not self.warnings:
            self.open, self.at = False, -1
        if before != (self.errors, self.warnings):
            self.heights.clear()

    def by_file(self) -> list[tuple[str, list[Diagnostic]]]:
        """Return (file, what is wrong with it), each file once; "" means no file."""
        diagnostics: dict[str, list[Diagnostic]] = {}
        for diagnostic in (*self.errors, *self.warnings):
            diagnostics.setdefault(diagnostic.file, []).append(diagnostic)
        return list(diagnostics.items())

    def step(self, by: int) -> None:
        """Look at the next one, or the one before; round and round."""
        count = len(self.all)
        if count:
            self.at = (self.at + by) % count if self.at >= 0 else (0 if by > 0 else count - 1)
            self.open = self.moved = True

    def headline(self) -> str:
        """Return "2 errors, 1 warning in 2 files"."""
        parts = [counted(len(self.errors), "error")] if self.errors else []
        parts += [counted(len(self.warnings), "warning")] if self.warnings else []
        files = len({d.file for d in (*self.errors, *self.warnings) if d.file})
        return ", ".join(parts) + (tr(" in {files}", files=counted(files, "file")) if files > 1 else "")

    def text(self) -> str:
        """Return everything, as the terminal prints it."""
        return "\n".join(str(d) if d.severity == "error" else f"{d.severity}: {d}" for d in self.all)

    # ── the lines around ─────────────────────────────────────────────────────

    def lines_around(self, diagnostic: Diagnostic) -> list[tuple[int, str]]:
        """Return (number, text) of the lines around a mistake; its own alone where the file has gone on."""
        if not diagnostic.line:
            return []
        with reading_unsaved(self.unsaved):
            lines = _lines_of(diagnostic.file)
        here = diagnostic.line - 1
        own = diagnostic.excerpt or (lines[here] if here < len(lines) else "")
        if here >= len(lines) or lines[here].rstrip() != own.rstrip():
            return [(diagnostic.line, own)] if own.strip() else []
        low, high = max(here - AROUND, 0), min(here + AROUND + 1, len(lines))
        while high > here + 1 and not lines[high - 1].strip():
            high -= 1
        while low < here and not lines[low].strip():
            low += 1
        return [(number + 1, lines[number]) for number in range(low, high)]

    def moved_with_its_line(self, diagnostic: Diagnostic) -> Diagnostic | None:
        """Return a warning at the number that its line has by now; None where that line is gone."""
        lines = _lines_of(diagnostic.file)
        own, here = diagnostic.excerpt.rstrip(), diagnostic.line - 1
        if not lines or not own or (here < len(lines) and lines[here].rstrip() == own):
            return diagnostic
        same = [number for number, text in enumerate(lines, 1) if text.rstrip() == own]
        if not same:
            return None
        return replace(diagnostic, line=min(same, key=lambda number: abs(number - diagnostic.line)))


def _lines_of(name: str) -> list[str]:
    """Return the lines of a file as an error names it; none of a part of one, or where it cannot be read."""
    path = path_named(name) if name and without_part(name) == name else None
    if path is not None and (unsaved := unsaved_texts().get(path)) is not None:
        return unsaved.split("\n")
    try:
        return _lines_at(path, content_hash(path)) if path is not None else []
    except (OSError, PlaygroundError):
        return []


@FILES.cached()
def _lines_at(path: Path, _: str) -> list[str]:
    text = read_regular(path).decode("utf-8-sig", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


class Warnings:
    """The warnings of the sketch that is shown: the driver's, its texts', and of the files that it reads.

    The library's own files are left out. A kernel is looked at once, one at a call: the driver
    takes some milliseconds for each.
    """

    def __init__(self, review: Callable[[Kernel], tuple[Diagnostic, ...]]) -> None:
        self._review = review  # compiles it for the driver's warnings
        self._of: Graph | None = None
        self._by_kernel: dict[str, tuple[Diagnostic, ...]] = {}  # by the kernel's text
        self._kernels: dict[str, Kernel] = {}
        self.waiting: list[str] = []  # not looked at yet
        self._plan: Plan | None = None
        self._of_sources: tuple[Diagnostic, ...] = ()

    def of(
        self, sketch: Sketch | None, plan: Plan | None = None, inputs: LiveInputs | None = None
    ) -> list[Diagnostic]:
        """Return what is known of a sketch's warnings so far; ``plan`` is that of its last picture.

        ``inputs`` are the live ones; None: there are none.
        """
        if sketch is None:
            return []
        if self._of is not sketch.graph:
            self._of = sketch.graph
            own = [k for _, k in kernels_of(sketch.graph) if not Path(k.path).is_relative_to(GLSL)]
            self._kernels = {f"{k.path}\n{k.source.code}": k for k in own}
            self._by_kernel = {
                text: self._by_kernel[text] for text in self._kernels if text in self._by_kernel
            }
            self.waiting = [text for text in self._kernels if text not in self._by_kernel]
        if self._plan is not plan:
            self._plan, self._of_sources = plan, source_warnings(plan, inputs) if plan is not None else ()
        of_kernels = (d for text in self._kernels for d in self._by_kernel.get(text, ()))
        return [*warnings_of_sketch(sketch), *of_kernels, *self._of_sources]

    def look(self) -> None:
        """Look at one kernel that has not been looked at yet."""
        if self.waiting:
            text = self.waiting.pop()
            own = warnings_of_kernel(self._kernels[text])
            places = {(d.file, d.line) for d in own}  # where a driver would say the same again
            more = [d for d in self._review(self._kernels[text]) if (d.file, d.line) not in places]
            self._by_kernel[text] = (*own, *more)


def unreadable(sketch: Sketch | None) -> tuple[Diagnostic, ...]:
    """Return what is wrong with the headers of a sketch's own kernels, as their files are now.

    Loading a sketch stops at the first.
    """
    diagnostics: dict[Diagnostic, None] = {}
    paths = {k.path for _, k in kernels_of(sketch.graph)} if sketch is not None else set()
    for path in sorted(Path(name) for name in paths):
        if path.is_relative_to(GLSL) or not path.is_file():
            continue
        try:
            Techniques().shader(path, root_of(path))
        except PlaygroundError as error:
            diagnostics |= dict.fromkeys(error.diagnostics)
    return tuple(diagnostics)


def passes_of(sketch: Sketch | None, diagnostic: Diagnostic) -> list[str]:
    """Return the passes, as the panel has them, that are made of the file that a mistake is in."""
    path = path_named(diagnostic.file) if diagnostic.file else None
    if sketch is None or path is None:
        return []
    names = [name.partition(".")[0] for name, kernel in kernels_of(sketch.graph) if str(path) in kernel.files]
    return list(dict.fromkeys(names))


to_log = logging.getLogger("playground.studio").error
"""Without a command line: Python's log ends on standard error."""


class TerminalErrors:
    """What the terminal has reported of the errors that the window shows; ``tell`` prints there."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._reported: frozenset[Diagnostic] = frozenset()

    def take(self, errors: Iterable[Diagnostic]) -> None:
        """Print the errors that were not there the last time; one that was fixed may come again.

        Where the terminal is gone, nothing is printed; the window shows them all the same.
        """
        now = dict.fromkeys(errors)
        with contextlib.suppress(OSError, ValueError):
            for diagnostic in now:
                if diagnostic not in self._reported:
                    self._tell(str(diagnostic))
        self._reported = frozenset(now)
