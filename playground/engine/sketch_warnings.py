"""Warn of what has no effect in a sketch's texts, or another effect than its author can see.

* A default in a kernel's file that a sketch's file or the panel overrides: who edits it sees nothing change.
* In a kernel: variables that are read before they are written, declarations that nothing reads, and what
  drawing warns of as well (``sketch.warnings``).
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from playground.engine.plan_warnings import own_kernels
from playground.errors import Diagnostic, PlaygroundError
from playground.files import read_regular
from playground.paths import GLSL, shown
from playground.shader.expressions import names_in
from playground.shader.parameter import write
from playground.shader.reserved_names import GLSL_WORDS, OUT_ARGUMENTS
from playground.shader.syntax.influence import unused
from playground.shader.syntax.nodes import (
    Assign,
    Call,
    Declaration,
    Do,
    For,
    Function,
    Index,
    Member,
    Method,
    Name,
    Node,
    Parenthesized,
    While,
    children,
)
from playground.shader.syntax.symbols import Symbol, Symbols, readings, symbols_of
from playground.shader.syntax.tokens import tokenize
from playground.sketch.assign import apply, effective_values, resolve
from playground.sketch.model import (
    CpuSource,
    Draw,
    Graph,
    Kernel,
    Parameter,
    PlainFragment,
    PlainShader,
    Sketch,
    Value,
    kernels_of,
)
from playground.sketch.warnings import unheeded

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
    """Return warnings of what has no effect, or an undefined one: a kernel's texts are parsed for it."""
    return (*unread(kernel), *unused_locals(kernel), *unheeded(kernel), *unwritten(kernel))


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
    names = [*(p.name for p in kernel.parameters), *(i.name for i in kernel.inputs)]
    if not names:
        return ()
    symbols = symbols_of(kernel.source.code, all_branches=True)
    read = _read_words(kernel, symbols)
    diagnostics = []
    for name in names:
        if any(word == name or word.endswith(f"_{name}") for word in read):
            continue
        if name in _counted(Path(kernel.path)):
            continue
        declared = [symbol for symbol in symbols.symbols if symbol.name == name and symbol.kind == "uniform"]
        for symbol in declared[:1]:
            message = f"nothing reads '{name}', so it has no effect"
            diagnostics.append(_at_symbol(kernel, symbols, symbol, message))
    return tuple(diagnostics)


def _read_words(kernel: Kernel, symbols: Symbols) -> set[str]:
    """Return the names that something reads of what stands at a kernel's top level, or around it."""
    variants = [inner for v in kernel.variants for _, inner in kernels_of(v.technique)]
    texts = [line.pragma for each in (kernel, *variants) for line in each.source.lines if line.pragma]
    texts += [each.source.code for each in variants]
    tree = symbols.tree
    # Of a pragma the words in quotes, of a variant those of its macros too.
    tokens = [token for text in texts for token in tokenize(text.translate(_OUTSIDE))[0]]
    tokens += [token for macro in tree.preprocessed.macros for token in macro.body]
    tokens += [token for branch in tree.branches for token in branch.tokens]
    for reference in symbols.references:
        symbol = reference.symbol
        if symbol is None or (symbol.function is None and reference.token != symbol.token):
            tokens.append(tree.tokens[reference.token])
    return {token.text for token in tokens}


