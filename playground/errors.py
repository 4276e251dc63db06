"""Give every mistake one family of errors, each with the place it was made.

    PlaygroundError                a mistake that a message can explain
    ├── SketchError                a sketch or a technique's TOML is wrong
    │   └── ParameterError         a value or a parameter's name is wrong
    ├── ShaderError                a GLSL text is wrong; one diagnostic a mistake
    ├── DataError                  an image or elevation file cannot be used
    ├── ContextError               no OpenGL context, or one that lacks what is needed
    │   └── OpenGLFault            OpenGL reports an error of the engine's own doing
    └── SandboxError               a worker process was stopped
        ├── SandboxTimeout         … it took too long
        └── SandboxCrash           … it died

``PlaygroundWarning`` is for what can be drawn all the same.

A message is one message: what was found, what was expected, the nearest valid
choice. The command line prints it and leaves with status 2; it never shows a
traceback for one of these.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from itertools import takewhile
from pathlib import Path

from playground.paths import shown

MAX_LINE = 600  # characters of a line of a message, in which a name or a driver's text may be quoted whole
MAX_LINES = 200  # of a message
_MAX_PATH = 4096  # characters; no file has a longer one
_MAX_EXCERPT = 300  # characters that are shown of a line of a file


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake, and where it is. A message is shortened where it is too long to read."""

    message: str
    file: str = ""  # as the user would name it; empty when there is none
    line: int = 0  # from 1; 0 when unknown
    column: int = 0  # from 1; 0 when unknown
    severity: str = "error"  # "error" or "warning"; "hint" of what an editor shows as unnecessary
    excerpt: str = ""  # the offending line, as written
    chain: tuple[str, ...] = ()  # "file:line" of each #include that led here, outermost first

    def __post_init__(self) -> None:
        object.__setattr__(self, "message", shortened(self.message))
        object.__setattr__(self, "file", _cut(self.file, _MAX_PATH))

    @property
    def location(self) -> str:
        """Return "file:line:column", as much of it as is known."""
        parts = takewhile(bool, (self.file, self.line, self.column))
        return ":".join(map(str, parts))

    def __str__(self) -> str:
        head = f"{self.location}: {self.message}" if self.location else self.message
        lines = [head]
        if self.excerpt.strip():
            excerpt, column = _around(self.excerpt.rstrip(), self.column)
            lines.append(f"    {excerpt}")
            if column:
                indent = "".join("\t" if c == "\t" else " " for c in excerpt[: column - 1])
                lines.append(f"    {indent}^")
        lines += [f"    included from {position}" for position in reversed(self.chain)]
        return "\n".join(lines)


class PlaygroundError(Exception):
    """A mistake that a message can explain.

    ``diagnostics`` holds each mistake with its place; ``str(error)`` is all of
    them, one below the other. A ``Path`` given as the file is named as its user would name it.

        try:
            playground.load("no_such_sketch")
        except playground.PlaygroundError as error:
            print(error, error.diagnostics[0].file)
    """

    exit_status = 2

    def __init__(
        self,
        message: str = "",
        *,
        file: str | Path = "",
        line: int = 0,
        column: int = 0,
        excerpt: str = "",
        diagnostics: Iterable[Diagnostic] = (),
    ) -> None:
        entries = tuple(diagnostics)
        if not entries:
            named = shown(file) if isinstance(file, Path) else file
            entries = (Diagnostic(message, named, line, column, excerpt=excerpt),)
        self.diagnostics: tuple[Diagnostic, ...] = entries
        super().__init__("\n".join(map(str, entries)))

    def __reduce__(self) -> tuple[object, ...]:
        """Cross a process border whole (a worker process sends its errors back)."""
        return partial(type(self), diagnostics=self.diagnostics), ()


class SketchError(PlaygroundError):
    """A sketch or a technique's TOML is wrong.

    For example:

        try:
            playground.load("diamond_sqare")
        except playground.SketchError as error:
            print(error)  # names the nearest: diamond_square
    """


class ParameterError(SketchError):
    """A parameter's name or its value is wrong.

    For example:

        try:
            playground.load("l_dot_n").with_values({"product.son": (120.0, 20.0)})
        except playground.ParameterError as error:
            print(error)
    """


