"""Values: every widget takes what it should, says what it wants, and comes back from its own text."""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
import pytest

from playground.errors import ParameterError
from playground.shader.colours import linear_to_srgb, parse_hex, srgb_to_linear, to_hex
from playground.shader.parameter import Widget, coerce, expected, label_of, spell, write
from playground.sketch.model import Parameter

from ..cases import each


def of(kind: str, glsl: str, *numbers: float, choices: tuple[str, ...] = ()) -> Parameter:
    return Parameter("p", glsl, 0, Widget(kind, *numbers, choices=choices))


SLIDER = of("slider", "float", 0.0, 1.0)
WHOLE = of("slider", "int", -3.0, 9.0)
SEED = of("number", "uint")
PAIR = of("number", "ivec2")
SUN = of("direction", "vec2")
TINT = of("colour", "vec3")
GLASS = of("colour", "vec4")
MENU = of("menu", "int", choices=("linear", "smooth", "very smooth"))
FLAG = of("checkbox", "bool")
FILE = Parameter("p", "sampler2D", "", Widget("file"))
POINT = of("point", "vec2", 0.0, 1.0)


@each(
    ("parameter", "given", "value"),
    [
        (SLIDER, 0.25, 0.25),
        (SLIDER, 1, 1.0),
        (SLIDER, "0.25", 0.25),
        (SLIDER, [0.25], 0.25),
        (SLIDER, np.float32(0.25), 0.25),
        (WHOLE, 9, 9),
        (WHOLE, "9", 9),
        (WHOLE, 9.0, 9),
        (WHOLE, np.int64(4), 4),
        (SEED, 2**32 - 1, 2**32 - 1),
        (SEED, str(2**32 - 1), 2**32 - 1),
        (PAIR, "3,-4", (3, -4)),
        (PAIR, np.array([3, 4]), (3, 4)),
        (SUN, "135,25", (135.0, 25.0)),
        (SUN, {"azimuth": 135, "elevation": 25.0}, (135.0, 25.0)),
        (SUN, {"elevation": 25.0, "azimuth": 135}, (135.0, 25.0)),
        (SUN, (135, 25), (135.0, 25.0)),
        (TINT, "#000", (0.0, 0.0, 0.0)),
        (TINT, " #FFffFF ", (1.0, 1.0, 1.0)),
        (TINT, [0.1, 0.2, 4.0], (0.1, 0.2, 4.0)),
        (TINT, "0.1,0.2,4", (0.1, 0.2, 4.0)),
        (GLASS, "#ffffff", (1.0, 1.0, 1.0, 1.0)),
        (GLASS, "#ffffff00", (1.0, 1.0, 1.0, 0.0)),
        (MENU, "smooth", 1),
        (MENU, 2, 2),
        (MENU, np.int32(2), 2),
        (FLAG, True, True),
        (FLAG, np.bool_(False), False),
        (FLAG, "on", True),
        (FLAG, "No", False),
        (FILE, "a/b.png", "a/b.png"),
        (FILE, Path("a/b.png"), "a/b.png"),
        (POINT, "0.5,1", (0.5, 1.0)),
    ],
)
def test_what_is_taken(parameter, given, value):
    result = coerce(parameter, given)
    assert result == value and type(result) is type(value)
    hash(result)


