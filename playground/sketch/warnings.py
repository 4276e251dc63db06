"""Warn of what has no effect in a sketch's texts, another effect than its author can see, or a trap.

* A default in a kernel's file that a sketch's file or the panel overrides: who edits it sees nothing change.
* In a kernel: loose ends of its header, divisions of whole numbers with a remainder, variables that are read
  before they are written, declarations that nothing reads, inputs of passes that nothing wires.

A warning of a text is a function that returns diagnostics, called by ``warnings_of_kernel`` or
``warnings_of_sketch``.
"""

from __future__ import annotations

import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import Diagnostic, PlaygroundError
from playground.paths import GLSL, shown
from playground.regular_file import read_regular
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, names_in
from playground.shader.header import unfed_samplers
from playground.shader.parameter import write
from playground.shader.reserved_names import GLSL_WORDS
from playground.shader.source import SourceText
from playground.sketch.assign import apply, effective_values, resolve
from playground.sketch.model import (
    CpuSource,
    Draw,
    ForeignShader,
    Graph,
    Kernel,
    Parameter,
    PlainFragment,
    PlainShader,
    Sketch,
    Value,
    kernels_of,
)

if TYPE_CHECKING:
    from playground.shader.declarations import Declarations, Variable
    from playground.shader.preprocessor import Token


PANEL = "the panel"
"""The name in messages of what sets a value that no file sets."""


@dataclass(frozen=True, slots=True)
class Shadowed:
    """A parameter whose default has no effect."""

    path: str  # of the parameter, in the sketch
    parameter: Parameter
    value: Value  # what it is instead
    by: str  # "sketch.toml:15", or the panel

    def __str__(self) -> str:
        return f"{self.path}: the {self._words}"

    @property
    def _words(self) -> str:
        default, value = write(self.parameter, self.parameter.default), write(self.parameter, self.value)
        return f"default is {default}; {self.by} sets {value}"

    @property
    def warning(self) -> Diagnostic:
        """The same as a warning, at the line of the default."""
        message = f"the {self._words} in pass '{self.path.rpartition('.')[0]}'"
        return Diagnostic(message, shown(self.parameter.file), self.parameter.line, severity="warning")


def shadowed_by_files(sketch: Sketch) -> list[Shadowed]:
    """Return the defaults in the sketch's own kernels that its own files set over.

    Techniques that ship are there to be set, and users know what they set.
    """
    by, values = _setters(sketch.graph, ""), effective_values(sketch.graph)
    by_user = {target.path for path, _ in sketch.overrides for target in resolve(sketch.graph, path)}
    shadows = []
    for path, parameter in sketch.graph.leaf_parameters.items():
        own = not Path(parameter.file).is_relative_to(GLSL)
        if own and path in by and path not in by_user and values[path] != parameter.default:
            shadows.append(Shadowed(path, parameter, values[path], by[path]))
    return shadows


def newly_shadowed(before: Sketch, now: Sketch) -> list[Shadowed]:
    """Return the parameters whose default an edit has changed, to no effect.

    ``now`` is the sketch after the edit, with what is set by the user in it.
    """
    was = {path: parameter.default for path, parameter in before.graph.leaf_parameters.items()}
    changed = {
        path: parameter
        for path, parameter in now.graph.leaf_parameters.items()
        if path in was and was[path] != parameter.default
    }
    if not changed:
        return []
    by, values = _setters(now.graph, ""), effective_values(now.graph)
    layers = [(f"{shown(now.file)}:{keyframe.line}", keyframe.values) for keyframe in reversed(now.keyframes)]
    for who, pairs in [*layers, (PANEL, now.overrides)]:
        apply(now.graph, values, pairs)
        by |= {target.path: who for path, _ in pairs for target in resolve(now.graph, path)}
    return [
        Shadowed(path, parameter, values[path], by[path])
        for path, parameter in changed.items()
        if path in by and values[path] != parameter.default
    ]