class ShaderError(PlaygroundError):
    r"""A GLSL text is wrong: each of its ``diagnostics`` has a file and a line.

    For example:

        from pathlib import Path

        Path("broken.frag").write_text("#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0) }")
        try:
            playground.render("broken.frag", size=(64, 36))
        except playground.ShaderError as error:
            print(error.diagnostics[0].line)
    """


class DataError(PlaygroundError):
    """An image or elevation file cannot be used, or a file cannot be written.

    For example:

        try:
            playground.render("l_dot_n", size=(64, 36)).save("land.bmp")
        except playground.DataError as error:
            print(error)  # lists what can be written
    """


class ContextError(PlaygroundError):
    """There is no OpenGL context, it lacks what is needed, or it is another thread's.

    For example:

        try:
            playground.headless(driver="cuda")
        except playground.ContextError as error:
            print(error)
    """


class OpenGLFault(ContextError):
    """A pass left an OpenGL error behind: what it drew is not to be trusted."""


class SandboxError(PlaygroundError):
    """A worker process was stopped before it could answer.

    For example:

        try:
            raise playground.SandboxError("a worker process was stopped")
        except playground.PlaygroundError as error:
            print(error)
    """


class SandboxTimeout(SandboxError):
    """A worker process took too long and was killed.

    For example:

        try:
            raise playground.SandboxTimeout("a draw took more than 10 s")
        except playground.SandboxError as error:
            print(error)
    """


class SandboxCrash(SandboxError):
    """A worker process died: the driver or its compiler crashed, or memory ran out.

    For example:

        try:
            raise playground.SandboxCrash("the driver crashed")
        except playground.SandboxError as error:
            print(error)
    """


class PlaygroundWarning(UserWarning):
    """What can be drawn, but maybe not as its author intends; programs receive it as a Python warning.

    For example:

        import warnings

        with warnings.catch_warnings():
            warnings.simplefilter("error", playground.PlaygroundWarning)
            playground.render("l_dot_n", size=(64, 36))
    """


class PlainFormWarning(PlaygroundWarning):
    """A fast variant does not run: its technique's text is not the one that it was verified against.

    For example:

        import warnings

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", playground.PlainFormWarning)
            playground.render("l_dot_n", size=(64, 36))
    """


def shortened(text: str) -> str:
    """Return a message with the middle of its long lines, and of many lines, left out."""
    if len(text) <= MAX_LINE and text.count("\n") < MAX_LINES:
        return text
    lines = [_cut(line, MAX_LINE) for line in text.split("\n")]
    if len(lines) > MAX_LINES:
        half = MAX_LINES // 2
        lines[half:-half] = [f"… {counted(len(lines) - 2 * half, 'line')} left out …"]
    return "\n".join(lines)


def _cut(line: str, most: int) -> str:
    if len(line) <= most:
        return line
    half = most // 2 - 20  # for what says how much is left out
    return f"{line[:half]} … {len(line) - 2 * half} characters left out … {line[-half:]}"


def _around(line: str, column: int) -> tuple[str, int]:
    """Return the part of a long line around a column, from 1, and the column in it; 0 stays 0."""
    if len(line) <= _MAX_EXCERPT:
        return line, column
    start = max(min(column - _MAX_EXCERPT // 2, len(line) - _MAX_EXCERPT), 0)
    before, after = "… " if start else "", " …" if start + _MAX_EXCERPT < len(line) else ""
    part = f"{before}{line[start : start + _MAX_EXCERPT]}{after}"
    return part, column - start + len(before) if column else 0


def counted(number: int, noun: str) -> str:
    """Return "1 file", "2 files"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def nearest(name: str, valid: Iterable[str], cutoff: float = 0.55) -> str:
    """Suggest the valid name that was probably meant, as the end of a message.

    ``cutoff`` is the least likeness of two names, 0 to 1: short ones need more to be near.

    Returns ``""`` when nothing is near and there is nothing to list, else
    ``"; did you mean 'x'?"`` or ``"; there are: a, b, c"``.
    """
    names = sorted(set(valid))
    close = difflib.get_close_matches(name, names, n=1, cutoff=cutoff)
    if close:
        return f"; did you mean '{close[0]}'?"
    if not names:
        return ""
    shown = ", ".join(names[:12]) + (", …" if len(names) > 12 else "")
    return f"; there are: {shown}"
