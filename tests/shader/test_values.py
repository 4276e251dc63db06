"""Values, colours and widgets: what each takes, what it says it wants, and its own text."""

from __future__ import annotations

import math
import random
import re
from pathlib import Path

import numpy as np
import pytest

import playground
from playground.errors import DataError, ParameterError
from playground.paths import GLSL
from playground.shader.colours import linear_to_srgb, parse_hex, srgb_to_linear, to_hex
from playground.shader.parameter import Widget, coerce, expected, label_of, spell, write
from playground.shader.widgets import WIDGETS, at_fraction, fraction_of, usage
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


# ── Colours: the sRGB curve against known pairs, hexadecimal there and back ──


def test_the_curve_passes_through_known_points():
    # Mid grey 128 and the 18 % card (encoded 0.4614) as every table of sRGB has them.
    np.testing.assert_allclose(srgb_to_linear([0.0, 128 / 255, 1.0]), [0.0, 0.2158605, 1.0], atol=1e-7)
    np.testing.assert_allclose(linear_to_srgb(0.18), 0.4613561, atol=1e-7)


def test_the_curve_is_near_the_power_2_2_but_not_it():
    x = np.linspace(0.1, 0.9, 9)
    difference = np.abs(srgb_to_linear(x) - x**2.2)
    assert 1e-4 < difference.max() < 0.01


def test_both_pieces_meet_and_rise():
    x = np.linspace(0.0, 0.1, 20001)
    slopes = np.diff(srgb_to_linear(x)) / np.diff(x)
    assert (slopes > 0.07).all() and slopes.max() < 0.2
    assert abs(float(srgb_to_linear(np.nextafter(0.04045, 1)) - srgb_to_linear(0.04045))) < 1e-7


def test_every_16_bit_code_comes_back():
    codes = np.arange(65536)
    back = linear_to_srgb(srgb_to_linear(codes / 65535.0)) * 65535.0
    assert np.array_equal(np.rint(back).astype(int), codes)


def test_beyond_the_range_the_pieces_go_on_without_a_warning():
    np.testing.assert_allclose(srgb_to_linear([-0.1292, 2.0]), [-0.01, ((2.055) / 1.055) ** 2.4])
    assert linear_to_srgb(-0.01) == pytest.approx(-0.1292)
    assert srgb_to_linear(np.zeros((2, 3, 4), np.float32)).shape == (2, 3, 4)


@pytest.mark.parametrize("text", ["#000000", "#ffffff", "#87a96b", "#01020304", "#10fe80ff"])
def test_hex_comes_back(text):
    assert to_hex(parse_hex(text)) == text


def test_hex_is_decoded_but_alpha_is_not():
    assert parse_hex("#f00") == (1.0, 0.0, 0.0)
    assert parse_hex(" #FF800080 ") == pytest.approx((1.0, 0.2158605, 0.0, 128 / 255), abs=1e-7)


def test_to_hex_clamps():
    assert to_hex((-1.0, 2.0, 0.0)) == "#00ff00"


@pytest.mark.parametrize(
    "text", ["", "#", "red", "#12", "#1234", "#12345", "#gggggg", "123456", "#１２３", 7]
)
def test_what_is_no_colour_is_refused(text):
    with pytest.raises(DataError, match="is not a colour; expected '#rrggbb'"):
        parse_hex(text)


@pytest.mark.parametrize("colour", [(1.0,), (1.0, 2.0), (0.0, float("nan"), 0.0), (1.0,) * 5])
def test_numbers_that_are_no_colour_are_refused(colour):
    with pytest.raises(DataError, match="three or four finite"):
        to_hex(colour)


# ── The table of widgets: what it says is what the library's README and the page runtime have


RUNTIME = Path(playground.__file__).parent / "publish" / "web" / "runtime"


@pytest.mark.parametrize("name", [name for name in WIDGETS if name not in ("number", "file")])
def test_the_readme_has_a_row_for_each_widget(name):
    readme = (GLSL / "README.md").read_text(encoding="utf-8")
    assert f"| {usage(name)} | {WIDGETS[name].about} |" in readme.splitlines()


def test_pages_have_a_control_for_each_widget():
    text = (RUNTIME / "controls.js").read_text(encoding="utf-8")
    table = text[text.index("const KINDS") : text.index("\n};\n")]
    controls = set(re.findall(r"^  (\w+)[,:(]", table, re.MULTILINE))
    assert controls == {kind.control for kind in WIDGETS.values()} - {"numbers"}


@pytest.mark.parametrize("name", WIDGETS)
def test_ranges_suit_the_components(name):
    kind = WIDGETS[name]
    for ends in (*kind.spans, *kind.limits, *filter(None, [kind.range])):
        assert ends[0] < ends[1]
    for ends in (kind.spans, kind.limits):
        assert len(ends) in (0, len(kind.parts))


@pytest.mark.parametrize(("log", "middle"), [(False, 50.05), (True, math.sqrt(10.0))])
def test_a_fraction_of_a_range_is_the_inverse_of_its_number(log, middle):
    low, high = 0.1, 100.0
    assert at_fraction(0.5, low, high, log=log) == pytest.approx(middle)
    for number in (low, 0.7, 31.0, high):
        fraction = fraction_of(number, low, high, log=log)
        assert at_fraction(fraction, low, high, log=log) == pytest.approx(number)


def test_an_empty_range_and_what_lies_below_one_are_at_its_start():
    assert fraction_of(3.0, 3.0, 3.0, log=False) == 0.0
    assert fraction_of(-1.0, 0.1, 100.0, log=True) == 0.0
