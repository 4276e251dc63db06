"""Expressions: against Python's own exact arithmetic, and against hostile texts."""

from __future__ import annotations

import random
import time
from fractions import Fraction

import pytest

from playground.shader.expressions import (
    ExpressionError,
    accepted_sizes,
    check,
    evaluate,
    evaluate_pair,
    is_accepted,
    names_in,
    nearest_accepted,
)

from ..cases import each
from ..refusals import rows

NAMES = {"size.x": 513, "size.y": 257, "octaves": 5, "half": 0.5, "sea": True}


def grown(rng: random.Random, depth: int) -> tuple[str, Fraction]:
    """Return a random expression with its value, which is worked out while the text is made."""
    if depth == 0 or rng.random() < 0.2:
        if rng.random() < 0.4:
            name = rng.choice(["size.x", "size.y", "octaves"])
            return name, Fraction(NAMES[name])
        number = rng.randint(0, 40)
        return str(number), Fraction(number)
    (a, x), (b, y) = grown(rng, depth - 1), grown(rng, depth - 1)
    kind = rng.choice("+-*/%<?nma^f")
    if kind in "/%" and y == 0:
        kind = "+"
    if kind == "/":
        return f"({a} / {b})", x / y
    if kind == "%":
        return f"({a} % {b})", x - y * (x / y).__floor__()
    if kind == "<":
        return f"({a} < {b})", Fraction(x < y)
    if kind == "?":
        return f"({a} if {b} > 10 else 3)", x if y > 10 else Fraction(3)
    if kind == "n":
        return f"-({a})", -x
    if kind == "m":
        return f"max({a}, {b})", max(x, y)
    if kind == "a":
        return f"abs({a} - {b})", abs(x - y)
    if kind == "^":
        return f"(({a}) % 7) ** 2", (x - 7 * (x / 7).__floor__()) ** 2
    if kind == "f":
        return f"floor({a} / 3)", Fraction((x / 3).__floor__())
    return {"+": (f"({a} + {b})", x + y), "-": (f"({a} - {b})", x - y), "*": (f"({a} * {b})", x * y)}[kind]


@pytest.mark.slow
def test_random_expressions_agree_with_exact_arithmetic():
    rng = random.Random(4)
    exact = 0
    for _ in range(3000):
        text, value = grown(rng, 4)
        if abs(value) > 2**40 or value.denominator > 2**40:
            continue
        try:
            result = evaluate(text, NAMES)
        except ExpressionError as error:
            fine = "whole number" in str(error) and value.denominator != 1
            assert fine or "grows" in str(error) or "large" in str(error) or "longer" in str(error), (
                text,
                error,
            )
        else:
            assert result == value and type(result) is int, text
            exact += 1
    assert exact > 1000


@each(
    ("text", "value"),
    [
        ("2**3**2", 512),
        ("-2**2", -4),
        ("3 * (7 / 3)", 7),
        ("2**(4 / 2)", 4),
        ("2 * log2(size.x - 1) + 1", 19),
        ("log2(2**62)", 62),
        ("bits(0)", 0),
        ("bits(7) * 100 + bits(8)", 304),
        ("ceil(7 / 2) + floor(7 / 2)", 7),
        ("1 if sea else 0", 1),
        ("2 if octaves == 5 else 1 / 0", 2),
        ("octaves * half * 2", 5),
        ("min(3, 1, 2)", 1),
        (" 7 ", 7),
        ("+7", 7),
        ("2**-1 * 4", 2),
        ("1_000", 1000),
    ],
)
def test_what_an_expression_gives(text, value):
    result = evaluate(text, NAMES)
    assert result == value and type(result) is int


@each("n", range(63))
def test_log2_is_exact_up_to_the_largest_power(n):
    assert evaluate("log2(x)", {"x": 2**n}) == n
    if n > 1:
        with pytest.raises(ExpressionError, match="power of two"):
            evaluate("log2(x)", {"x": 2**n - 1})


MONSTERS = ["9" * 400, "9" * 5000, "(" * 240 + "1" + ")" * 240, "-" * 499 + "1", "1" + "+1" * 249]
MONSTERS += ["1" + "+1" * 300, "x" * 501, "\ud800"]


@each("text", [*rows("expression"), *MONSTERS])
def test_what_is_no_expression_is_one_sentence_and_quick(text):
    start = time.process_time()
    with pytest.raises(ExpressionError):
        evaluate(text, NAMES)
    assert time.process_time() - start < 5.0  # [s] of this process; a hostile text takes hours


# A quarter of the texts every day, for they are made by chance: the others are no different.
@pytest.mark.parametrize("seed", [8, *(pytest.param(n, marks=pytest.mark.slow) for n in (108, 208, 308))])
def test_rubbish_raises_nothing_else(seed):
    rng = random.Random(seed)
    pieces = [
        *"0123456789.+-*/%()<>=,'\"[]{}~ \\\t\n#:@é",
        "**",
        "//",
        "size.x",
        "log2(",
        " if ",
        " else ",
        "1e9",
    ]
    for _ in range(375):
        text = "".join(rng.choice(pieces) for _ in range(rng.randint(1, 14)))
        for function in (lambda t: evaluate(t, NAMES), names_in, lambda t: check(t, NAMES), accepted_sizes):
            try:
                function(text)
            except ExpressionError as error:
                assert str(error)


