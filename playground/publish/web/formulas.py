"""Write sizes and counts as formulas that a page works out: see ``Formula`` in schema.js.

Names are resolved here, so that a page knows nothing of how techniques are nested: a formula reads the sizes
of passes by their whole paths, values by the paths of leaf parameters, and the iterations of loops. What
nothing in a page can change is a number.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from playground.data.image_files import picture_size
from playground.engine import sizes
from playground.engine.plan import Plan
from playground.engine.sizes import FED, FRAME, TERRAIN, base_of, counting, first_sources, loops_around
from playground.shader.expressions import (
    CLOCKS,
    ITERATIONS,
    ExpressionError,
    accepted_sizes,
    evaluate,
    names_in,
    parsed,
    split_at_commas,
)
from playground.sketch.assign import resolve
from playground.sketch.flat import Fed
from playground.sketch.model import Kernel

Formula = Any
"""A number, a name, or a list: an operation and what it is of."""

_OPERATORS: dict[type[ast.operator] | type[ast.cmpop], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}


def formula(text: str, named: Callable[[str], Formula] = str) -> Formula:
    """Return an expression as a formula with its text, which messages call it by, or as its whole number.

    ``named`` returns what stands for a dotted name. The expression is one that ``expressions.check``
    lets pass.
    """
    names = {name: named(name) for name in names_in(text)}
    if all(isinstance(value, int) for value in names.values()):
        try:
            return evaluate(text, names)
        except ExpressionError:
            pass  # a page says so where it needs the number
    return ["text", text, _formula(parsed(text), names)]


def accepted_runs(accepts: str) -> list[list[tuple[int, int, int]]]:
    """Return the sizes that a kernel's ``accepts`` allows, as ``Accepted`` of schema.js."""
    axes = accepted_sizes(accepts)[: len(split_at_commas(accepts))]
    return [list(_runs(axis)) for axis in axes]


def _runs(numbers: tuple[int, ...]) -> Iterator[tuple[int, int, int]]:
    """Yield numbers, smallest first, as runs: the first, the last, and how far they are apart."""
    start = 0
    while start < len(numbers):
        step = numbers[start + 1] - numbers[start] if start + 1 < len(numbers) else 1
        end = start
        while end + 1 < len(numbers) and numbers[end + 1] - numbers[end] == step:
            end += 1
        yield numbers[start], numbers[end], step
        start = end + 1


def _formula(node: ast.expr, names: Mapping[str, Formula]) -> Formula:
    def go(inner: ast.expr) -> Formula:
        return _formula(inner, names)

    match node:
        case ast.Constant(value=number):
            return number
        case ast.Name() | ast.Attribute():
            return names[ast.unparse(node)]
        case ast.BinOp(left=left, op=op, right=right):
            return [_OPERATORS[type(op)], go(left), go(right)]
        case ast.UnaryOp(op=op, operand=operand):
            return ["*", go(operand), -1 if isinstance(op, ast.USub) else 1]
        case ast.IfExp(test=test, body=body, orelse=otherwise):
            return ["if", go(test), go(body), go(otherwise)]
        case ast.Compare(left=left, ops=[compare], comparators=[right]):
            return [_OPERATORS[type(compare)], go(left), go(right)]
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return [name, *map(go, arguments)]
    raise AssertionError(f"expressions.check() lets no {type(node).__name__} pass")


