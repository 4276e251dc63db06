"""Read GLSL files and flatten their includes, so that each flat line knows its file and line.

The driver is given ``SourceText.code``: comments, ``#include`` and the project's pragmas are blanked
(quotes and anything beyond ASCII are outside GLSL 3.30), and lines stay. ``#line`` is never used, because
drivers treat it differently; one in a file is left out.

A backslash at a line's end joins it to the next, comments included, as GLSL 4.20 has it; the driver gets the
joined line in the first one's place, since 3.30 knows no such thing. A macro's call that spans lines is
joined as well (``with_calls_joined``): Mesa's preprocessor (22.3) forgets the line ends inside such a call,
so that every later error names a line too early. The lines that a joined call took stay, empty.
"""

from __future__ import annotations

import logging
import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from playground.allowed_files import (
    exists,
    how_to_open,
    is_file,
    is_inside,
    names_below,
    note,
    real,
    texts_of_load,
    unsaved_texts,
)
from playground.errors import Diagnostic, PlaygroundError, ShaderError, SketchError, nearest
from playground.files import NotRegularError, irregularity, read_regular
from playground.memo import TEXTS, PickledByFields
from playground.paths import GLSL, shown
from playground.shader.libraries import how_to_name, libraries, library_around
from playground.shader.syntax.tokens import directive, is_named

_DEFINE = re.compile(r"\s*#\s*define\s+(\w+)(\(|\s+(\w+)\s*$)?")
_NAME = re.compile(r"\b([A-Za-z_]\w*)\s*(\(?)")
_BRACKET = re.compile(r"[()]")
_MAX_CALL_LINES = 1_000  # that one call may span: an unclosed one must not swallow the file


def with_calls_joined(codes: Sequence[str]) -> list[str]:
    """Return lines of code, comments blanked, with each macro call on one line; as many lines."""
    lines = list(codes)
    if not any("define" in code for code in lines):
        return lines
    macros: set[str] = set()
    index = 0
    while index < len(lines):
        code = lines[index]
        if "define" in code and (define := _DEFINE.match(code)):
            name, bracket, meaning = define.groups()
            if bracket == "(" or meaning in macros:
                macros.add(name)
        elif macros and not code.lstrip().startswith("#"):
            index = _join(lines, index, macros)
        index += 1
    return lines


def _join(codes: list[str], index: int, macros: set[str]) -> int:
    """Append to a line those that a macro call begun on it goes on to; leave it where the call never ends.

    Return the last line that is done: of a call that never ends, the last that was looked at.
    """
    joined, last = codes[index], index
    taken, end = joined, index  # as far as calls are whole
    while (is_open := _is_open(joined, macros)) != "no":
        last += 1
        if last >= len(codes) or last - index > _MAX_CALL_LINES or codes[last].lstrip().startswith("#"):
            break
        code = codes[last].strip()
        if is_open == "maybe" and code and not code.startswith("("):
            break
        joined = f"{joined} {code}" if code else joined
        if _is_open(joined, macros) == "no":
            taken, end = joined, last
    codes[index : end + 1] = [taken, *[""] * (end - index)]
    return last - 1 if is_open == "yes" else end


def _is_open(code: str, macros: Collection[str]) -> str:
    """Return whether a macro's call is open at a line's end: "no", "yes", "maybe" (the name ends it)."""
    position = 0
    while match := _NAME.search(code, position):
        position = match.end(1)
        if match[1] not in macros:
            continue
        if not match[2]:
            if match.end() == len(code):
                return "maybe"
            continue
        depth = 0
        for bracket in _BRACKET.finditer(code, match.start(2)):
            depth += 1 if bracket[0] == "(" else -1
            if depth == 0:
                position = bracket.start()
                break
        if depth:
            return "yes"
    return "no"


_log = logging.getLogger(__name__)

