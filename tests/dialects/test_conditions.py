"""Conditions of a text are judged as a preprocessor does; what depends on the driver stays."""

from __future__ import annotations

import itertools
import random
import shutil
import subprocess

import pytest

from playground.shader.conditions import Conditions


def live(text: str, **defined: str) -> list[str]:
    return [line for line in Conditions(text.split("\n")).live(defined) if line]


CHAIN = """before
#if defined(BUFFER_0)
first
#elif defined ( BUFFER_1 ) || defined DOUBLE_BUFFER_0
second
#  ifdef BUFFER_1
inner
#  endif
#else
last
#endif
after"""


@pytest.mark.parametrize(
    ("defined", "expected"),
    [
        ({}, "before last after"),
        ({"BUFFER_0": ""}, "before first after"),
        ({"BUFFER_1": ""}, "before second inner after"),
        ({"DOUBLE_BUFFER_0": ""}, "before second after"),
        ({"BUFFER_0": "", "BUFFER_1": ""}, "before first after"),
    ],
)
def test_a_chain_of_conditions(defined, expected):
    assert live(CHAIN, **defined) == expected.split()
    assert len(Conditions(CHAIN.split("\n")).live(defined)) == CHAIN.count("\n") + 1


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("1", True),
        ("0", False),
        ("!defined(A)", True),
        ("2 + 3 * 4 == 14 && (2 + 3) * 4 == 20", True),
        ("-7 / 2 == -3 && -7 % 2 == -1", True),
        ("1 << 4 | 1", True),
        ("0x10 == 16 && 010 == 8 && 3u == 3", True),
        ("1 < 2 == 1", True),
        ("~0 == -1", True),
        ("5 & 2", False),
        ("UNDEFINED", False),
        ("0 && GL_OES_standard_derivatives", False),
        ("1 || __VERSION__", True),
    ],
)
def test_an_expression(condition, holds):
    assert live(f"#if {condition}\nyes\n#else\nno\n#endif") == ["yes" if holds else "no"]


@pytest.mark.parametrize(
    "condition",
    [
        "__VERSION__ > 120",
        "GL_OES_standard_derivatives",
        "defined(GL_EXT_x)",
        "F",
        "G(1)",
        "1 +",
        "1 / 0",
        "(1",
        "a b",
    ],
)
def test_what_cannot_be_known_stays(condition):
    text = f"#define F(x) x\n#if {condition}\nyes\n#else\nno\n#endif"
    assert live(text) == text.split("\n")


def test_macros_of_the_text_count_where_they_are_defined():
    text = "#define LEVEL 2\n#define AGAIN LEVEL\n#if AGAIN > 1\nhigh\n#endif\n#undef LEVEL\n"
    text += "#ifdef LEVEL\nno\n#endif"
    assert live(text)[-2:] == ["high", "#undef LEVEL"]
    loop = "#define A B\n#define B A\n#if A\nx\n#endif"
    assert live(loop) == loop.split("\n")
    unsure = "#ifdef GL_X\n#define A\n#endif\n#ifdef A\nx\n#endif"
    assert live(unsure) == unsure.split("\n")
    assert live("#ifdef GL_ES\nx\n#endif\ny") == ["y"]
    assert live("#define F(x) x + 1\n#if F(1) == 2\nhigh\n#endif")[-1] == "high"


@pytest.mark.parametrize("text", ["#if 1\nx", "x\n#endif", "#else\n#endif", "#if 1\n#else\n#else\n#endif"])
def test_conditions_that_do_not_close_stay(text):
    assert live(text) == text.split("\n")


def test_deep_nesting_is_no_crash():
    text = "#if 1\n" * 3000 + "x\n" + "#endif\n" * 3000
    assert live(text)
    assert live(f"#if {'(' * 3000}1{')' * 3000}\nx\n#endif")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cpp") is None, reason="there is no C preprocessor")
def test_it_agrees_with_the_preprocessor_of_c():
    chance = random.Random(7)

    def group(depth: int) -> list[str]:
        lines = [f"line{chance.randrange(1000)}"]
        if depth:
            for _ in range(chance.randrange(3)):
                lines += [f"#if {expression(2)}", *group(depth - 1)]
                lines += [f"#elif {expression(1)}", *group(depth - 1)] if chance.random() < 0.5 else []
                lines += ["#else", *group(depth - 1)] if chance.random() < 0.5 else []
                lines += ["#endif", f"#define M{chance.randrange(3)}_ 1"]
        return lines

    def expression(depth: int) -> str:
        if depth == 0:
            return chance.choice(["A", "B", "C", "defined(A)", "defined C", "!defined(M1_)", "3", "0", "-2"])
        operator = chance.choice("&& || == != < > + - * | & ^".split())
        return f"({expression(depth - 1)} {operator} {expression(depth - 1)})"

    for _ in itertools.repeat(None, 60):
        text = "\n".join(group(3))
        ran = subprocess.run(
            ["cpp", "-P", "-w", "-DA=1", "-DB=0"], input=text, capture_output=True, text=True, check=True
        )
        lines = [line for line in live(text, A="1", B="0") if not line.startswith("#define")]
        assert lines == ran.stdout.split(), text