def _setters(graph: Graph, prefix: str) -> dict[str, str]:
    """Return "file:line" of what sets each parameter that a ``set`` names; the outermost counts."""
    setters: dict[str, str] = {}
    for spec in graph.passes:
        inside = f"{prefix}{spec.name}."
        if isinstance(spec.technique, Graph):
            setters |= _setters(spec.technique, inside)
        lines = dict(spec.set_lines)
        for path, _ in spec.values:
            for target in resolve(spec.technique, path):
                setters[f"{inside}{target.path}"] = f"{spec.file}:{lines.get(path, spec.line)}"
    return setters


def warnings_of_kernel(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return warnings of what has no effect, or an undefined one: ``unread``, ``unheeded``, ``unwritten``."""
    return (*unread(kernel), *unheeded(kernel), *unwritten(kernel))


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``1/4``, ``#line``."""
    is_plain = isinstance(kernel, PlainShader) and not isinstance(kernel, ForeignShader)
    diagnostics = [*(unfed_samplers(kernel.source) if is_plain else ())]
    diagnostics += whole_divisions(kernel.source)
    if isinstance(kernel, ForeignShader) and kernel.vertex_source:
        diagnostics += whole_divisions(kernel.vertex_source)
    diagnostics += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(diagnostics))


# ── divisions of whole numbers ───────────────────────────────────────────────

_MAYBE_DIVIDED = re.compile(r"[\d)]\s*/\s*[\d(]")
_TOKEN = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*|[A-Za-z_]\w*|&&|\|\||[<>=!]=|\S")
_WHOLE = re.compile(r"\d+")
_MAX_LITERALS = 64  # tokens of a product of literals
_WHOLE_TYPE = re.compile(r"u?int|[iu]vec[234]")
_DECLARED_WHOLE = re.compile(r"\b(?:u?int|[iu]vec[234])\b(?!\s*\()([^;(){}]*)")
_TAKES = re.compile(r"\b[A-Za-z_]\w* ([A-Za-z_]\w*) \( ([^()]*\b(?:u?int|[iu]vec[234])\b[^()]*) \)")
_WHOLE_GIVEN = frozenset("size iteration iterations until stage texel gl_InstanceID gl_VertexID".split())
_TAKES_WHOLE = frozenset(
    "texelFetch texelFetchOffset textureSize imageLoad imageStore bitfieldExtract".split()
)
_GENERIC = frozenset("abs clamp max min sign".split())  # whole if their arguments are
_NO_CALLS = frozenset("if while for return".split())
_ENDS = frozenset(("(", ")", ",", ";", "{", "}", "?", ":", "&&", "||", "=", "return", "[", "]"))


def whole_divisions(source: SourceText) -> list[Diagnostic]:
    """Return a warning for each division of two whole literals that leaves a remainder, as ``1/4``.

    In GLSL that is a whole number, here 0. Left alone is what is meant so: an index, an array's size, and
    where a whole number is declared, set, compared or handed over.
    """
    if not _MAYBE_DIVIDED.search(source.code):
        return []
    diagnostics: list[Diagnostic] = []
    tokens: list[tuple[str, int, int]] = []  # text, index of its line, column
    directive = False
    for index, line in enumerate(source.lines):
        directive = line.code.lstrip().startswith("#") or (
            directive and source.lines[index - 1].code.endswith("\\")
        )
        if not directive:
            tokens += [(m[0], index, m.start() + 1) for m in _TOKEN.finditer(line.code)]
    texts = [text for text, _, _ in tokens]
    whole = set(_WHOLE_GIVEN)
    for declared in _DECLARED_WHOLE.finditer(" ".join(texts)):
        whole |= set(re.findall(r"(?:^|,)\s*([A-Za-z_]\w*)", declared[1]))
    whole |= {function[1] for function in _TAKES.finditer(" ".join(texts))}
    for at, text in enumerate(texts):
        if text != "/":
            continue
        start, left = _whole_before(texts, at)
        after, right = _whole_after(texts, at + 1)
        if left is None or not right or left % right == 0 or _is_whole(texts, start, after, whole):
            continue
        line, column = source.lines[tokens[start][1]], tokens[start][2]
        last, end = tokens[after - 1][1], tokens[after - 1][2] - 1 + len(texts[after - 1])
        written = line.code[column - 1 : end] if source.lines[last] is line else f"{left}/{right}"
        message = f"{written} divides whole numbers, which gives {left // right}; write {left}.0/{right}.0"
        diagnostics.append(line.diagnostic(message, column, "warning"))
    return diagnostics


