"""Write a pass's size and repeat as trees whose names are absolute: see ``Expression`` in schema.js.

``height.size.x`` is the size of a pass by its whole path, a parameter the value that a leaf is given, so
that a page needs to know nothing of how techniques are nested.
"""

from __future__ import annotations

from playground.sketch import named_numbers
from playground.sketch.flat import Flat
from playground.sketch.model import PassSpec
from playground.web.expression_trees import Tree, tree


def pass_tree(text: str, flat: Flat, path: str, spec: PassSpec) -> Tree:
    """Return the tree of a size or a repeat of the pass at a path of a flat sketch."""
    prefix = path.rpartition(".")[0]

    def name(word: str) -> Tree:
        kind, where, axis = named_numbers.named(flat, prefix, spec, word)
        if kind == named_numbers.CLOCK:
            return where
        if kind == named_numbers.COMPUTE:  # there is none in a page
            return 0
        if kind == named_numbers.SIZE:
            return ["size", where, axis]
        where = flat.shape.copied.get(where, where)
        return ["value", where] if kind == named_numbers.VALUE else ["picture", where, axis]

    try:
        return tree(text, name)
    except KeyError as error:
        message = f"pass '{spec.name}': '{text}' names '{error.args[0]}', which is not known here"
        raise spec.error(message) from None
