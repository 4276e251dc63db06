"""Expressions in the page give what Python's give, to the last digit, and the same sentences."""

from __future__ import annotations

import random

import pytest

from playground.shader import expressions
from playground.shader.expressions import ExpressionError
from playground.web.expression_trees import tree

from .node import Node

NAMES: dict[str, int | float] = {
    "size.x": 513,
    "size.y": 4096,
    "iteration": 7,
    "depth": -3,
    "none": 0,
    "time": 12.34,
    "sharpness": 2.0,
    "tiny": 0.0078125,
    "third": 1 / 3,
}
ASK = """async (trees, names, load) => {
    const { number, whole, integer } = await load("expressions.js");
    const known = Object.fromEntries(Object.entries(names).map(([name, [kind, value]]) =>
        [name, kind === "int" ? BigInt(value) : value]));
    const tried = (run) => {
        try { return run(); } catch (error) { return `${error.name}: ${error.message}`; }
    };
    return trees.map((tree) => [
        tried(() => number(tree, { name: (name) => known[name] })),
        tried(() => String(integer(tree, { name: (name) => known[name] })))]);
}"""


def both(node: Node, texts: list[str]) -> list[list[object]]:
    names = {name: [type(value).__name__, value] for name, value in NAMES.items()}
    result = node.run(ASK, [tree(text) for text in texts], names)
    return [[float(first) if isinstance(first, int) else first, other] for first, other in result]


def python(text: str) -> list[object]:
    values: list[object] = []
    for run in (expressions.evaluate_number, expressions.evaluate):
        try:
            value = run(text, NAMES)
            values.append(value if run is expressions.evaluate_number else str(value))
        except ExpressionError as error:
            values.append(f"PlanError: {error}")
    return values


def written(chance: random.Random, deep: int) -> str:
    """Return an expression of Python's grammar."""
    if deep == 0 or chance.random() < 0.12:
        numbers = "0 1 2 3 7 64 1000003 4611686018427387904 0.5 2.0 0.1 1e9".split()
        return chance.choice(numbers) if chance.random() < 0.5 else chance.choice(list(NAMES))
    first, other, third = (written(chance, deep - 1) for _ in range(3))
    kind = chance.random()
    if kind < 0.62:
        return f"({first} {chance.choice(['+', '-', '*', '/', '/', '//', '//', '%', '%'])} {other})"
    if kind < 0.68:
        return f"({first} ** {chance.choice(['0', '1', '2', '3', '-1', '-2', '5', '63', 'depth', other])})"
    if kind < 0.74:
        return f"({chance.choice('-+')}{first})"
    if kind < 0.80:
        return (
            f"({first} if {other} {chance.choice(['<', '<=', '>', '>=', '==', '!='])} {third} else {third})"
        )
    if kind < 0.84:
        return f"({first} if {other} else {third})"
    if kind < 0.92:
        return f"{chance.choice(['abs', 'floor', 'ceil', 'log2', 'bits'])}({first})"
    return f"{chance.choice(['min', 'max'])}({first}, {other}, {third})"


@pytest.mark.slow
def test_a_thousand_expressions_give_what_pythons_give(node: Node):
    chance = random.Random(1)
    texts = [written(chance, chance.randint(1, 5)) for _ in range(1500)]
    # A number or a name that is all there is needs no words of its own.
    texts = [text for text in texts if len(text) < 300 and isinstance(tree(text), list)]
    assert len(texts) > 1000
    for text, result in zip(texts, both(node, texts), strict=True):
        assert result == python(text), text
    numbers = [outcome for outcome in map(python, texts) if isinstance(outcome[0], float)]
    assert len(numbers) > 400, "most of what was compared are sentences"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("size.x / none", "division by zero"),
        ("size.x % (2 - sharpness)", "division by zero"),
        ("none ** -1", "division by zero"),
        ("log2(size.x)", "log2(513) is not whole: a power of two was expected"),
        ("size.x / 2", "'size.x / 2' gives 256.5; a whole number was expected"),
        ("262143  /  2", "'262143  /  2' gives 131072; a whole number was expected"),
        ("2 ** 0.5", "the exponent of a power should be a whole number"),
        ("2 ** 63", "a power may not be that large"),
        ("2 ** 62 + 1", "'2 ** 62 + 1' grows beyond 2**62"),
        ("((1 / 3) ** 39) ** 2", "'((1 / 3) ** 39) ** 2' grows beyond 2**62"),
        ("bits(-1)", "bits(-1): a whole number from 0 was expected"),
    ],
)
def test_mistakes_are_told_in_the_same_sentence(node: Node, text: str, sentence: str):
    ((_, result),) = both(node, [text])
    assert result == f"PlanError: {sentence}" == python(text)[1]


def test_whole_numbers_are_divided_exactly_and_floats_are_not(node: Node):
    texts = ["3 * (size.x / 3)", "1 / 3 + 1 / 3 + 1 / 3", "49 * (1 / 49)", "49 * (1.0 / 49)"]
    result = both(node, texts)
    assert [item for _, item in result[:3]] == ["513", "1", "1"]
    assert "gives 1; a whole number was expected" in result[3][1]


def test_six_digits_are_written_as_python_writes_them(node: Node):
    chance = random.Random(2)
    numbers = [chance.uniform(-1, 1) * 10 ** chance.randint(-12, 18) for _ in range(2000)]
    numbers += [chance.randint(100_000, 999_999) + 0.5 for _ in range(500)]
    numbers += [0.0, -0.0, 1e5, 999_999.5, 1e6, 1e-4, 9.999995e-5, 123_456_500.0, 2.5, 1e21]
    result = node.run("async (data, load) => data.map((await load('exact.js')).general)", numbers)
    assert result == [f"{number:g}" for number in numbers]


def test_what_an_expression_names_is_known(node: Node):
    expression = ["text", "…", ["if", "time", ["size", "#terrain", 0], ["+", ["value", "a.b"], "time"]]]
    result = node.call("expressions.js", "namesIn", expression)
    assert result == [["name", "time"], ["size", "#terrain"], ["value", "a.b"]]
