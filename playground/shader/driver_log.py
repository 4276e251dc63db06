r"""Read the log of an OpenGL driver for a shader: entries with lines, hints, and likely names.

Every driver words and numbers its log differently; here all of them become the same
`LogEntry`. Pure text: no context, no files. Turning a line of the flattened text into
(file, line) is left to ``complaints``.

What the drivers count:

* The number before the line is the source string (`0:12`, `0(12)`, `3:27`). A shader here
  is one string, so it is ignored: it could only be a leftover of `#line`.
* Lines are 1-based everywhere; 0 means "no place": Mesa prints `0:0(0)`, NVIDIA `(0)`.
  Only Mesa prints a column, and it counts in the *preprocessed* line, where a run of blanks
  or a comment is one space and macros are expanded: `source_column` undoes the blanks.
* Mesa 22.3.6 gives every part of a line continued by `\` the number of its first part, and
  code behind the `*/` of a long comment the line where the comment began (so comments are
  blanked before compiling). The lines after are right again.
* A syntax error is placed where the compiler gave up: after a missing `;` that is the line
  of the *next* word. Intel on Windows is reported to be off at times (DaemonEngine/Daemon#1241).
* `#line n` names the next line n from GLSL 3.30 on, and n + 1 before it; Mesa moreover
  applies its string number to some errors and not to others (seen in 22.3.6), and tools
  that emit it report errors off by one (3Dickulus/FragM#71, #157); a file name after it is
  a syntax error on Mesa (FragM#52). So this project never emits `#line`.
* ANGLE on Direct3D quotes lines of translated HLSL, and NVIDIA's "assembly compile error"
  lines of assembly: both are given as 0, for they are not lines of the shader.
* Mesa 22.3.6 runs link errors together without a line break; they are split here.

moderngl compiles stage by stage and raises at the first that fails, so a log concerns one
stage only; a driver that gives no log leaves an empty one, for which there are no entries.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Literal

from playground.paths import GLSL, SKETCHES, shown
from playground.shader.dialect import dialects
from playground.shader.kernel import ForeignShader, Kernel, PlainFragment, PlainShader
from playground.shader.own_shaders import own_part
from playground.shader.reserved_names import GIVEN, GIVEN_INSTEAD, GLSL_WORDS, PLAIN_UNIFORMS
from playground.shader.source import Line, SourceText

Severity = Literal["error", "warning"]


@dataclass(frozen=True, slots=True)
class LogEntry:
    """One complaint of a driver."""

    line: int  # 1-based, in the text handed to the driver; 0: unknown
    column: int  # 1-based, as the driver counts: see `source_column`; 0: unknown
    severity: Severity
    message: str  # cleaned; further lines (candidates, notes) are indented by four spaces


# ---- moderngl's wrapping ------------------------------------------------------------------

_WRAPPED = re.compile(
    r"\s*GLSL (?P<step>Compiler|Linker) failed[ \t]*(?:\n\s*|\Z)"
    r"(?:(?P<title>\w+)[ \t]*\n=+[ \t]*(?:\n|\Z))?(?P<log>.*)",
    re.DOTALL,
)


def split_moderngl(text: str) -> tuple[str, str]:
    """Take the driver's log out of the text of a `moderngl.Error`.

    The stage is "vertex", "fragment", "geometry", "compute", "tess_control" or
    "tess_evaluation" for a compiler log, "link" for a linker log, and "" for a text that
    moderngl did not wrap (which is then returned whole).
    """
    wrapped = _WRAPPED.match(text.replace("\r\n", "\n"))
    if wrapped is None:
        return "", text.strip()
    if wrapped["step"] == "Linker":
        return "link", wrapped["log"].strip()
    return (wrapped["title"] or "").removesuffix("_shader"), wrapped["log"].strip()


# ---- the data --------------------------------------------------------------------------------


def _pattern(text: str | list[str]) -> re.Pattern[str]:
    """Return a pattern of the data, its parts and flags in place."""
    text = text if isinstance(text, str) else "".join(text)
    for name, part in _PARTS.items():
        text = text.replace(f"%{name}%", part)
    inside = re.match(r"\(\?([im]+)\)", text)
    flags = [re.MULTILINE if flag == "m" else re.IGNORECASE for flag in inside[1]] if inside else []
    return re.compile(text[inside.end() :] if inside else text, sum(flags))


_DATA: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_PARTS = {name: "".join(part) for name, part in _DATA["parts"].items()}
FORMATS = tuple(map(_pattern, _DATA["formats"].values()))
PATTERNS = {name: _pattern(text) for name, text in _DATA["patterns"].items()}
HINTS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (_pattern(["(?i)", *hint["pattern"]]), hint["message"]) for hint in _DATA["hints"]
)
"""Patterns and what they mean, the first found counts: {0} is its group, {1} that in lower case."""
BASES: dict[str, str] = _DATA["bases"]
MISFITS: dict[str, str] = _DATA["misfits"]
GUESSES: dict[str, str] = _DATA["guesses"]
WHEREABOUTS: dict[str, str] = _DATA["whereabouts"]
ELSEWHERE: dict[str, str] = _DATA["elsewhere"]

_ASSEMBLY = "-- internal assembly text --"  # NVIDIA: a dump of thousands of lines follows


# ---- entries -----------------------------------------------------------------------------------


@dataclass(slots=True)
class _Draft:
    """An entry that may still grow."""

    line: int
    column: int
    severity: Severity
    head: str
    code: str = ""
    recognised: bool = True  # a format recognised it
    more: list[str] = field(default_factory=list)

    def entry(self) -> LogEntry:
        # NVIDIA's C0000 is "syntax error" itself; its other codes are what people search for.
        code = f" ({self.code})" if self.code not in ("", "C0000") else ""
        message = "\n    ".join([self.head + code, *self.more])
        return LogEntry(self.line, self.column, self.severity, message)


def parse_log(log: str) -> tuple[LogEntry, ...]:
    """Read the log of a compiler or linker, of whichever driver.

    Entries keep the driver's order; exact repetitions go, as do frames and summaries unless
    they are all there is. Consequential errors stay. Lines in no known format become one
    entry of line 0, and so does a log that is not understood at all. Never raises.
    """
    text = log.replace("\0", "").replace("\r\n", "\n").replace("\r", "\n")
    text = PATTERNS["unbroken"].sub("\n", text.split(_ASSEMBLY)[0])
    drafts: list[_Draft] = []
    for raw in text.split("\n"):
        line = raw.strip()
        if line and not PATTERNS["benign"].fullmatch(line) and not PATTERNS["frame"].fullmatch(line):
            _take(drafts, line, indented=raw[0].isspace())
    entries = [draft for draft in drafts if not PATTERNS["summary"].fullmatch(draft.head)] or drafts
    return tuple(dict.fromkeys(draft.entry() for draft in entries))


def _take(drafts: list[_Draft], line: str, indented: bool) -> None:
    """Add one line of a log: to the last draft where it continues that, else as a new one."""
    last = drafts[-1] if drafts else None
    draft = _recognise(line)
    if draft is None:
        head = _clean(line)
        if last is None or (last.recognised and not indented) or PATTERNS["summary"].fullmatch(head):
            drafts.append(_Draft(0, 0, "error", head, recognised=False))
        elif PATTERNS["summary"].fullmatch(last.head):
            drafts.append(_Draft(0, 0, "error", head, recognised=False))
        else:
            last.more.append(head)
    elif last is not None and _continues(last, draft, line):
        if draft.head.startswith("..."):
            last.head += " " + draft.head
        else:
            last.more.append(draft.head)
    else:
        drafts.append(draft)


def _recognise(line: str) -> _Draft | None:
    for pattern in FORMATS:
        match = pattern.fullmatch(line)
        if match is None:
            continue
        parts = match.groupdict()
        kind = (parts.get("kind") or "error").lower()
        return _Draft(
            line=max(0, int(parts.get("line") or 0)),
            column=int(parts.get("column") or 0),
            severity="error" if "error" in kind else "warning",
            head=_clean(parts["message"] or "") or kind,
            code=parts.get("code") or "",
        )
    return None


def _continues(last: _Draft, draft: _Draft, line: str) -> bool:
    """Return whether a recognised line only goes on with the one before it."""
    if (last.line, last.column, last.severity) != (draft.line, draft.column, draft.severity):
        return False
    # Mesa lists candidate functions, and NVIDIA a second remedy, as if they were errors.
    return (last.head.endswith("candidates are:") and ":    " in line) or draft.head.startswith("... ")


def _clean(message: str) -> str:
    text = " ".join(message.split())
    text = re.sub(r"^(?:'' ?: ?|Error: )", "", text)
    return re.sub(r"\b(syntax error):? (?:\1|parse error)$", r"\1", text)


# ---- columns -----------------------------------------------------------------------------------


def source_column(line: str, column: int) -> int:
    """Convert a driver's column to the column of the source line it means; 0 where there is none.

    Exact unless a macro or a comment that was not blanked is before it on the line.
    """
    counted, blank = 0, False
    for index, character in enumerate(line, start=1):
        counted += not (blank and character in " \t")
        blank = character in " \t"
        if counted == column and not blank:
            return index
    return 0


# ---- hints -----------------------------------------------------------------------------------

_MAX_CANDIDATES = 3


def folded(message: str) -> str:
    """Return a message that lists what might have been called with the few that are most like the call."""
    head, *rest = message.split("\n")
    if not head.endswith("candidates are:") or len(rest) <= _MAX_CANDIDATES:
        return message
    call = PATTERNS["called"].search(head)
    near = difflib.get_close_matches(call[1] if call else head, rest, _MAX_CANDIDATES, 0.0)
    return "\n".join([head, *near, f"    and {len(rest) - len(near)} more"])


def hint(message: str) -> str:
    """Return what a message usually means, or "" where nothing useful is known."""
    head = message.split("\n", 1)[0][:600]
    for pattern, sentence in HINTS:
        match = pattern.search(head)
        if match:
            name = next((group for group in match.groups() if group), "")
            return sentence.format(name, name.lower())
    # Mesa's type "error" marks what follows from a mistake already reported.
    if PATTERNS["misfit"].search(head) and not re.search(r"\berror\b", head):
        return _misfit(head)
    return ""


def _misfit(head: str) -> str:
    """Explain types that do not fit together."""
    call = PATTERNS["call"].search(head)
    if call is not None:
        name, type_name = call[1] or call[3], call[2] or ""
        if any(base in ("int", "uint") for base, _ in _types(type_name)):
            return MISFITS["whole call"].format(name, type_name)
        return MISFITS["call"].format(name)
    types = _types(head)
    bases = {base for base, _ in types}
    if "bool" in bases and len(bases) > 1:
        return MISFITS["bool"]
    if "float" in bases and len(bases) > 1:
        return MISFITS["float"]
    if bases == {"int", "uint"}:
        return MISFITS["sign"]
    return MISFITS["size" if len({size for _, size in types}) > 1 or "mismatch" in head else "types"]


def _types(text: str) -> list[tuple[str, str]]:
    """Find the types named in a text, as (kind of number, size)."""
    types: list[tuple[str, str]] = []
    for match in PATTERNS["type"].finditer(text):
        word = match["word"]
        if "mat" in word:
            size = word[word.index("mat") :]
        elif "vec" in word:
            size = word[-1]
        else:
            size = match["size"] or "1"
        types.append((BASES["u" if word.startswith("uns") else word[0]], size))
    return types


TYPES = (*"float int uint bool void vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4".split(),
          *"bvec2 bvec3 bvec4 mat2 mat3 mat4 sampler2D const uniform return struct".split())  # fmt: skip
NEAR = 0.75  # of difflib's ratio


def without_consequences(entries: Iterable[LogEntry]) -> Iterator[LogEntry]:
    """Yield the entries of a log: of an unknown name the first, and nothing that follows from it.

    What follows is an expression around the name, or around a call that fits no function.
    """
    seen: set[str] = set()
    cause = (0, 0)  # line and column
    for entry in entries:
        head, position = _head(entry.message), (entry.line, entry.column)
        follows = 0 < entry.line and position <= cause and PATTERNS["follows"].search(head) is not None
        name = "" if follows else _unknown(head)
        if name or (PATTERNS["unfit"].search(head) and not follows):
            cause = position
        if entry.severity != "error" or not (follows or name in seen):
            yield entry
        if name:
            seen.add(name)


def names_given(kernel: Kernel) -> frozenset[str]:
    """Return the names that a kernel, or the tool of another shader, is given without declaring them."""
    if isinstance(kernel, ForeignShader):
        helpers = "\n".join(own_part(part) for part in kernel.helpers)
        matches = [*PATTERNS["function"].finditer(helpers), *PATTERNS["define"].finditer(helpers)]
        return frozenset({*(name for name, _ in kernel.tool_names), *(match[1] for match in matches)})
    return frozenset(GIVEN) if _is_own(kernel) else frozenset()


def whereabouts(message: str, source: SourceText, line: Line | None, kernel: Kernel) -> str:
    """Return in one message where an unknown name is declared, or who is given it; "" where nobody is."""
    name = _unknown(message)
    if not name or line is None:
        return ""
    here = next((number for number, entry in enumerate(source.lines) if entry is line), 0)
    places = _places(source)
    for kind, number in sorted(places.get(name, ())):
        location = f"{shown(source.lines[number].file)}:{source.lines[number].number}"
        if kind == "called" or (kind == "global" and number <= here):
            return ""  # ``guess`` knows functions
        return (GUESSES["below"] if kind == "global" else WHEREABOUTS["block"]).format(name, location)
    return _given_elsewhere(name, kernel)


def _places(source: SourceText) -> dict[str, set[tuple[str, int]]]:
    """Return the names that a text declares, each with the kinds and the lines, from 0, of where."""
    from playground.shader.declarations import kind_of
    from playground.shader.syntax.symbols import readings

    places: dict[str, set[tuple[str, int]]] = defaultdict(set)
    for symbols in readings(source.code):
        for symbol in symbols.symbols:
            if symbol.kind != "member":
                places[symbol.name].add((kind_of(symbol), symbols.tree.line(symbol.token)))
    return places


def _given_elsewhere(name: str, kernel: Kernel) -> str:
    """Say so where other shaders are given a name, and what is called otherwise here."""
    kinds = dialects().given()
    if isinstance(kernel, ForeignShader):
        names = kernel.tool_names
    else:
        names = tuple(_MEANINGS.items()) if _is_own(kernel) else ()
    is_plain = isinstance(kernel, PlainFragment) and not isinstance(kernel, ForeignShader)
    if is_plain and name in _PLAIN & kinds.keys():
        return WHEREABOUTS["undeclared"].format(name, kinds[name][0])
    if name in dict(names) or (_is_own(kernel) and name in GIVEN_INSTEAD):
        return ""
    meaning = _MEANINGS.get(name) or _ALIKE.get(kinds.get(name, ("", ""))[1], "")
    if not meaning and name not in GIVEN:
        return ""
    same = next((own for own, means in names if meaning and _ALIKE.get(means) == meaning), "")
    if same:
        return WHEREABOUTS["same"].format(name, same)
    return WHEREABOUTS["kernels"].format(name) if name in GIVEN and not _is_own(kernel) else ""


def _is_own(kernel: Kernel) -> bool:
    """Return whether a kernel is one of ours, not a library file alone."""
    return bool(kernel.outputs) and not isinstance(kernel, PlainShader)


def _head(message: str) -> str:
    return message.split("\n", 1)[0][:600]


def _unknown(message: str) -> str:
    """Return the name that a message calls unknown; "" for any other."""
    match = PATTERNS["unknown"].search(_head(message))
    return next(group for group in match.groups() if group) if match else ""


_MEANINGS = {"time": "time", "size": "resolution"}  # of names that a kernel is given
_ALIKE = {
    **{meaning: meaning for meaning in PLAIN_UNIFORMS},
    **dict.fromkeys(("hover", "hover_share", "drag"), "mouse"),
    "frame_of_time": "frame",
    "date_from_1": "date",
}
"""Meanings of what tools give → those of ``PLAIN_UNIFORMS`` that are the same."""
_PLAIN = frozenset(name for names in PLAIN_UNIFORMS.values() for name in names)


def guess(
    message: str, source: SourceText, line: Line | None, names: Collection[str] = frozenset(GIVEN)
) -> str:
    """Return in one message what an unknown name was meant to be; "" where that is not sure.

    ``message`` is a driver's, of any maker; ``line`` is where it points, None where it points nowhere.
    ``names`` are names that need no declaration.
    """
    name = _unknown(message)
    if not name:
        return _unread(source, line) if line is not None and PATTERNS["unread"].search(_head(message)) else ""
    called = bool(re.search(rf"\b{name}\s*\(", line.code if line is not None else source.code))
    functions, variables = _declared(source)
    if name in functions or name in variables:
        return _below(name, functions, source, line) if called else ""
    if name in GLSL_WORDS:
        return ""  # known, but not with these arguments, or not to this version
    if name in ELSEWHERE:
        return GUESSES["elsewhere"].format(name, ELSEWHERE[name])
    if name == "saturate" and called:
        return GUESSES["saturate"]
    own = any(text.pragma for text in source.lines)
    if own and name in GIVEN_INSTEAD:
        return GUESSES["instead"].format(name, GIVEN_INSTEAD[name])
    files = library().get(name, ())
    if files:
        which = " or ".join(f'`#include "{file}"`' for file in files[:3])
        return GUESSES["library"].format(name, which)
    candidates = {*functions, *names, *(GLSL_WORDS if called else variables)}
    near = _nearest(name, candidates - {name})
    return GUESSES["near"].format(name, near) if near else ""


def _unread(source: SourceText, line: Line) -> str:
    """Report what a line that GLSL cannot read has of other languages, or which word of it is misspelt."""
    if cast := PATTERNS["cast"].search(line.code):
        return GUESSES["cast"].format(cast[1])
    functions, variables = _declared(source)
    for word in re.findall(r"[A-Za-z_]\w*", line.code):
        if word in functions or word in variables or word in GLSL_WORDS or word in GIVEN:
            continue
        if word in ELSEWHERE:
            return GUESSES["elsewhere"].format(word, ELSEWHERE[word])
        # A word that the text has elsewhere as well is a name of its own.
        if source.code.count(word) == 1 and (near := _nearest(word, set(TYPES))):
            return GUESSES["type"].format(word, near)
    return ""


@cache
def library() -> dict[str, tuple[str, ...]]:
    """Return the files to include, from ``glsl/``, that define each function of the library."""
    files: dict[str, list[str]] = {}
    for path in sorted(GLSL.rglob("*.glsl")):
        if path.is_relative_to(SKETCHES):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            continue
        if PATTERNS["runs"].search(text):
            continue
        for name in {match[1] for match in PATTERNS["definition"].finditer(text)}:
            files.setdefault(name, []).append(path.relative_to(GLSL).as_posix())
    return {name: tuple(files) for name, files in files.items()}


def _declared(source: SourceText) -> tuple[dict[str, Line], set[str]]:
    """Return the functions that a text defines, with where, and its variables and macros."""
    functions: dict[str, Line] = {}
    variables: set[str] = set()
    for line in source.lines:
        if not line.code.strip():
            continue
        for match in PATTERNS["function"].finditer(line.code):
            functions.setdefault(match[1], line)
        variables |= {match[1] for match in PATTERNS["variable"].finditer(line.code)}
        if macro := PATTERNS["define"].match(line.code):
            if macro[2]:
                functions.setdefault(macro[1], line)
            else:
                variables.add(macro[1])
    return functions, variables


def _below(name: str, functions: dict[str, Line], source: SourceText, line: Line | None) -> str:
    """Say so where a function is defined further down than where it is called."""
    there = functions.get(name)
    if there is None or line is None:
        return ""
    order = {id(text): index for index, text in enumerate(source.lines)}
    if order.get(id(there), 0) <= order.get(id(line), 0):
        return ""
    where = f"{shown(there.file)}:{there.number}"
    return GUESSES["below"].format(name, where)


def _nearest(name: str, names: set[str]) -> str:
    """Return the one known name that is like this one; "" where there is none, or two are as near."""
    folded = [other for other in names if other.lower() == name.lower()]
    if len(folded) == 1 and folded[0] != name:
        return folded[0]
    if len(name) < 3:
        return ""
    near = difflib.get_close_matches(name, sorted(names), n=2, cutoff=NEAR)
    if len(near) == 2:
        first, second = (difflib.SequenceMatcher(None, name, other).ratio() for other in near)
        if first == second:
            return ""
    return near[0] if near else ""