def _whole_before(texts: Sequence[str], at: int) -> tuple[int, int | None]:
    """Return where the product of whole literals before a place begins, and its value if it is one."""
    start = at
    while 0 < start and at - start <= _MAX_LITERALS:
        begin = _group_before(texts, start)
        if begin == start or (begin > 0 and texts[begin] == "(" and re.match(r"\w", texts[begin - 1])):
            return at, None
        start = begin
        if start == 0 or texts[start - 1] not in ("*", "/", "%"):
            return start, _evaluated(texts[start:at])
        start -= 1
    return at, None


def _group_before(texts: Sequence[str], end: int) -> int:
    """Return where the literal or bracket of literals begins that ends at a place; else the place."""
    if _WHOLE.fullmatch(texts[end - 1]):
        return end - 1
    depth = 0
    for at in range(end - 1, max(end - _MAX_LITERALS, 0) - 1, -1):
        depth += (texts[at] == ")") - (texts[at] == "(")
        if depth == 0:
            return at if texts[at] == "(" else end
        if not re.fullmatch(r"[()+*/%-]|\d+", texts[at]):
            break
    return end


def _whole_after(texts: Sequence[str], start: int) -> tuple[int, int | None]:
    """Return where the literal, or the bracket of literals, ends that begins at a place, and its value."""
    depth = 0
    for at in range(start, min(start + _MAX_LITERALS, len(texts))):
        if not re.fullmatch(r"[()+*/%-]|\d+", texts[at]):
            break
        depth += (texts[at] == "(") - (texts[at] == ")")
        if depth == 0:
            return at + 1, _evaluated(texts[start : at + 1])
    return start, None


def _evaluated(texts: Sequence[str]) -> int | None:
    """Return the value of literals, brackets and operators, as GLSL has it of positive numbers; else None."""
    try:
        return int(expressions.evaluate(" ".join("//" if text == "/" else text for text in texts), {}))
    except ExpressionError:
        return None


def _is_whole(texts: Sequence[str], start: int, end: int, whole: set[str]) -> bool:
    """Return whether a division stands where a whole number is meant."""
    if _is_among_whole(texts, start, end, whole):
        return True
    before, depth, calls = start, 0, list[str]()
    while before > 0 and texts[before - 1] not in (";", "{", "}"):
        before -= 1
        depth += (texts[before] in (")", "]")) - (texts[before] in ("(", "["))
        if depth < 0:  # a bracket around it
            depth = 0
            if texts[before] == "[":
                return True
            calls.append(texts[before - 1] if before else "")
    # The innermost call decides; what is no call, as a bracket or if, leaves it to what is around.
    for call in calls:
        if _WHOLE_TYPE.fullmatch(call) or call in _TAKES_WHOLE or call == "switch":
            return True
        if re.fullmatch(r"[A-Za-z_]\w*", call) and call not in _NO_CALLS:
            return call in whole
    head = [text for text in texts[before:start] if text not in ("const", "highp", "mediump", "lowp", "(")]
    while head and head[0] in ("if", "else", "for", "while"):
        head.pop(0)
    if head and (_WHOLE_TYPE.fullmatch(head[0]) or head[0] == "case"):
        return True
    if "=" in head and _is_set_whole(" ".join(head[: head.index("=")]), whole):
        return True
    if head[:1] == ["return"]:
        return _returns_whole(texts, before)
    return False