def test_an_unknown_name_is_reported_with_the_nearest():
    with pytest.raises(ExpressionError, match=r"names 'octave'.*did you mean 'octaves'"):
        evaluate("2 * octave", NAMES)
    with pytest.raises(ExpressionError, match=r"calls 'log'.*did you mean 'log2'"):
        evaluate("log(4)", NAMES)


def test_names_come_from_a_function_as_well():
    def look_up(name: str) -> int:
        return {"a.b.size.x": 9}[name]

    assert evaluate("a.b.size.x + 1", look_up) == 10
    with pytest.raises(ExpressionError, match=r"'a\.c'"):
        evaluate("a.c", look_up)
    with pytest.raises(ExpressionError):
        evaluate("nan", {"nan": float("nan")})


def test_names_in_an_expression():
    assert names_in("min(size.x, octaves) + a.b.c // 2, 3 if n else m") == {
        "size.x",
        "octaves",
        "a.b.c",
        "n",
        "m",
    }
    assert names_in("2 ** 3") == frozenset()


def test_pairs_split_at_the_outer_comma_alone():
    assert evaluate_pair("min(size.x, 4), 2", NAMES) == (4, 2)
    assert evaluate_pair("1,2", NAMES) == (1, 2)
    for text in ("1", "1, 2, 3", "1,", ","):
        with pytest.raises(ExpressionError):
            evaluate_pair(text, NAMES)


def test_check_looks_into_both_branches():
    check("1 if size.x > 4 else octaves", NAMES)
    check("log2(size.x - 1)", NAMES)  # the value does not matter
    check("1 / size.x, 2", NAMES, count=2)
    with pytest.raises(ExpressionError, match="did you mean"):
        check("1 if size.x > 4 else octavs", NAMES)
    with pytest.raises(ExpressionError):
        check("1, 2", NAMES)
    # Conditions in conditions are looked at once each, not twice at each level.
    nested = "1"
    for _ in range(24):
        nested = f"({nested} if 1 else 2)"
    start = time.process_time()
    check(nested, NAMES)
    assert time.process_time() - start < 5.0  # [s] of this process; twice at each level would be hours


@pytest.mark.parametrize(
    ("accepts", "rule"),
    [
        ("2**n + 1", lambda s: s > 1 and (s - 1) & (s - 2) == 0),
        ("2**n", lambda s: s & (s - 1) == 0),
        ("8 * n", lambda s: s % 8 == 0),
        ("n", lambda s: True),
        ("2**(n - 1)", lambda s: s & (s - 1) == 0),
        ("3", lambda s: s == 3),
    ],
)
def test_accepted_sizes_are_those_of_the_rule(accepts, rule):
    sizes = accepted_sizes(accepts)[0]
    assert list(sizes) == [s for s in range(1, 16385) if rule(s)]
    assert is_accepted(accepts, (sizes[-1], sizes[-1]))
    assert not is_accepted(accepts, (sizes[-1], sizes[-1] - 1))


def test_two_expressions_leave_each_axis_its_own():
    assert is_accepted("2**n, 3 * m", (64, 99))
    assert not is_accepted("2**n, 3 * m", (64, 100))
    assert nearest_accepted("2**n, 3 * m", (100, 100)) == ((64, 99), (128, 102))


def test_the_nearest_accepted_sizes_are_below_and_above():
    assert nearest_accepted("2**n + 1", (300, 200)) == ((257, 257), (513, 513))
    assert nearest_accepted("2**n + 1", (513, 513)) == ((513, 513),)
    assert nearest_accepted("2**n + 1", (1, 1)) == ((2, 2),)


@pytest.mark.parametrize("accepts", ["", "n +", "k", "2**n, m, n", "-n", "n * 0", "n / 0"])
def test_accepts_that_allow_nothing_are_refused(accepts):
    with pytest.raises(ExpressionError):
        accepted_sizes(accepts)


def test_accepted_sizes_may_be_of_either_form():
    assert accepted_sizes("2**n or 2**n + 1", 20)[0] == (1, 2, 3, 4, 5, 8, 9, 16, 17)
    assert is_accepted("2**n or 2**n + 1", (513, 513))
    assert not is_accepted("2**n or 2**n + 1", (512, 513))
    assert nearest_accepted("2**n or 2**n + 1", (1000, 1000)) == ((513, 513), (1024, 1024))
    assert is_accepted("2**n or 2**n + 1, 2**m or 2**m + 1", (512, 65))


def test_accepted_sizes_may_end():
    assert accepted_sizes("2**n up to 16 or n up to 3", 100)[0] == (1, 2, 3, 4, 8, 16)
    assert is_accepted("n up to 4097, m", (4097, 5000)) and not is_accepted("n up to 4097, m", (4098, 1))
    for wrong in ("n up to", "n up to m", "n up to 4.5", "2 up to 1"):
        with pytest.raises(ExpressionError):
            accepted_sizes(wrong)
