"""Texts that nest deeper than Python's stack are read as others are."""

from __future__ import annotations

from playground.shader.syntax.parser import parse
from playground.shader.syntax.symbols import resolve

DOUBLED = "\n".join(f"#define M{i} M{i - 1} + M{i - 1}" for i in range(1, 15))
SUM = f"#define M0 x\n{DOUBLED}\nfloat f(float x) {{ return M14; }}\n"


def test_a_sum_of_thousands_is_resolved():
    symbols = resolve(parse(SUM))
    named = [one.symbol.kind for one in symbols.references if one.symbol and one.symbol.name == "x"]
    assert named == ["parameter"] * (2**14 + 1)