_INCLUDE = re.compile(r'\s*#\s*(?:pragma\s+)?include\b\s*(?:"([^"]*)"|<([^>]*)>)?[\s;]*(.*)', re.DOTALL)
_OWN_PRAGMAS = frozenset({"kernel", "source", "draw", "compute"})
_LIBRARY = re.compile(r"([A-Za-z_][\w.-]*)/(.+)")
_MARK = re.compile(r'"(?:[^"\\]|\\.)*(?:"|\Z)|//|/\*')
_NOT_TAB = re.compile(r"[^\t]")
_WHITE = str.maketrans({"\v": " ", "\f": " "})
_BEYOND_ASCII = re.compile(r"[^\t -~]")
_MAX_DEPTH = 32
_MAX_LINES = 200_000
_MAX_INCLUDES = 4_096
_MAX_BYTES = 8 * 2**20
_SHORT = 2**16  # characters; what is in the lines of a longer text is not kept


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a flattened text."""

    text: str  # as written
    code: str  # what the driver sees; "" where a line before it took it in
    comment: str  # what follows //, without it; "" where there is none
    file: str  # absolute path
    number: int  # from 1, in that file
    chain: tuple[str, ...] = ()  # "file:line" of the includes that led here
    pragma: str = ""  # one of the project's own pragmas, whole; "" elsewhere
    left_out: bool = False  # a #line, which the driver is not given

    def diagnostic(self, message: str, column: int = 0, severity: str = "error") -> Diagnostic:
        """Return a diagnostic that points at this line."""
        return Diagnostic(message, shown(self.file), self.number, column, severity, self.text, self.chain)

    def error(self, message: str, column: int = 0) -> ShaderError:
        """Return an error that points at this line."""
        return ShaderError(diagnostics=[self.diagnostic(message, column)])


@dataclass(frozen=True)
class SourceText(PickledByFields):
    """A GLSL file with its includes in place."""

    path: str  # absolute path of the outermost file
    lines: tuple[Line, ...]
    files: tuple[str, ...] = ()  # absolute paths of every file read, outermost first
    includes: tuple[tuple[str, str, str], ...] = ()  # file, what it writes, the file that this names

    def __hash__(self) -> int:
        # A string caches its hash; a thousand lines would be hashed each time.
        return hash(self.code)

    def with_codes(self, codes: Sequence[str]) -> SourceText:
        """Return the text with other code in its lines, one for each; itself where all is the same."""
        lines = tuple(
            line if line.code == code else replace(line, code=code)
            for line, code in zip(self.lines, codes, strict=True)
        )
        return self if lines == self.lines else replace(self, lines=lines)

    def line_naming(self, *names: str, called: bool = False) -> Line | None:
        """Return the first line that has one of some names, ``called`` before a bracket; None for none."""
        return next((line for line in self.lines if is_named(line.code, names, called=called)), None)

    @cached_property
    def code(self) -> str:
        """The text for the driver, one line for each of ``lines``."""
        return "\n".join([line.code for line in self.lines]) + "\n"

    @cached_property
    def canonical(self) -> str:
        """The text without comments, blank lines or indentation: what staleness is judged by."""
        return "\n".join([" ".join(line.code.split()) for line in self.lines if line.code.strip()])

    @cached_property
    def names(self) -> frozenset[str]:
        """Every identifier that the code names."""
        return frozenset(self.counts)

    @cached_property
    def counts(self) -> Counter[str]:
        """How often the code names each identifier."""
        return Counter(re.findall(r"[A-Za-z_]\w*", self.code))


@dataclass(frozen=True, slots=True)
class Origin:
    """The files and texts of a flattened text, which is up to date as long as they are the same."""

    texts: tuple[tuple[str, str], ...]  # of each file read, by absolute path
    places: tuple[tuple[Path, Path | None], ...]  # where includes were looked for, and the file found there
    libraries: tuple[tuple[str, Path | None], ...] = ()  # that were looked for by name, and their folders

    def holds(self) -> bool:
        """Return whether every file still has the same text, and every place still leads to the same file.

        Texts are compared, not times: two saves may fall into one tick of a file system's clock.
        """
        try:
            named = libraries() if self.libraries else {}
            return (
                all(named.get(name) == folder for name, folder in self.libraries)
                and all(_file_at(path) == resolved for path, resolved in self.places)
                and all(read_text(Path(path), any_encoding=True) == text for path, text in self.texts)
            )
        except PlaygroundError:
            return False


def read_source(path: Path, roots: Sequence[Path], instead: Mapping[str, str] | None = None) -> SourceText:
    """Read a GLSL file and everything it includes.

    An include is looked for in the folder of the file that includes it, then in each of
    ``roots`` (the sketch's own folder, then ``glsl/``), and must lie in one of them; then, by the
    name that it begins with, in a library that the user named, whose files include from there alone. A
    file of ``glsl/`` includes from there alone, so that no sketch changes what it means.
    ``instead`` has texts, by absolute path, that are taken in place of the files'.

    Raises ``ShaderError`` naming file and line for a missing, outlying or cyclic
    include, and ``SketchError`` when the file itself cannot be read.
    """
    return read_source_and_origin(path, roots, instead)[0]


def read_source_and_origin(
    path: Path, roots: Sequence[Path], instead: Mapping[str, str] | None = None, *, foreign: bool = False
) -> tuple[SourceText, Origin]:
    """Read a GLSL file as ``read_source`` does; return its files and texts as well.

    Of a ``foreign`` file, a shader of another tool, an include is also looked for in each folder from the
    includer's up to those of ``roots``, and each file is included once.
    """
    path = path.resolve()
    own = tuple(dict.fromkeys(root.resolve() for root in roots))
    reader = _Reader(own, GLSL.resolve(), instead or {}, foreign)
    reader.flatten(path, reader.read(path), (), (str(path),))
    includes = tuple((file, name, target) for (file, name), target in reader.named.items())
    source = SourceText(str(path), tuple(reader.lines), tuple(reader.texts), includes)
    source = source.with_codes(with_calls_joined([line.code for line in reader.lines]))
    asked = tuple((name, reader.libraries.get(name)) for name in sorted(reader.asked))
    return source, Origin(tuple(reader.texts.items()), tuple(reader.looked_at.items()), asked)


def find_include(name: str, includer: Path, roots: Sequence[Path]) -> Path | None:
    """Return the file that ``#include`` names in a file, found as ``read_source`` does; None for none."""
    reader = _Reader(tuple(dict.fromkeys(root.resolve() for root in roots)), GLSL.resolve(), {}, False)
    try:
        return reader.find(name, includer.resolve(), Line("", "", "", str(includer), 0))
    except PlaygroundError:
        return None


class EncodingError(SketchError):
    """A file is not UTF-8."""


def read_text(path: Path, *, any_encoding: bool = False) -> str:
    """Read a UTF-8 file with any line ends; raise ``SketchError`` if it cannot be read.

    With ``any_encoding``, a text that is no UTF-8 is taken as Latin-1, where each byte is a character.
    """
    note(path)
    if (unsaved := unsaved_texts().get(path)) is not None:
        return normalised(unsaved)
    texts = texts_of_load()
    if texts is None:
        return _text(path, any_encoding)
    if (path, any_encoding) not in texts:
        texts[path, any_encoding] = _text(path, any_encoding)
    return texts[path, any_encoding]


def _text(path: Path, any_encoding: bool) -> str:
    data = b""
    try:
        data = read_regular(path, _MAX_BYTES + 1)
        if len(data) > _MAX_BYTES:
            raise SketchError(f"larger than {_MAX_BYTES // 2**20} MiB; a text was expected", file=path)
        if _log.isEnabledFor(logging.DEBUG):  # naming a file takes longer than reading it
            _log.debug("read %s", shown(path))
        return normalised(data.decode())
    except FileNotFoundError:
        raise SketchError("there is no such file", file=path) from None
    except NotRegularError as error:
        raise SketchError(error.strerror, file=path) from None
    except UnicodeDecodeError as error:
        if any_encoding and b"\0" not in data:
            return normalised(data.decode("latin-1"))
        before = normalised(data[: error.start].decode()).split("\n")
        message = f"not UTF-8 text (byte {error.start}); save the file as UTF-8"
        raise EncodingError(message, file=path, line=len(before), column=len(before[-1]) + 1) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SketchError(f"cannot be read: {reason}", file=path) from None


def normalised(text: str) -> str:
    """Return a text whose lines end in LF, without a byte order mark."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


class _Reader:
    """Flattens one file."""

    def __init__(
        self, own: tuple[Path, ...], library: Path, instead: Mapping[str, str], foreign: bool
    ) -> None:
        self.own = own
        self.foreign = foreign  # of another tool: includes are found, and counted, otherwise
        self.library = library
        self.instead = instead  # texts that are taken in place of the files', by absolute path
        self.lines: list[Line] = []
        self.texts: dict[str, str] = {}  # of each file read, outermost first
        self.looked_at: dict[Path, Path | None] = {}  # where includes may be, and what file is there
        self.includes = 0
        self.named: dict[tuple[str, str], str] = {}  # file and what it writes → the file that it includes
        self.asked: set[str] = set()  # libraries that were looked for by name
        self._shown: dict[Path, str] = {}

    @cached_property
    def libraries(self) -> dict[str, Path]:
        return libraries()

    def flatten(self, path: Path, text: str, chain: tuple[str, ...], stack: tuple[str, ...]) -> None:
        self.texts[str(path)] = text
        raw = text.split("\n")
        file = str(path)
        number = 1
        for split in _remembered_split(text) if len(text) <= _SHORT else _split(text):
            line = Line(
                raw[number - 1],
                split.code,
                split.comment,
                file,
                number,
                chain,
                split.pragma,
                split.left_out,
            )
            self.lines.append(line)
            after = number + split.lines
            if split.lines > 1:
                self.lines += [Line(raw[i - 1], "", "", file, i, chain) for i in range(number + 1, after)]
            if len(self.lines) > _MAX_LINES:
                raise line.error(
                    f"more than {_MAX_LINES} lines with its includes; is something included over and over?"
                )
            if split.include:
                self.include(split.include, line, path, chain, stack)
            number = after

    def shown(self, path: Path) -> str:
        """Return a path as people read it, worked out once."""
        if path not in self._shown:
            self._shown[path] = shown(path)
        return self._shown[path]

    def include(
        self, match: re.Match[str], line: Line, path: Path, chain: tuple[str, ...], stack: tuple[str, ...]
    ) -> None:
        name = match.group(1) or match.group(2)
        if not name or match.group(3):
            raise line.error('#include needs one file name in quotes, as #include "noise/hash.glsl"')
        self.includes += 1
        if self.includes > _MAX_INCLUDES:
            raise line.error(f"more than {_MAX_INCLUDES} includes; is something included over and over?")
        target = self.find(name, path, line)
        key = self.named[str(path), name] = str(target)
        if self.foreign and key in self.texts:
            return
        if key in stack:
            cycle = [*stack[stack.index(key) :], key]
            raise line.error("include cycle: " + " → ".join(shown(p) for p in cycle))
        if len(stack) >= _MAX_DEPTH:
            raise line.error(f"includes nested more than {_MAX_DEPTH} deep")
        if key not in self.texts:
            try:
                self.texts[key] = self.read(target)
            except SketchError as error:
                diagnostic = error.diagnostics[0]
                if diagnostic.line:
                    via = (*chain, f"{shown(path)}:{line.number}")
                    raise ShaderError(diagnostics=[replace(diagnostic, chain=via)]) from None
                raise line.error(f"'{name}': {diagnostic.message}") from None
        location = f"{self.shown(path)}:{line.number}"
        self.flatten(target, self.texts[key], (*chain, location), (*stack, key))

    def read(self, path: Path) -> str:
        if str(path) in self.instead:
            return self.instead[str(path)]
        return read_text(path, any_encoding=self.foreign)

    def find(self, name: str, includer: Path, line: Line) -> Path:
        allowed, climbs = self.allowed(includer)
        parents = [p for p in includer.parents if any(map(p.is_relative_to, allowed))] if climbs else ()
        places = [folder / name for folder in (includer.parent, *parents, *allowed)]
        for path in places:
            candidate = self.looked_at[path] = _file_at(path)
            if candidate is not None:
                if not is_inside(candidate, allowed) and not library_around(candidate, self.libraries):
                    more = how_to_open(candidate, allowed[0]) if allowed != (self.library,) else ""
                    raise line.error(f"'{name}' lies outside the sketch's own folder and glsl/{more}")
                return candidate
        named = _LIBRARY.fullmatch(name) if allowed != (self.library,) else None
        if named:
            self.asked.add(named[1])
            if named[1] in self.libraries:
                return self.in_library(named[1], named[2], line)
        if what := next(filter(None, map(irregularity, places)), ""):
            raise line.error(f"'{name}': {what}")
        own = self.own[0]
        above = [parent / name for parent in own.parents] if climbs and includer.is_relative_to(own) else ()
        if (candidate := next(filter(None, map(_file_at, above)), None)) is not None:
            more = how_to_open(candidate, own)
            raise line.error(f"'{name}' lies outside the sketch's own folder and glsl/{more}")
        near = nearest(name, names_below(allowed, (".glsl",)))
        elsewhere = near.endswith(f"/{named[2].rpartition('/')[2]}'?") if named else True
        if named and not elsewhere and not exists(self.library / named[1]):
            near = f"; if {named[1]} is a library on this computer, name its folder once"
            near += f": {how_to_name(named[1])}"
        raise line.error(f"no file '{name}' to include{near}")

    def allowed(self, includer: Path) -> tuple[tuple[Path, ...], bool]:
        """Return the folders that a file may include from, and whether those around it are searched."""
        if any(includer.is_relative_to(root) for root in self.own):
            return tuple(dict.fromkeys([*self.own, self.library])), self.foreign
        if includer.is_relative_to(self.library):
            return (self.library,), self.foreign
        around = library_around(includer, self.libraries)
        if around:
            return (self.libraries[around].resolve(),), True
        return tuple(dict.fromkeys([*self.own, self.library])), self.foreign

    def in_library(self, library: str, name: str, line: Line) -> Path:
        """Return a file of a named library."""
        folder = self.libraries[library]
        path = folder / name
        file = self.looked_at[path] = _file_at(path)
        if file is None:
            near = nearest(name, names_below((folder,), (".glsl",))) if folder.is_dir() else ""
            gone = "" if folder.is_dir() else ", which is gone"
            raise line.error(f"no file '{name}' in the library {library} ({shown(folder)}){gone}{near}")
        if not is_inside(file, (folder,)):
            raise line.error(f"'{name}' lies outside the library {library} ({shown(folder)})")
        return file


def _file_at(path: Path) -> Path | None:
    """Return the file that a path leads to, its links followed; None if there is none."""
    note(path)
    resolved = real(path)
    return resolved if resolved is not None and is_file(resolved) else None


class _Split(NamedTuple):
    """What is in a line, with those that its backslashes join to it."""

    code: str
    comment: str
    include: re.Match[str] | None
    pragma: str
    left_out: bool
    lines: int  # how many lines of the text


def _split(text: str) -> tuple[_Split, ...]:
    """Return what is in each line of a text: once, for many files include the same few."""
    parts = []
    lines, index, in_block = text.split("\n"), 0, False
    while index < len(lines):
        joined, count = _joined(lines, index)
        code, comment, in_block = _split_comments(joined, in_block)
        include, pragma, left_out = None, "", False
        if "#" in code:
            include = _INCLUDE.match(code)
            pragma = code.strip() if is_own_pragma(code) else ""
            left_out = directive(code)[0] == "line"
        if include or pragma or left_out:
            code = ""
        elif not (code.isascii() and code.isprintable()):
            code = _BEYOND_ASCII.sub("?", code.translate(_WHITE))
        parts.append(_Split(code, comment, include, pragma, left_out, count))
        index += count
    return tuple(parts)


def is_own_pragma(line: str) -> bool:
    """Return whether a line of code is a pragma of our own kernels."""
    word, rest = directive(line)
    return word == "pragma" and directive(f"#{rest}")[0] in _OWN_PRAGMAS


def _joined(lines: list[str], index: int) -> tuple[str, int]:
    """Return a line with those that its backslashes join to it, and how many lines that are."""
    last = index
    while lines[last].endswith("\\") and last + 1 < len(lines):
        last += 1
    if last == index:
        return lines[index], 1
    return "".join(line[:-1] for line in lines[index:last]) + lines[last], last - index + 1


_remembered_split = TEXTS.cached()(_split)


def _split_comments(raw: str, in_block: bool) -> tuple[str, str, bool]:
    """Return (code with comments blanked, text after // or "", whether a block comment goes on)."""
    if not in_block and "/" not in raw and '"' not in raw:
        return raw.rstrip(), "", False
    code = ""
    position = 0
    while True:
        if in_block:
            end = raw.find("*/", position)
            end = len(raw) if end < 0 else end + 2
            in_block = not raw.endswith("*/", position, end)
            code += _NOT_TAB.sub(" ", raw[position:end])
            position = end
            if in_block:
                return code.rstrip(), "", True
        match = _MARK.search(raw, position)
        while match and match.group()[0] == '"':
            match = _MARK.search(raw, match.end())
        if not match:
            return (code + raw[position:]).rstrip(), "", False
        code += raw[position : match.start()]
        if match.group() == "//":
            return code.rstrip(), raw[match.end() :], False
        code += "  "
        position, in_block = match.end(), True
