"""Formulas in a page give what Python's expressions give, and the same sentences."""

from __future__ import annotations

import random

import pytest

from playground.publish.web.formulas import accepted_runs, formula
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, accepted_sizes

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
}
ASK = """async (formulas, names, load) => {
    const { whole } = await load("formulas.js");
    return formulas.map((formula) => {
        try {
            return whole(formula, { name: (name) => names[name] });
        } catch (error) {
            return `${error.name}: ${error.message}`;
        }
    });
}"""


def python(text: str) -> int | str:
    try:
        return expressions.evaluate(text, NAMES)
    except ExpressionError as error:
        return f"PlanError: {error}"


def written(chance: random.Random, deep: int) -> str:
    """Return an expression of Python's grammar."""
    if deep == 0 or chance.random() < 0.12:
        numbers = "0 1 2 3 7 64 1003 0.5 2.0 0.25".split()
        return chance.choice(numbers) if chance.random() < 0.4 else chance.choice(list(NAMES))
    first, other, third = (written(chance, deep - 1) for _ in range(3))
    kind = chance.random()
    if kind < 0.55:
        return f"({first} {chance.choice(['+', '-', '*', '//', '//', '%'])} {other})"
    if kind < 0.60:
        return f"({first} ** {chance.choice('0123')})"
    if kind < 0.68:
        return f"({chance.choice('-+')}{first})"
    if kind < 0.76:
        return (
            f"({first} if {other} {chance.choice(['<', '<=', '>', '>=', '==', '!='])} {third} else {third})"
        )
    if kind < 0.80:
        return f"({first} if {other} else {third})"
    if kind < 0.92:
        return f"{chance.choice(['abs', 'floor', 'ceil', 'log2', 'bits'])}({first})"
    return f"{chance.choice(['min', 'max'])}({first}, {other}, {third})"


def is_small(text: str) -> bool:
    """Whether a page has all digits of what an expression gives, and of its parts."""
    value = python(text)
    return isinstance(value, str) or abs(value) < 2**40


@pytest.mark.slow
def test_a_thousand_formulas_give_what_expressions_give(node: Node):
    chance = random.Random(1)
    texts = [written(chance, chance.randint(1, 4)) for _ in range(3000)]
    texts = [text for text in texts if len(text) < 300 and is_small(text)]
    assert len(texts) > 1000
    results = node.run(ASK, [formula(text) for text in texts], NAMES)
    compared = 0
    for text, result in zip(texts, results, strict=True):
        expected = python(text)
        if isinstance(expected, int) or "division" in expected:
            assert result == expected, text
            compared += isinstance(expected, int)
    assert compared > 500


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("size.x / none", "division by zero"),
        ("size.x % (2 - sharpness)", "division by zero"),
        ("log2(size.x)", "log2(513) is not whole: a power of two was expected"),
        ("size.x / 2", "'size.x / 2' gives 256.5; a whole number was expected"),
        ("bits(depth)", "bits(-3): a whole number from 0 was expected"),
        ("bits(tiny)", "bits(0.0078125): a whole number from 0 was expected"),
    ],
)
def test_mistakes_are_told_in_the_same_sentence(node: Node, text: str, sentence: str):
    [result] = node.run(ASK, [formula(text)], NAMES)
    assert result == f"PlanError: {sentence}" == python(text)


def test_what_was_divided_and_multiplied_again_is_whole(node: Node):
    texts = [
        "3 * (size.x / 3)",
        "size.x / 49 * 49",
        "size.x / 25 * 25 / 27",
        "1 / 3 + 1 / 3 + size.x / 513 / 3",
    ]
    assert node.run(ASK, [formula(text) for text in texts], NAMES) == [513, 513, 19, 1]


def test_fractions_are_rounded_before_they_are_cut_off(node: Node):
    """As Python's, which are exact: 49 of a forty-ninth are 1, and not a little less."""
    texts = [
        f"{outer}({sum_})"
        for divisor in (3, 7, 25, 49, 93, 1000)
        for sum_ in (
            f"size.x / {divisor} * {divisor}",
            f"-size.y / {divisor} * {divisor}",
            f"(1 / {divisor}) * {divisor} * size.x",
            f"size.x - size.x / {divisor} * {divisor}",
        )
        for outer in ("floor", "ceil", "2 * ", "3 // 2 + ")
    ]
    texts += [f"(size.x / {n} * {n}) // 27 + (size.x / {n} * {n}) % 27" for n in (7, 25, 49)]
    results = node.run(ASK, [formula(text) for text in texts], NAMES)
    assert results == [python(text) for text in texts]


def test_an_unknown_name_is_told(node: Node):
    [result] = node.run(ASK, [formula("2 * sides")], NAMES)
    assert result == "PlanError: '2 * sides' names 'sides', which is not known here"


@pytest.mark.parametrize(("text", "number"), [("1", 1), ("2 * (3 + 4)", 14), ("log2(64)", 6)])
def test_what_names_nothing_is_a_number(text: str, number: int):
    assert formula(text) == number


@pytest.mark.parametrize(
    "accepts", ["2**n + 1", "2**n, 2**m + 1", "n up to 4097", "4 * n + 1", "2**n or 2**n + 1", "n, 3 * m"]
)
def test_accepted_sizes_are_runs_of_numbers(accepts: str):
    axes = [
        [number for first, last, step in runs for number in range(first, last + 1, step)]
        for runs in accepted_runs(accepts)
    ]
    assert [tuple(axes[0]), tuple(axes[-1])] == list(accepted_sizes(accepts))