class PassFormulas:
    """The sizes of the passes of a plan, and the counts of its loops, as formulas."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.flat = plan.flat
        self.counting = counting(plan.flat)
        self.named: set[str] = set()  # paths of the values that a size or a count names
        self.names_time = False  # one of them names a clock
        self._firsts = dict(first_sources(plan.flat.nodes))
        self._sizes: dict[str, Any] = {}

    def size_of(self, path: str) -> str | list[int]:
        """Return whose size a pass has: its own path, that of a technique around it, or a base.

        Of what no control changes, the texels.
        """
        if path in (TERRAIN, FRAME):
            return path
        if path in self.plan.basis.own:
            return list(self.plan.basis.own[path])
        if self.flat.specs[path].size is None:
            return self.size_of(base_of(path))
        sides = self.sides(path)
        return sides if sides is not None and all(isinstance(side, int) for side in sides) else path

    def sides(self, path: str) -> list[Formula] | None:
        """Return the formulas of the size of a pass, along x and y; None where it says none."""
        size = self.flat.specs[path].size
        if size is None or path in self.plan.basis.own:
            return None
        if path not in self._sizes:
            self._sizes[path] = [path, path]  # its size depends on itself: the page says so
            self._sizes[path] = [self._written(path, text) for text in size]
        return self._sizes[path]  # type: ignore[no-any-return]

    def repeat(self, path: str) -> Formula:
        """Return the formula of the count of a loop."""
        return self._written(path, self.flat.specs[path].repeat, repeat=True)

    def note_counts(self, kernel: Kernel, paths: Mapping[str, str]) -> None:
        """Note what a kernel's own counts name; ``paths`` are those of its parameters."""
        names = frozenset().union(*map(names_in, kernel.counts))
        self.named |= {path for name, path in paths.items() if name in names}
        self.names_time |= not names.isdisjoint(CLOCKS)

    def _written(self, path: str, text: str, *, repeat: bool = False) -> Formula:
        spec = self.flat.specs[path]
        inside = self._counting_around(path)
        bound = inside - {path} if repeat else inside

        def named(word: str) -> Formula:
            return self._name(path, word, bound, repeat=repeat)

        try:
            return formula(text, named)
        except KeyError as error:
            message = f"pass '{spec.name}': '{text}' names '{error.args[0]}', which is not known here"
            raise spec.error(message) from None

    def _name(self, path: str, word: str, bound: frozenset[str], *, repeat: bool) -> Formula:
        """Return what a name in the size, or the ``repeat``, of the pass at a path stands for.

        ``bound`` are the loops of which an iteration is meant: of all others the last.
        """
        kind, where, axis, what = sizes.named(self.flat, path, word, repeat=repeat)
        if kind == sizes.CLOCK:
            self.names_time = True
            return what
        if kind == sizes.COMPUTE:  # there is none in a page
            return 0
        if kind == sizes.UNWIRED:
            return 1
        if kind == sizes.COUNTER:  # what is in no loop is in iteration 0 of 1
            return [what, where] if where else int(what == ITERATIONS)
        if kind == FED:
            return self._fed(Fed(where, what), axis, bound)
        if kind == sizes.SIZE:
            return self._side(where, axis, bound)
        if kind == sizes.PICTURE:  # it was chosen when the page was exported
            leaf, _, parameter = where.rpartition(".")
            return picture_size(Path(str(self.plan.basis.values[leaf][parameter])))[axis]
        menu = resolve(self.flat.graphs[path.rpartition(".")[0]], word)[0].parameter.widget.values
        where = self.flat.shape.copied.get(where, where)
        self.named.add(where)
        return ["value", where, list(menu)] if menu else ["value", where]

    def _side(self, path: str, axis: int, bound: frozenset[str]) -> Formula:
        size = self.size_of(path)
        if not isinstance(size, str):
            return size[axis]
        return self._of_last(["size", size, axis], size, bound)

    def _fed(self, fed: Fed, axis: int, bound: frozenset[str]) -> Formula:
        """Return the size of what a loop feeds back: of the iteration before, else of what comes first."""
        output = dict(self.flat.specs[fed.loop].feedback)[fed.name]
        path = self.flat.outputs[fed.loop][output].path
        if fed.loop not in self.counting:
            return self._side(path, axis, bound)
        inside = bound | self._counting_around(fed.loop)
        before, first = self._side(path, axis, inside), self._firsts[fed]
        if first is None:
            start = before
        elif isinstance(first, Fed):
            start = self._fed(first, axis, inside)
        else:
            start = self._side(first.path, axis, inside)
        return self._of_last(["before", fed.loop, start, before], fed.loop, bound)

    def _of_last(self, size: Formula, path: str, bound: frozenset[str]) -> Formula:
        """Return a formula inside the last iteration of the loops around a pass that are not bound."""
        if path not in (TERRAIN, FRAME):
            for loop in reversed(loops_around(self.flat.specs, path)):
                if loop in self.counting and loop not in bound:
                    size = ["last", loop, size]
        return size

    def _counting_around(self, path: str) -> frozenset[str]:
        return self.counting.intersection(loops_around(self.flat.specs, path))