def _is_among_whole(texts: Sequence[str], start: int, end: int, whole: set[str]) -> bool:
    """Return whether only whole numbers join a division, as in ``n + 7/2`` or ``max(n, 7/2)``."""
    while True:
        left, right = _reach(texts, start, -1), _reach(texts, end, 1)
        names = _names_read(texts, [*range(left, start), *range(end, right)])
        opens, closes = left - 1, right
        if not names and (generic := _opening_of_generic(texts, left)) >= 0:
            opens = generic
            while closes < len(texts) and texts[closes] == ",":
                closes = _reach(texts, closes + 1, 1)
            names = _names_read(texts, [*range(opens + 1, start), *range(end, closes)])
            left = opens - 1
        if names:
            return whole >= names
        is_bracket = opens >= 0 and texts[opens] == "(" and texts[closes : closes + 1] == [")"]
        if not is_bracket or (left == opens + 1 and re.match(r"\w", texts[opens - 1])):
            return False
        start, end = min(left, opens), closes + 1


def _reach(texts: Sequence[str], at: int, step: int) -> int:
    """Return how far the operands beside a place reach, with the brackets among them."""
    opens, closes = (("(", "["), (")", "]")) if step > 0 else ((")", "]"), ("(", "["))
    ends = _ENDS.difference(opens)
    depth, index = 0, at if step > 0 else at - 1
    while 0 <= index < len(texts):
        text = texts[index]
        if text in ends and depth == 0:
            break
        depth += (text in opens) - (text in closes)
        index += step
    return index if step > 0 else index + 1


def _opening_of_generic(texts: Sequence[str], at: int) -> int:
    """Return the index of the bracket around an argument of ``max`` or its like; -1 where none is there."""
    while at > 0 and texts[at - 1] == ",":
        at = _reach(texts, at - 1, -1)
    return at - 1 if at > 1 and texts[at - 1] == "(" and texts[at - 2] in _GENERIC else -1


def _names_read(texts: Sequence[str], places: Sequence[int]) -> set[str]:
    """Return the names and the numbers with a point at some places; no members, no ``max`` or its like."""
    return {
        texts[k]
        for k in places
        if re.match(r"[A-Za-z_]|\.\d|\d+\.", texts[k]) and texts[k - 1] != "." and texts[k] not in _GENERIC
    }


def _is_set_whole(target: str, whole: set[str]) -> bool:
    """Return whether what is set, as ``n``, ``n[k]``, ``v.x`` or ``s.count``, is a whole number."""
    bare = re.sub(r"\[[^\]]*\]", "", target).rpartition(")")[2]
    names = bare.strip("+-*/%&|^<> ").split(" . ")
    return names[0] in whole or (len(names) > 1 and names[-1] in whole)


def _returns_whole(texts: Sequence[str], at: int) -> bool:
    """Return whether the function around a place returns a whole number."""
    depth = 0
    for k in range(at - 1, -1, -1):
        depth += (texts[k] == "}") - (texts[k] == "{")
        if depth == -1 and texts[k] == "{" and k and texts[k - 1] == ")":
            opened = next((i for i in range(k - 1, -1, -1) if texts[i : i + 1] == ["("]), 0)
            if opened > 1 and re.match(r"[A-Za-z_]", texts[opened - 2]):
                return bool(_WHOLE_TYPE.fullmatch(texts[opened - 2]))
            depth = 0  # of an if or a loop
    return False


