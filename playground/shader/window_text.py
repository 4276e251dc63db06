"""Change a kernel's text so that it runs for a window of a picture, or return why that cannot be.

The text is changed in three places: it gets the texel of the whole, reads the window's own textures at the
window's texel, and ``gl_FragCoord`` counts from the whole's corner.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from playground.memo import GRAPHS
from playground.shader.kernel import Draw, ForeignShader, Kernel, TexelKernel
from playground.shader.reserved_names import MATCHES, WINDOW, WIRED, ZOOM
from playground.shader.source import SourceText
from playground.shader.syntax.nodes import (
    Assign,
    Call,
    Function,
    Index,
    Literal,
    Member,
    Name,
    Node,
    Parenthesized,
    Unary,
    walk,
)
from playground.shader.syntax.preprocessor import preprocess
from playground.shader.syntax.symbols import Symbol, Symbols, symbols_of
from playground.shader.syntax.tokens import tokenize, with_edits

_LOCAL = "k_local"
_COORDINATES = re.compile(r"\bgl_FragCoord\b")


@GRAPHS.cached(identities=1)
def for_window(kernel: Kernel, inputs: tuple[str, ...]) -> Kernel | str:
    """Return a kernel that knows its window, or why there can be none."""
    code = kernel.source.code
    names = _names(code)
    if isinstance(kernel, TexelKernel):
        if not kernel.runs_once or names & {
            "previous",
            *(f"previous_{item.name}" for item in kernel.outputs),
        }:
            return "it depends on the iteration"
        changed, why = _Window(kernel, symbols_of(code), inputs).code()
        if why:
            return why
    else:
        others = [name for name in inputs if name != "initial" and name in names]
        if others:
            return f"it reads '{others[0]}' while it draws"
        changed = _with_coordinates(kernel, code)
    return replace(kernel, source=_source(kernel.source, changed))


def _names(code: str) -> set[str]:
    """Return what a text names in any branch or macro, but for samplers' declarations and members."""
    preprocessed = preprocess(code, all_branches=True)
    tokens = [*preprocessed.tokens, *(token for macro in preprocessed.macros for token in macro.body)]
    before = ["", *(token.text for token in tokens)]
    return {one.text for one, last in zip(tokens, before, strict=False) if last not in (".", "sampler2D")}


