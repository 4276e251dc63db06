"""Warn of what has no effect in a sketch's texts, or another effect than its author can see.

* A default in a kernel's file that a sketch's file or the panel overrides: who edits it sees nothing change.
* In a kernel: variables that are read before they are written, declarations that nothing reads, and what
  drawing warns of as well (``sketch.warnings``).
"""

from __future__ import annotations

import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.plan_warnings import own_kernels
from playground.errors import Diagnostic, PlaygroundError
from playground.files import read_regular
from playground.paths import GLSL, shown
from playground.shader.expressions import names_in
from playground.shader.parameter import write
from playground.shader.reserved_names import GLSL_WORDS
from playground.sketch.assign import apply, effective_values, resolve
from playground.sketch.model import (
    CpuSource,
    Draw,
    Graph,
    Kernel,
    Parameter,
    PlainFragment,
    Sketch,
    Value,
    kernels_of,
)
from playground.sketch.warnings import unheeded

if TYPE_CHECKING:
    from playground.shader.declarations import Declarations, Variable
    from playground.shader.syntax.tokens import Token


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


def kernel_warnings(graph: Graph) -> list[Diagnostic]:
    """Return the warnings of a sketch's own kernels; those that ship are left out."""
    return list(dict.fromkeys(w for kernel in own_kernels(graph) for w in warnings_of_kernel(kernel)))


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


# ── variables that are read before they are written ──────────────────────────


def unwritten(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each local variable that is read before anything is written to it.

    OpenGL gives it no value. Where the order of the text is not that of the run, as in loops, and where a
    part of it or a function may write, none is given. Other tools' shaders begin with zeros.
    """
    if isinstance(kernel, PlainFragment):
        return ()
    from playground.shader.declarations import Declarations
    from playground.shader.syntax.preprocessor import readings

    diagnostics: dict[Diagnostic, None] = {}
    for tokens in readings(kernel.source.code):
        reads = _Reads(Declarations(tokens))
        for name, token in reads.before_writing():
            before = kernel.source.code[: token.start]
            line, column = kernel.source.lines[before.count("\n")], token.start - before.rfind("\n")
            message = f"'{name}' is read here before anything is written to it, so its value is undefined"
            diagnostics[line.diagnostic(message, column, "warning")] = None
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
