"""Write a pass's size and repeat as trees whose names are absolute: see ``Expression`` in schema.js.

``height.size.x`` is the size of a pass by its whole path, a parameter the value that a leaf is given, so
that a page needs to know nothing of how techniques are nested.
"""

from __future__ import annotations

from playground.engine import sizes
from playground.engine.sizes import FED
from playground.shader.expressions import ITERATIONS
from playground.sketch.flat import Flat
from playground.web.expression_trees import Tree, tree


def pass_tree(text: str, flat: Flat, path: str, *, repeat: bool = False) -> Tree:
    """Return the tree of the size, or the ``repeat``, of the pass at a path of a flat sketch."""
    spec = flat.specs[path]

    def name(word: str) -> Tree:
        kind, where, axis, what = sizes.named(flat, path, word, repeat=repeat)
        if kind == sizes.CLOCK:
            return what
        if kind == sizes.COMPUTE:  # there is none in a page
            return 0
        if kind == sizes.UNWIRED:
            return 1
        if kind == sizes.COUNTER:  # what is in no loop is in iteration 0 of 1
            return [what, where] if where else int(what == ITERATIONS)
        if kind == FED:
            if where in sizes.counting(flat):
                return [FED, where, what, axis]
            output = dict(flat.specs[where].feedback)[what]
            return ["size", flat.outputs[where][output].path, axis]
        if kind == sizes.SIZE:
            return ["size", where, axis]
        where = flat.shape.copied.get(where, where)
        return ["value", where] if kind == sizes.VALUE else ["picture", where, axis]

    try:
        return tree(text, name)
    except KeyError as error:
        message = f"pass '{spec.name}': '{text}' names '{error.args[0]}', which is not known here"
        raise spec.error(message) from None
