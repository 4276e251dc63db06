r"""Read the log of an OpenGL driver for a shader: entries with lines, and hints in plain words.

Every driver words and numbers its log differently; here all of them become the same
`LogEntry`. Pure text: no context, no files. Turning a line of the flattened text into
(file, line) is left to ``program``.

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

import difflib
import re
from dataclasses import dataclass, field
from typing import Literal

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


# ---- the formats ---------------------------------------------------------------------------

_NUMBER = r"[0-9]{1,9}"
_KIND = r"(?P<kind>(?:preprocessor |fatal |internal )?(?:error|warning)|note|info)"
FORMATS = tuple(
    re.compile(pattern)
    for pattern in (
        # Mesa, Intel on Linux        0:12(8): preprocessor error: message
        rf"{_NUMBER}:(?P<line>{_NUMBER})\((?P<column>{_NUMBER})\): {_KIND}: ?(?P<message>.*)",
        # NVIDIA                      0(12) : error C1503: message
        rf"[^\s():]*\((?P<line>{_NUMBER})\) ?: {_KIND}(?: (?P<code>[A-Z][0-9]+))?: ?(?P<message>.*)",
        # ANGLE on Direct3D           C:\fakepath(249,9-30): error X3004: message
        rf"[^\s()]*\({_NUMBER},[-0-9]{{1,19}}\): {_KIND}(?: X[0-9]+)?: ?(?P<message>.*)",
        # Intel, AMD, Apple, ANGLE    ERROR: 0:12: message, AMD's with error(#143) before it
        rf"(?P<kind>ERROR|WARNING|NOTE|INFO): [^\s:]*:(?P<line>-?{_NUMBER}):(?:(?P<column>{_NUMBER}):)?"
        r"\s*(?:(?:error|warning)\(#[0-9]+\)\s*)?(?P<message>.*)",
        # glslc                       file.vert:12: error: message
        rf"[^\s:()]+:(?P<line>{_NUMBER}):(?:(?P<column>{_NUMBER}):)? ?{_KIND}: ?(?P<message>.*)",
        # Mali                        0:12: L0003: message
        rf"{_NUMBER}:(?P<line>{_NUMBER}): (?P<code>[A-Z][0-9]{{4}}): ?(?P<message>.*)",
        # no place: linkers           error: message, ERROR: error(#280) message
        r"(?P<kind>(?:fatal |internal )?(?:error|warning)|ERROR|WARNING|Error|Warning|Internal error):"
        r"\s*(?:(?:error|warning)\(#[0-9]+\)\s*)?(?P<message>.*)",
    )
)

# Lines that say that nothing is wrong.
BENIGN = re.compile(r"No errors\.?|.{0,80} was successfully compiled to run on hardware\.?|Success\.?", re.I)

# Lines that only frame others.
FRAME = re.compile(r"[-=^~]{2,}|\^|[\w ()]{1,40} info|-- error message --", re.I)

# Summaries: worth showing only when there is nothing else.
SUMMARY = re.compile(
    r"compilation terminated\.?"
    r"|[0-9]+ compilation errors?\. *No code generated\.?"
    r"|(?:[0-9]+ (?:errors?|warnings?)(?: and )?){1,2} generated\.?"
    r"|.{0,40}shader failed to compile with the following errors:?"
    r"|(?:[\w ]{0,40}shader\(s\) (?:failed to link|(?:was |were )?linked)[,.]? ?){1,6}"
    r"|[\w ]{0,40}link error: INVALID_OPERATION\.?"
    r"|.{0,40}shader\(s\) were not successfully compiled before glLinkProgram\(\) was called\..*"
    r"|One or more attached shaders not successfully compiled\.?"
    r"|linking with uncompiled/unspecialized shader"
    r"|LINK_ERROR",
    re.I,
)

ASSEMBLY = "-- internal assembly text --"  # NVIDIA: a dump of thousands of lines follows
UNBROKEN = re.compile(r"(?<=\))(?=(?:error|warning): )")  # Mesa: two link errors on one line


@dataclass(slots=True)
class _Draft:
    """An entry that may still grow."""

    line: int
    column: int
    severity: Severity
    head: str
    code: str = ""
    known: bool = True  # a format recognised it
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
    text = UNBROKEN.sub("\n", text.split(ASSEMBLY)[0])
    drafts: list[_Draft] = []
    for raw in text.split("\n"):
        line = raw.strip()
        if line and not BENIGN.fullmatch(line) and not FRAME.fullmatch(line):
            _take(drafts, line, indented=raw[0].isspace())
    entries = [draft for draft in drafts if not SUMMARY.fullmatch(draft.head)] or drafts
    return tuple(dict.fromkeys(draft.entry() for draft in entries))


def _take(drafts: list[_Draft], line: str, indented: bool) -> None:
    """Add one line of a log: to the last draft where it continues that, else as a new one."""
    last = drafts[-1] if drafts else None
    draft = _recognise(line)
    if draft is None:
        head = _clean(line)
        if last is None or (last.known and not indented) or SUMMARY.fullmatch(head):
            drafts.append(_Draft(0, 0, "error", head, known=False))
        elif SUMMARY.fullmatch(last.head):
            drafts.append(_Draft(0, 0, "error", head, known=False))
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
        found = pattern.fullmatch(line)
        if found is None:
            continue
        parts = found.groupdict()
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
    for place, character in enumerate(line, start=1):
        counted += not (blank and character in " \t")
        blank = character in " \t"
        if counted == column and not blank:
            return place
    return 0


# ---- hints -----------------------------------------------------------------------------------

_Q = "[`'\"]"

# Keywords that people use as names. Mesa names some only by an upper-case token.
_TOKENS = "SAMPLE|SMOOTH|FLAT|PATCH|BUFFER|SHARED|CENTROID|INVARIANT|PRECISE|RESOURCE|SUBROUTINE"
_WORDS = (
    "active|buffer|cast|class|common|external|filter|fixed|flat|half|input|output|partition|patch"
    "|sample|shared|smooth|this|union"
)

_OLD_LOOKUP = r"(?:texture|shadow)(?:[123]D|Cube)\w*"
_UNKNOWN = r"(?:undeclared|undefined|no function|no matching|not known|removed|deprecated)"

# (pattern, sentence): the first pattern found gives the sentence; {0} is its group, {1} that in lower case.
# More telling mistakes come first: `texture2D` is also an undeclared identifier.
HINTS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern, re.IGNORECASE), sentence)
    for pattern, sentence in (
        (
            rf"^(?=.*{_UNKNOWN}).*?\b({_OLD_LOOKUP})\b",
            "`{0}` is not in core GLSL: call `texture`, or `textureLod` and `texelFetch` in a kernel.",
        ),
        (
            rf"^(?=.*{_UNKNOWN}).*?\b(gl_Frag(?:Color|Data))\b",
            "`{0}` is not in core GLSL: declare an `out vec4` of your own and write to that.",
        ),
        (rf"{_Q}(attribute|varying){_Q}", "`{0}` is not in core GLSL: write `in` or `out`."),
        (
            r"#version must|#version (?:is )?required|only valid for function parameters in GLSL"
            r"|requires \"?#version",
            "The text needs a newer `#version` on its very first line, such as `#version 330`.",
        ),
        (
            r"(?:GLSL|version|version number) '?([0-9.]+)'? (?:is )?not supported"
            r"|unsupported version ([0-9]+)",
            "This driver has no GLSL `{0}`: ask for a lower `#version`.",
        ),
        (
            rf"extension:? {_Q}?(\w+){_Q}? ?:? ?.*(?:unsupported|not supported)"
            rf"|{_Q}(\w+){_Q} ?:.*extension.*not supported",
            "This driver lacks the extension `{0}`: do without it, or guard it with `#ifdef {0}`.",
        ),
        (r"#extension (\w+)", "This needs an extension: add `#extension {0} : enable` below `#version`."),
        (
            r"not supported for this version|unrecognized layout identifier|Unknown identifier .* in layout"
            r"|(?:only )?(?:available|allowed|supported) (?:only )?in (?:GLSL|version)|GLSL .* required",
            "The `#version` at the top is too old for this: raise it, or add the right `#extension`.",
        ),
        (
            rf"(?:reserved word:? {_Q}?|keyword {_Q})(\w+)|{_Q}(\w+){_Q} ?:.*reserved word",
            "`{0}` is a reserved word of GLSL: choose another name.",
        ),
        (
            rf"(?-i:unexpected ({_TOKENS})\b|(?:at token|Syntax error:) \"({_WORDS})\""
            rf"|{_Q}({_WORDS}){_Q} ?: syntax error)",
            "`{1}` is a reserved word of GLSL: choose another name.",
        ),
        (r"(?-i:unexpected ERROR_TOK)", ""),  # Mesa gives the reason in the entry before
        (
            rf"{_Q}(gl_\w*){_Q}.*(?:reserved|prefix|redeclared)",
            "Names that begin with `gl_` belong to GLSL: choose another name.",
        ),
        (
            r"unexpected (?:end of file|\$end|\$undefined|EOF)|at token \"<EOF>\"|premature end",
            "The text ends too soon: a `{{`, a `(` or a `;` is missing its partner somewhere above.",
        ),
        (
            r"unexpected '\}', expecting end of file|unexpected '\}' at token|extraneous",
            "There is one closing brace too many here or above.",
        ),
        (
            r"(?-i:syntax error.*expecting[^a-z]*(?:','|';'|COMMA|SEMICOLON))",
            "A `;` is missing, usually at the end of the line above, or a type name is misspelt.",
        ),
        (
            r"unexpected NEW_IDENTIFIER|undeclared type|typename expected",
            "A word that GLSL does not know is where a type should be: check its spelling.",
        ),
        (
            r"\b(?:syntax|parse) error|Syntax error",
            "GLSL cannot read this: look for a missing `;`, comma or bracket here and on the line above.",
        ),
        (
            r"of operator % must be an integer|operands to \"%\" must be integral|'%' ?:.*\bfloat\b",
            "`%` is for whole numbers: write `mod(a, b)` for floats.",
        ),
        (
            r"(?:if-statement|loop) condition must be scalar boolean|boolean expression expected",
            "A condition is a bool: compare a number, as in `x > 0.0`.",
        ),
        (r"recursion|recursive function", "GLSL has no recursion: write a loop."),
        (r"C-style initialization", "Braces do not fill an array here: write `float[](1.0, 2.0)`."),
        (
            r"swizzle|field selection|cannot access field|unknown field|no such field",
            "These components do not exist here: a `vec3` has x y z (or r g b), a scalar has none, "
            "and the two sets do not mix.",
        ),
        (
            r"read-only|l-?value required|can(?:'t|not) modify|non-lvalue|assignment to const",
            "This cannot be written to: `uniform`, `const` and `in` are read-only, so copy it into a local "
            "variable first.",
        ),
        (
            r"no return statement|does not return a value|missing return|not all .*paths? return"
            r"|`?return'? with no value",
            "A function that promises a value must end in `return` with one on every path.",
        ),
        (
            r"redeclar|redefin|already (?:defined|declared|has a body)|conflicts with previous declaration",
            "This name is taken already in the same scope or by an included file: rename one of the two, "
            "or drop the repetition.",
        ),
        (
            r"too few components to construct|too little data in type constructor|not enough data"
            r"|too few arguments.*construct",
            "The constructor gets too few components: a `vec4` takes four numbers in all, or a single one.",
        ),
        (
            r"too many parameters to .*constructor|too much data in type constructor"
            r"|too many arguments.*construct|constructor.*too many arguments",
            "The constructor gets too many components: count those of its arguments together.",
        ),
        (
            rf"no function with name {_Q}(\w+)|invalid call of (?:undeclared identifier )?{_Q}(\w+)"
            rf"|{_Q}(\w+){_Q} ?: function is not known",
            "No function `{0}` is known here: check its spelling, the `#include` that brings it and the "
            "`#version`, and that no variable has the same name.",
        ),
        (
            rf"{_Q}(\w+){_Q} ?:? ?undeclared"
            rf"|(?:undefined variable|undeclared (?:identifier|variable)):? {_Q}?(\w+)",
            "`{0}` is not declared at this point: check its spelling, and that its declaration or `#include` "
            "is above.",
        ),
    )
)

CALLED = re.compile(r"call to [`'\"]([^`'\"]+)['\"]")
MAX_CANDIDATES = 3

MISFIT = re.compile(
    r"no matching|could not implicitly convert|cannot be assigned to variable|cannot convert|wrong operand"
    r"|does not operate on|incompatible type|implicit (?:cast|narrowing)|invalid operands|overloaded function"
    r"|with wrong type|size mismatch|dimension mismatch|non-matching types|must be (?:an )?integer"
    r"|wrong type",
    re.I,
)
CALL = re.compile(
    rf"(?:call to|overloaded function(?: found:| reference)?) {_Q}?(?!found\b|reference\b)(\w+)"
    r"(?:\(([^()]*)\))?"
    rf"|{_Q}(\w+){_Q} ?: no matching"
)
TYPE = re.compile(
    r"(?:(?P<size>[234])-component vector of )?(?:(?:low|medium|high)p )?"
    r"\b(?P<word>float|double|unsigned int|uint|int|bool|[biud]?vec[234]|[d]?mat[234](?:x[234])?)\b"
)
BASES = {"f": "float", "d": "float", "v": "float", "m": "float", "i": "int", "u": "uint", "b": "bool"}

# What is wrong with types that do not fit → the sentence; {0} is a function, {1} what it was given.
MISFITS = {
    "whole call": "No form of `{0}` takes ({1}): most built-in functions want floats, so write 2.0 for 2, or "
    "float(...).",
    "call": "No form of `{0}` takes these arguments: check its spelling, their number, order and types.",
    "bool": "A bool is not a number: compare to get one, or convert with float(...) or int(...).",
    "float": "Whole and decimal numbers do not mix: write 2.0 for 2, or convert with float(...) or int(...).",
    "sign": "Signed and unsigned do not mix: write 2u for 2, or convert with uint(...) or int(...).",
    "size": "The two sides differ in size: pick components with a swizzle such as .xyz, or build the vector.",
    "types": "The types on the two sides do not fit: convert one of them, as in float(...) or vec3(...).",
}


def folded(message: str) -> str:
    """Return a message that lists what might have been called with the few that are most like the call."""
    head, *rest = message.split("\n")
    if not head.endswith("candidates are:") or len(rest) <= MAX_CANDIDATES:
        return message
    call = CALLED.search(head)
    near = difflib.get_close_matches(call[1] if call else head, rest, MAX_CANDIDATES, 0.0)
    return "\n".join([head, *near, f"    and {len(rest) - len(near)} more"])


def hint(message: str) -> str:
    """Return in one sentence what a message usually means, or "" where nothing useful is known."""
    head = message.split("\n", 1)[0][:600]
    for pattern, sentence in HINTS:
        found = pattern.search(head)
        if found:
            name = next((group for group in found.groups() if group), "")
            return sentence.format(name, name.lower())
    # Mesa's type "error" marks what follows from a mistake already reported.
    if MISFIT.search(head) and not re.search(r"\berror\b", head):
        return _misfit(head)
    return ""


def _misfit(head: str) -> str:
    """Explain types that do not fit together."""
    call = CALL.search(head)
    if call is not None:
        name, given = call[1] or call[3], call[2] or ""
        if any(base in ("int", "uint") for base, _ in _types(given)):
            return MISFITS["whole call"].format(name, given)
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
    found: list[tuple[str, str]] = []
    for match in TYPE.finditer(text):
        word = match["word"]
        if "mat" in word:
            size = word[word.index("mat") :]
        elif "vec" in word:
            size = word[-1]
        else:
            size = match["size"] or "1"
        found.append((BASES["u" if word.startswith("uns") else word[0]], size))
    return found