class _Window:
    """Changes the text of a kernel that runs for each texel."""

    def __init__(self, kernel: TexelKernel, symbols: Symbols, inputs: tuple[str, ...]) -> None:
        self.inputs = inputs
        self.matches = {f"{MATCHES}{one.name}": one.name for one in kernel.inputs if one.name not in inputs}
        self.symbols = symbols
        self.tree = symbols.tree
        self.edits: dict[tuple[int, int], str] = {}

    def code(self) -> tuple[str, str]:
        """Return the text for a window, and why there is none."""
        kernel = next((one for one in self.tree.declarations if _is_kernel(one)), None)
        if not isinstance(kernel, Function) or kernel.body is None:  # the driver's wrapper says what is wrong
            return self.tree.text, ""
        texel = self.symbols.symbol_at[kernel.parameters[0].at]
        if any(self._means(target, texel) for node in walk(kernel.body) for target in self._written(node)):
            return "", f"it changes its '{texel.name}'"
        edited = self._edit_reads(kernel, texel)
        named = {
            self.tree.tokens[one.token].text
            for one in self.symbols.references
            if one.token not in edited
            and (one.symbol is None or (one.symbol.kind == "uniform" and one.symbol.token != one.token))
        }
        if left := [name for name in self.inputs if name in named]:
            return "", f"it reads '{left[0]}' elsewhere than at its own texel"
        if named & self.matches.keys():
            return "", "a function of its own asks whether an input matches"
        self._edit(texel.token, texel.token + 1, _LOCAL)
        self._edit(kernel.body.first, kernel.body.first + 1, f"{{ ivec2 {texel.name} = {_LOCAL} + {WINDOW};")
        return with_edits(self.tree.text, self.edits), ""

    def _edit_reads(self, kernel: Function, texel: Symbol) -> set[int]:
        """Edit what a kernel reads at its own texel; return the tokens of the names that it reads so."""
        edited = set[int]()
        for site in self.symbols.calls:
            call, arguments = site.node, site.node.arguments
            sampler, level = (arguments[0], arguments[-1]) if len(arguments) > 1 else (None, None)
            if site.around is not kernel or not isinstance(sampler, Name) or sampler.name not in self.inputs:
                continue
            if not isinstance(level, Literal) or level.text != "0":
                continue
            is_own = isinstance(arguments[1], Name) and self._means(arguments[1], texel)
            if (
                call.name == "texelFetch"
                and is_own
                and self._edit(arguments[1].first, arguments[1].last, _LOCAL)
            ):
                edited.add(sampler.first)
            elif call.name == "textureSize" and self._edit(call.first, call.last, "size"):
                edited.add(sampler.first)
        for one in self.symbols.references:
            name = self.matches.get(self.tree.tokens[one.token].text)
            whole = f"({WIRED}{name} && textureSize({name}, 0) == size)"
            if name and one.function is kernel and self._edit(one.token, one.token + 1, whole):
                edited.add(one.token)
        return edited

    def _edit(self, first: int, last: int, text: str) -> bool:
        """Replace tokens; return whether they can be, which no macro writes."""
        tokens = self.tree.tokens[first:last]
        if any(token.macros for token in tokens):
            return False
        self.edits[tokens[0].start, tokens[-1].end] = text
        return True

    def _means(self, node: Node, symbol: Symbol) -> bool:
        """Return whether a node is a variable, or a component of it."""
        while isinstance(node, Member | Index | Parenthesized):
            node = node.inside if isinstance(node, Parenthesized) else node.base
        return isinstance(node, Name) and self.symbols.symbol_at.get(node.first) is symbol

    def _written(self, node: Node) -> Sequence[Node]:
        """Return what a node writes: the target, or the arguments that a function may set."""
        if isinstance(node, Assign):
            return [node.target]
        if isinstance(node, Unary) and node.operator in ("++", "--"):
            return [node.operand]
        functions = self.symbols.callees.get(node, ()) if isinstance(node, Call) else ()
        return [
            argument
            for callee in functions
            if isinstance(callee.node, Function) and isinstance(node, Call)
            for argument, parameter in zip(node.arguments, callee.node.parameters, strict=False)
            if {"out", "inout"}.intersection(parameter.type.qualifiers)
        ]


def _is_kernel(node: Node) -> bool:
    return (
        isinstance(node, Function)
        and node.name == "kernel"
        and node.body is not None
        and bool(node.parameters)
        and node.parameters[0].type.name == "ivec2"
    )


def _with_coordinates(kernel: Kernel, code: str) -> str:
    """Let ``gl_FragCoord`` count from the whole picture's corner."""
    changed = _COORDINATES.sub(f"(gl_FragCoord + vec4({WINDOW}, 0.0, 0.0))", code)
    if isinstance(kernel, Draw):
        return f"{changed}uniform vec4 {ZOOM};\n"  # a line of its own
    if changed == code or isinstance(kernel, ForeignShader):  # whose wrapper declares it
        return changed
    # A plain shader declares for itself: before its first token that no condition is around.
    depth = 0
    for token in tokenize(changed)[0]:
        if token.kind == "directive":
            word = token.text.removeprefix("#").split()[0]
            depth += word.startswith("if") - (word == "endif")
        elif depth == 0:
            return f"{changed[: token.start]}uniform ivec2 {WINDOW}; {changed[token.start :]}"
    return changed


def _source(source: SourceText, code: str) -> SourceText:
    """Return a text with other code on the same lines; what comes after them is taken for the last."""
    changed = code.removesuffix("\n").split("\n")
    lines = (*source.lines, *source.lines[-1:] * (len(changed) - len(source.lines)))
    together = zip(lines, changed, strict=True)
    return SourceText(source.path, tuple(replace(line, code=now) for line, now in together), source.files)
