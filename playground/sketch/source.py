"""Read GLSL files and flatten their includes, so that each flat line knows its file and line.

The driver is given ``SourceText.code``: comments, ``#include`` and the project's
pragmas are blanked (quotes and anything beyond ASCII are outside GLSL 3.30), lines
are kept, and ``#line`` is never used, because drivers differ in what they make of it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from playground.errors import Diagnostic, ShaderError, SketchError, nearest
from playground.paths import GLSL, shown

_INCLUDE = re.compile(r'^\s*#\s*include\b\s*(?:"([^"]*)"|<([^>]*)>)?')
_OWN_PRAGMA = re.compile(r"^\s*#\s*pragma\s+(kernel|source|draw|compute)\b")
_MAX_DEPTH = 32
_MAX_LINES = 200_000


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a flattened text."""

    text: str  # as written
    code: str  # what the driver sees
    comment: str  # what follows //, without it; "" where there is none
    file: str  # absolute path
    number: int  # from 1, in that file
    chain: tuple[str, ...] = ()  # "file:line" of the includes that led here

    def diagnostic(self, message: str, column: int = 0, severity: str = "error") -> Diagnostic:
        """Return a diagnostic that points at this line."""
        return Diagnostic(message, shown(self.file), self.number, column, severity, self.text, self.chain)

    def error(self, message: str, column: int = 0) -> ShaderError:
        """Return an error that points at this line."""
        return ShaderError(diagnostics=[self.diagnostic(message, column)])


@dataclass(frozen=True)
class SourceText:
    """A GLSL file with its includes in place."""

    path: str  # absolute path of the outermost file
    lines: tuple[Line, ...]
    files: tuple[str, ...] = ()  # absolute paths of every file read, outermost first
    _cache: dict[str, str] = field(default_factory=dict, compare=False, repr=False, hash=False)

    @cached_property
    def code(self) -> str:
        """The text for the driver, one line for each of ``lines``."""
        return "\n".join(line.code for line in self.lines) + "\n"

    @cached_property
    def canonical(self) -> str:
        """The text without comments, blank lines or indentation: what staleness is judged by."""
        return "\n".join(" ".join(line.code.split()) for line in self.lines if line.code.strip())

    @cached_property
    def names(self) -> frozenset[str]:
        """Every identifier that the code names."""
        return frozenset(re.findall(r"[A-Za-z_]\w*", self.code))


def read_source(path: Path, roots: Sequence[Path]) -> SourceText:
    """Read a GLSL file and everything it includes.

    An include is looked for beside the file that includes it, then in each of
    ``roots`` (the sketch's own folder, then ``glsl/``), and must lie in one of them.

    Raises ``ShaderError`` naming file and line for a missing, outlying or cyclic
    include, and ``SketchError`` when the file itself cannot be read.
    """
    path = path.resolve()
    allowed = tuple(dict.fromkeys([*(root.resolve() for root in roots), GLSL.resolve()]))
    lines: list[Line] = []
    files: dict[str, None] = {}
    _flatten(path, read_text(path), allowed, (), (str(path),), lines, files)
    return SourceText(str(path), tuple(lines), tuple(files))


def read_text(path: Path) -> str:
    """Read a UTF-8 file with any line ends; raise ``SketchError`` in a sentence if it cannot be read."""
    try:
        return path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except FileNotFoundError:
        raise SketchError("there is no such file", file=shown(path)) from None
    except IsADirectoryError:
        raise SketchError("this is a folder; a file was expected", file=shown(path)) from None
    except UnicodeDecodeError as error:
        raise SketchError(f"not UTF-8 text (byte {error.start})", file=shown(path)) from None
    except OSError as error:
        raise SketchError(f"cannot be read: {error.strerror}", file=shown(path)) from None


def _flatten(
    path: Path,
    text: str,
    allowed: tuple[Path, ...],
    chain: tuple[str, ...],
    stack: tuple[str, ...],
    lines: list[Line],
    files: dict[str, None],
) -> None:
    files[str(path)] = None
    in_block = False
    for number, raw in enumerate(text.split("\n"), 1):
        code, comment, in_block = _split_comments(raw, in_block)
        include = _INCLUDE.match(code)
        if include or _OWN_PRAGMA.match(code):
            code = ""
        code = "".join(c if " " <= c <= "~" or c == "\t" else "?" for c in code)
        line = Line(raw, code, comment, str(path), number, chain)
        lines.append(line)
        if len(lines) > _MAX_LINES:
            raise line.error(f"more than {_MAX_LINES} lines with its includes; is something included over and over?")
        if include:
            name = include.group(1) or include.group(2)
            if not name:
                raise line.error('#include needs a file name in quotes, as #include "noise/hash.glsl"')
            target = _find_include(name, path, allowed, line)
            if str(target) in stack:
                cycle = [*stack[stack.index(str(target)) :], str(target)]
                raise line.error("include cycle: " + " → ".join(shown(p) for p in cycle))
            if len(stack) >= _MAX_DEPTH:
                raise line.error(f"includes nested more than {_MAX_DEPTH} deep")
            place = f"{shown(path)}:{number}"
            try:
                inner = read_text(target)
            except SketchError as error:
                raise line.error(error.diagnostics[0].message) from None
            _flatten(target, inner, allowed, (*chain, place), (*stack, str(target)), lines, files)


def _find_include(name: str, includer: Path, allowed: tuple[Path, ...], line: Line) -> Path:
    for folder in (includer.parent, *allowed):
        candidate = (folder / name).resolve()
        if candidate.is_file():
            if not any(candidate.is_relative_to(root) for root in allowed):
                raise line.error(f"'{name}' lies outside the sketch's own folder and glsl/")
            return candidate
    known = [
        str(p.relative_to(root).as_posix())
        for root in allowed
        for p in root.rglob("*.glsl")
        if p.is_file()
    ]
    raise line.error(f"no file '{name}' to include{nearest(name, known)}")


def _split_comments(raw: str, in_block: bool) -> tuple[str, str, bool]:
    """Return (code with comments blanked, text after // or "", whether a block comment goes on)."""
    out: list[str] = []
    i, n = 0, len(raw)
    quoted = False
    while i < n:
        two = raw[i : i + 2]
        if in_block:
            if two == "*/":
                in_block = False
                out.append("  ")
                i += 2
            else:
                out.append("\t" if raw[i] == "\t" else " ")
                i += 1
        elif not quoted and two == "//":
            return "".join(out).rstrip(), raw[i + 2 :], False
        elif not quoted and two == "/*":
            in_block = True
            out.append("  ")
            i += 2
        else:
            if raw[i] == '"':
                quoted = not quoted
            out.append(raw[i])
            i += 1
    return "".join(out).rstrip(), "", in_block