@pytest.mark.parametrize(
    ("parameter", "value", "words"),
    [
        (SLIDER, 1.01, "outside its range 0 to 1"),
        (SLIDER, "x", "expected a number from 0 to 1"),
        (SLIDER, "", "expected a number"),
        (SLIDER, True, "expected a number"),
        (SLIDER, None, "expected a number"),
        (SLIDER, math.nan, "finite"),
        (SLIDER, "inf", "finite"),
        (SLIDER, [0.1, 0.2], "expected a number"),
        (SLIDER, {"a": 1}, "expected a number"),
        (SLIDER, 10**400, "expected a number"),
        pytest.param(SLIDER, 16**9000, "expected a number", id="thousands of digits"),
        (WHOLE, 1.5, "expected a whole number from -3 to 9"),
        (WHOLE, 10, "outside its range -3 to 9"),
        (SEED, -1, "from 0 to 4294967295"),
        (SEED, 2**32, "from 0 to 4294967295"),
        (PAIR, [1], "expected 2 whole numbers, as 1,1"),
        (PAIR, [1, 2, 3], "2 whole numbers"),
        (PAIR, [1, "a"], "2 whole numbers"),
        (PAIR, [1, 2**31], "from -2147483648"),
        (SUN, {"azimuth": 1}, "expected { azimuth, elevation }"),
        (SUN, {"azimuth": 1, "elevation": 2, "x": 3}, "azimuth, elevation"),
        (SUN, {"azimuth": 1, "height": 2}, "azimuth, elevation"),
        (SUN, "135", "azimuth and elevation in degrees, as 135,25"),
        (SUN, (0, 91), "elevation 91 is outside -90 to 90"),
        (SUN, (800, 0), "azimuth 800 is outside"),
        (TINT, "#12345", "expected '#rrggbb'"),
        (TINT, "green", "a colour, as #8a9a5b"),
        (MENU, "smoth", "expected one of linear, smooth, very smooth; did you mean 'smooth'"),
        (MENU, 3, "one of linear"),
        (MENU, -1, "one of linear"),
        (MENU, True, "one of linear"),
        (MENU, "x" * 4000, "one of linear"),
        (FLAG, 1, "true or false"),
        (FLAG, "maybe", "true or false"),
        (FILE, 3, "the path of a file"),
        (FILE, "a\0b", "the path of a file"),
        (POINT, "0.5,1.5", "outside its range"),
    ],
)
def test_what_is_refused_in_one_sentence(parameter, value, words):
    with pytest.raises(ParameterError, match=None) as caught:
        coerce(parameter, value, "pass.p")
    message = str(caught.value)
    assert words in message and message.startswith("pass.p") and "\n" not in message and len(message) < 300


@each("parameter", [SLIDER, WHOLE, SEED, PAIR, SUN, TINT, GLASS, MENU, FLAG, FILE, POINT])
def test_every_parameter_says_what_it_expects(parameter):
    assert expected(parameter)


def test_writing_and_reading_gives_the_value_back():
    rng = random.Random(3)
    for _ in range(500):
        number = rng.choice([rng.random(), rng.random() * 10 ** rng.randint(-9, 0), 1 / 3, 0.0, 1.0])
        assert coerce(SLIDER, write(SLIDER, number)) == number
        assert coerce(SEED, write(SEED, whole := rng.choice([0, 7, 2**32 - 1, rng.getrandbits(32)]))) == whole
        pair = (rng.randint(-(2**31), 2**31 - 1), rng.randint(-9, 9))
        assert coerce(PAIR, write(PAIR, pair)) == pair
        sun = (rng.uniform(-720, 720), rng.uniform(-90, 90))
        assert coerce(SUN, write(SUN, sun)) == sun
        tint = tuple(rng.uniform(0, 2) for _ in range(3))
        assert coerce(TINT, write(TINT, tint)) == pytest.approx(tint, abs=1e-7)
        hexadecimal = f"#{rng.getrandbits(24):06x}"
        assert write(TINT, coerce(TINT, hexadecimal)) == hexadecimal
    for value in (True, False):
        assert coerce(FLAG, write(FLAG, value)) is value
    assert coerce(MENU, write(MENU, 2)) == 2
    assert write(SUN, (135.0, 25.0)) == "135,25"
    assert write(SLIDER, 0.1) == "0.1"


def test_values_are_spelt_short():
    deep: list[object] = []
    for _ in range(100):
        deep = [deep]
    for value in (16**9000, deep, "x" * 9000, {"a": {"b": {}}}, True, None, b"x" * 9000):
        assert len(spell(value)) < 200
    assert (spell(True), spell("a"), spell(3)) == ("true", "'a'", "3")


def test_one_colour_and_many_follow_the_same_curve():
    encoded = np.arange(256) / 255.0
    decoded = srgb_to_linear(encoded)
    for byte in range(256):
        text = f"#{byte:02x}{byte:02x}{byte:02x}"
        assert parse_hex(text) == pytest.approx((decoded[byte],) * 3, rel=1e-14)
        assert to_hex(parse_hex(text)) == text
    np.testing.assert_allclose(linear_to_srgb(decoded), encoded, atol=1e-7)


def test_label_is_name_in_words_and_foreign_name_is_kept():
    assert [label_of(n) for n in ("rock_from", "seed2", "iChannel0", "u_lightColor")] == [
        "Rock from",
        "Seed2",
        "iChannel0",
        "u_lightColor",
    ]