def unread(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each parameter and input of a kernel that nothing reads.

    Included declarations count, at their own file and line. What a fast variant, a pragma or a macro
    reads counts as read, and so does what a size or a repeat of the technique around it names. Sources
    and draws are left alone: the engine reads their uniforms.
    """
    if isinstance(kernel, CpuSource | Draw):
        return ()
    variants = [inner for v in kernel.variants for _, inner in kernels_of(v.technique)]
    texts = [each.source for each in (kernel, *variants)]
    code = "\n".join([text.code for text in texts] + [line.pragma for text in texts for line in text.lines])
    diagnostics = []
    for name in [*(p.name for p in kernel.parameters), *(i.name for i in kernel.inputs)]:
        declared = rf"\buniform\b[^;\n]*?\b{re.escape(name)}\s*(?:=[^;\n]*)?;"
        rest = re.sub(declared, "", code)
        if re.search(rf"\b(?:\w+_)?{re.escape(name)}\b", rest):
            continue
        if name in _counted(Path(kernel.path)):
            continue
        for line in kernel.source.lines:
            if match := re.search(declared, line.code):
                column = match.start() + match[0].index(name) + 1
                diagnostics.append(
                    line.diagnostic(f"nothing reads '{name}', so it has no effect", column, "warning")
                )
                break
    return tuple(diagnostics)


def _counted(path: Path) -> frozenset[str]:
    """Return the parameters of a kernel that sizes and repeats name in the techniques of its folder.

    These are the technique that the folder is of, and those in it. A name is followed to what it exports.
    """
    folder = path.parent
    pictures: set[str] = set()
    for file in (folder.with_suffix(".toml"), *sorted(folder.glob("*.toml"))):
        try:
            table = tomllib.loads(read_regular(file).decode())
            exports = table.get("parameters", {})
            uses = {each["name"]: each["use"].rpartition("/")[2] for each in table.get("pass", [])}
            counts = [each.get(key, "") for each in table.get("pass", []) for key in ("size", "repeat")]
            both = [text for count in counts for text in (count if isinstance(count, list) else [count])]
            for name in {name for text in both if text for name in names_in(str(text))}:
                targets = exports.get(name, name)
                for target in [targets] if isinstance(targets, str) else targets:
                    used = uses.get(target.partition(".")[0], path.stem)
                    # Of a technique in the technique any pass may be the kernel's.
                    if used == path.stem or not (folder / f"{used}.glsl").is_file():
                        pictures.add(target.rpartition(".")[2])
        except (OSError, ValueError, AttributeError, KeyError, TypeError, RecursionError, PlaygroundError):
            continue  # it is not there, or reading the technique itself says what is wrong with it
    return frozenset(pictures)


def warnings_of_sketch(sketch: Sketch) -> tuple[Diagnostic, ...]:
    """Return the warnings of a sketch's file and of its own techniques' files."""
    return tuple(dict.fromkeys([*sketch.warnings, *_of_graph(sketch.graph)]))


def _of_graph(graph: Graph) -> Iterator[Diagnostic]:
    if not Path(graph.path).is_relative_to(GLSL):
        yield from graph.warnings
    for spec in graph.passes:
        if isinstance(spec.technique, Graph):
            yield from _of_graph(spec.technique)


# ── variables that are read before they are written ──────────────────────────


def unwritten(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each local variable that is read before anything is written to it.

    OpenGL gives it no value. Where the order of the text is not that of the run, as in loops, and where a
    part of it or a function may write, none is given. Other tools' shaders begin with zeros.
    """
    if isinstance(kernel, PlainFragment):
        return ()
    from playground.shader.declarations import Declarations
    from playground.shader.preprocessor import readings

    diagnostics: dict[Diagnostic, None] = {}
    for tokens in readings(kernel.source.code):
        reads = _Reads(Declarations(tokens))
        for name, token in reads.before_writing():
            line = kernel.source.lines[token.line]
            message = f"'{name}' is read here before anything is written to it, so its value is undefined"
            diagnostics[line.diagnostic(message, token.start + 1, "warning")] = None
    return tuple(diagnostics)


_STEPS = frozenset({"++", "--"})
_ASSIGNS = frozenset({"+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="})
_LOOPS = frozenset({"for", "while", "do"})
_WRITES_OF_GLSL = {
    "modf": (1,),
    "frexp": (1,),
    "uaddCarry": (2,),
    "usubBorrow": (2,),
    "umulExtended": (2, 3),
    "imulExtended": (2, 3),
}
"""Functions of GLSL that write an argument: which."""


class _Reads:
    """How one reading of a text uses its local variables."""

    def __init__(self, declared: Declarations) -> None:
        self.declared = declared
        self.texts = [token.text for token in declared.tokens]
        self.places: dict[str, list[int]] = defaultdict(list)  # of each name; not of members
        for index, text in enumerate(self.texts):
            if self.texts[index - 1 : index] != ["."]:
                self.places[text].append(index)
        self.loops = [(at, self._end_of_loop(at)) for word in _LOOPS for at in self.places[word]]
        self.writers: dict[str, set[int]] = {name: set(which) for name, which in _WRITES_OF_GLSL.items()}
        for function in (*declared.functions, *declared.prototypes):
            outs = {
                i
                for i, parameter in enumerate(function.parameters)
                if parameter.qualifiers & {"out", "inout"}
            }
            self.writers.setdefault(function.name, set()).update(outs)
        self.known = {*self.writers, *GLSL_WORDS, *declared.structs}

    def before_writing(self) -> Iterator[tuple[str, Token]]:
        """Yield each local variable whose first use is a read, and the token of that."""
        declared = {variable.at for variable in self.declared.variables}
        for variable in self.declared.variables:
            if (
                variable.has_value
                or variable.is_global
                or variable.qualifiers & {"const", "shared"}
                or variable.type.members
            ):
                continue
            uses = [
                at for at in self.places[variable.name] if variable.end < at < self._end_of_scope(variable)
            ]
            if uses and not declared.intersection(uses) and self._is_read(uses[0]):
                around = [end for at, end in self.loops if variable.at < at < uses[0] < end]
                if not any(self._is_written(at) for at in uses if at < max(around, default=0)):
                    yield variable.name, self.declared.tokens[uses[0]]

    def _is_read(self, at: int) -> bool:
        """Return whether a use is certainly a read."""
        after, is_part = self._behind(at)
        if after == "=":
            return not is_part and self._reads_itself(at)
        if self.texts[at + 1 : at + 3] == [".", "length"] or self._is_bracketed(at):
            return False
        return after in _ASSIGNS or after in _STEPS or not self._may_be_written_by_call(at)

    def _is_written(self, at: int) -> bool:
        after, is_part = self._behind(at)
        return (after == "=" and not self._reads_itself(at)) or is_part or self._may_be_written_by_call(at)

    def _behind(self, at: int) -> tuple[str, bool]:
        """Return what follows a variable and the brackets and members of it, and whether there are any."""
        index = at + 1
        while self.texts[index : index + 1] in (["["], ["."]):
            index = (self.declared.closing(index) or index) + 1 if self.texts[index] == "[" else index + 2
        return next(iter(self.texts[index : index + 1]), ""), index > at + 1

    def _is_bracketed(self, at: int) -> bool:
        """Return whether a variable has brackets of its own, behind which it may be written to."""
        return self.texts[at + 1 : at + 2] == [")"] and self.texts[at + 2 : at + 3] in (["="], ["."])

    def _reads_itself(self, at: int) -> bool:
        """Return whether a value that is assigned names the variable."""
        end = self.declared.end_of_value(at + 2)
        uses = [use for use in self.places[self.texts[at]] if at + 2 <= use < end]
        return bool(uses) and self._behind(uses[0])[0] != "="

    def _may_be_written_by_call(self, at: int) -> bool:
        """Return whether a variable is an argument, as a whole, that a function may write."""
        depth, index = 0, 0
        for before in range(at - 1, -1, -1):
            text = self.texts[before]
            if text in (")", "]"):
                depth += 1
            elif text in ("(", "[") and depth:
                depth -= 1
            elif text in ("(", ";", "{", "}", "["):
                name = self.texts[before - 1] if text == "(" and before else ""
                if not re.match(r"[A-Za-z_]", name):
                    return False
                return name not in self.known or index in self.writers.get(name, ())
            elif text == "," and depth == 0:
                index += 1
        return False

    def _end_of_scope(self, variable: Variable) -> int:
        """Return the index of the bracket that closes the block, or the function, that a variable is in."""
        functions = [f for f in self.declared.functions if f.opens < variable.at < f.closes]
        end = functions[0].closes if functions else len(self.texts)
        depth = 0
        for index in range(variable.close, end):
            depth += (self.texts[index] == "{") - (self.texts[index] == "}")
            if depth < 0:
                return index
        return end

    def _end_of_loop(self, at: int) -> int:
        """Return the index of the last token of a loop."""
        index = at + 1
        if self.texts[index : index + 1] == ["("]:
            index = (self.declared.closing(index) or index) + 1
        depth = 0
        for end in range(index, len(self.texts)):
            depth += (self.texts[end] in "({[") - (self.texts[end] in ")}]")
            if depth <= 0 and self.texts[end] in (";", "}"):
                return end
        return len(self.texts)