def unused_locals(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each local variable that nothing names behind its declaration.

    Other tools' shaders are left alone, and so is what a kernel includes from the library that ships.
    """
    if isinstance(kernel, CpuSource | PlainShader):
        return ()
    own = not Path(kernel.path).is_relative_to(GLSL)
    symbols = symbols_of(kernel.source.code, all_branches=True)
    diagnostics = []
    for symbol in unused(symbols) if not symbols.tree.errors else ():
        line = kernel.source.lines[symbols.tree.line(symbol.token)]
        if symbol.kind == "local" and not (own and Path(line.file).is_relative_to(GLSL)):
            message = f"nothing reads '{symbol.name}'"
            diagnostics.append(_at_symbol(kernel, symbols, symbol, message))
    return tuple(diagnostics)


_OUTSIDE = str.maketrans('"#', "  ")


def _at_symbol(kernel: Kernel, symbols: Symbols, symbol: Symbol, message: str) -> Diagnostic:
    token = symbols.tree.tokens[symbol.token]
    row, column = symbols.tree.place(token.start if token.start == token.spelled else max(token.spelled, 0))
    return kernel.source.lines[row].diagnostic(message, column + 1, "warning")


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
    diagnostics: dict[Diagnostic, None] = {}
    for symbols in readings(kernel.source.code):
        if symbols.tree.errors:
            continue  # what could not be read may write
        for name, token in _Uses(symbols).read_before_writing():
            line, column = symbols.tree.place(symbols.tree.tokens[token].start)
            message = f"'{name}' is read here before anything is written to it, so its value is undefined"
            diagnostics[kernel.source.lines[line].diagnostic(message, column + 1, "warning")] = None
    return tuple(diagnostics)


_Loops = tuple[Node, ...]


class _Use(NamedTuple):
    """One use of a variable, in the order of the run."""

    token: int
    role: str  # read | write | maybe: of a part of it, or by a function
    loops: _Loops  # around it, the outermost first


class _Uses:
    """How the functions of a text use their local variables."""

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self.unset: dict[Symbol, _Loops] = {}  # variables declared without a value, and the loops around them
        self.uses: dict[Symbol, list[_Use]] = defaultdict(list)
        for function in symbols.functions():
            if isinstance(function.node, Function) and function.node.body is not None:
                self._follow(function.node.body)

    def read_before_writing(self) -> Iterator[tuple[str, int]]:
        """Yield each local variable whose first use is certainly a read, and the token of that."""
        for symbol, loops in self.unset.items():
            uses = self.uses.get(symbol, [])
            if uses and uses[0].role == "read":
                around = uses[0].loops[len(loops) :][:1]  # the outermost loop that it may be written in
                if not any(use.role != "read" and set(around) & set(use.loops) for use in uses):
                    yield symbol.name, uses[0].token

    def _follow(self, body: Node) -> None:
        left: list[tuple[Node, str, _Loops]] = [(body, "read", ())]
        while left:
            node, role, loops = left.pop()
            parts: list[tuple[Node | None, str]]
            match node:
                case Name():
                    symbol = self.symbols.symbol_at.get(node.first)
                    if symbol in self.unset:
                        self.uses[symbol].append(_Use(node.first, role, loops))
                    continue
                case Assign():
                    parts = [(node.value, "read"), (node.target, "write" if node.operator == "=" else "read")]
                case Index():
                    parts = [(node.index, "read"), (node.base, "maybe" if role == "write" else role)]
                case Member():
                    parts = [(node.base, "maybe" if role == "write" else role)]
                case Method():
                    parts = [(node.base, "maybe"), *((one, "read") for one in node.arguments)]
                case Parenthesized():
                    parts = [(node.inside, role)]
                case Call():
                    parts = [(one, self._role(node, index)) for index, one in enumerate(node.arguments)]
                case For():
                    head = (node.start, node.condition, node.body, node.step)
                    parts, loops = [(one, "read") for one in head], (*loops, node)
                case While() | Do():
                    parts, loops = [(one, "read") for one in children(node)], (*loops, node)
                case _:
                    parts = [(one, "read") for one in children(node)]
                    if isinstance(node, Declaration):
                        self._declare(node, loops)
            left += [(one, its, loops) for one, its in reversed(parts) if one is not None]

    def _declare(self, node: Declaration, loops: _Loops) -> None:
        of_type = self.symbols.symbol_at.get(node.type.at)
        is_struct = node.type.struct is not None or (of_type is not None and of_type.kind == "struct")
        if is_struct or {"const", "shared"}.intersection(node.type.qualifiers):
            return
        for one in node.names:
            if one.value is None and (symbol := self.symbols.symbol_at.get(one.at)) is not None:
                self.unset[symbol] = loops

    def _role(self, call: Call, index: int) -> str:
        """Return what a call does with an argument."""
        callees = self.symbols.callees.get(call, ())
        functions = [one.node for one in callees if isinstance(one.node, Function)]
        given = [one.parameters[index] for one in functions if index < len(one.parameters)]
        if any({"out", "inout"}.intersection(one.type.qualifiers) for one in given):
            return "maybe"
        is_known = functions or call.name in GLSL_WORDS or call.at in self.symbols.symbol_at
        return "maybe" if not is_known or index in OUT_ARGUMENTS.get(call.name, ()) else "read"
