"""Read a value that a person types: numbers, expressions such as ``pi/4``, colours, names."""

from __future__ import annotations

import math

from playground.errors import ParameterError
from playground.shader.expressions import ExpressionError, evaluate_numbers
from playground.shader.parameter import coerce, is_whole
from playground.sketch.model import Parameter, Value

NAMES = {"pi": math.pi, "tau": math.tau}
"""What an expression may name."""

_WORDS = ("menu", "file", "checkbox", "button")


def read_typed(parameter: Parameter, text: str, path: str) -> Value:
    """Return the value that a text means; several numbers are separated by commas.

    Raises ``ParameterError`` for what is no expression, and for a value that the parameter
    does not take: one outside its range, which ``--set`` and the sketch refuse as well.
    """
    text = text.strip()
    if parameter.widget.kind in _WORDS or text.startswith("#"):
        return coerce(parameter, text, path)
    try:
        numbers = evaluate_numbers(text, NAMES)
    except ExpressionError as error:
        raise ParameterError(f"{path}: {error}") from None
    whole = is_whole(parameter.type)
    result = [int(n) if whole and n.is_integer() else n for n in numbers]
    return coerce(parameter, result[0] if len(result) == 1 else result, path)
