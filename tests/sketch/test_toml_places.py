"""Lines of TOML keys: against a document made with its line numbers known."""

from __future__ import annotations

import random

import pytest

from playground.sketch.toml_text import TomlPlaces

TEXT = '''\
# a comment = 1
format = 1
"quoted key" = 2
a.b."c.d" = 3
text = """
not = "a key"
[[not.a.table]]
"""
raw = \'\'\'x = "1"
y = 2\'\'\'
list = [1, 0.5,
  # comment, ]
  { deep = 1, other = [2, 3] }, "]",
  4]

[[pass]]
name = "one"   # name = 7
set = { sun = { azimuth = 1.5, elevation = 2 }, "detail.frequency" = 3, x.y = 4 }
  [pass.inputs]
  height = "a"
[[pass]]
name = "two"
[ pass . set ]
smoothing = 1979-05-27T07:32:00
[[pass.inner]]
z = 1
[[pass.inner]]
z = 2
[view]
use = "x#y" # end
camera.azimuth = 1'''


def expected() -> dict[tuple[str | int, ...], int]:
    return {
        ("format",): 2,
        ("quoted key",): 3,
        ("a", "b", "c.d"): 4,
        ("text",): 5,
        ("raw",): 9,
        ("list",): 11,
        ("list", 0): 11,
        ("list", 1): 11,
        ("list", 2): 13,
        ("list", 2, "deep"): 13,
        ("list", 2, "other"): 13,
        ("list", 2, "other", 0): 13,
        ("list", 2, "other", 1): 13,
        ("list", 3): 13,
        ("list", 4): 14,
        ("pass", 0): 16,
        ("pass", 0, "name"): 17,
        ("pass", 0, "set"): 18,
        ("pass", 0, "set", "sun"): 18,
        ("pass", 0, "set", "sun", "azimuth"): 18,
        ("pass", 0, "set", "sun", "elevation"): 18,
        ("pass", 0, "set", "detail.frequency"): 18,
        ("pass", 0, "set", "x", "y"): 18,
        ("pass", 0, "inputs"): 19,
        ("pass", 0, "inputs", "height"): 20,
        ("pass", 1): 21,
        ("pass", 1, "name"): 22,
        ("pass", 1, "set"): 23,
        ("pass", 1, "set", "smoothing"): 24,
        ("pass", 1, "inner", 0): 25,
        ("pass", 1, "inner", 0, "z"): 26,
        ("pass", 1, "inner", 1): 27,
        ("pass", 1, "inner", 1, "z"): 28,
        ("view",): 29,
        ("view", "use"): 30,
        ("view", "camera", "azimuth"): 31,
    }


def test_every_key_has_its_line():
    assert TomlPlaces(TEXT).lines == expected()


def test_a_place_without_a_line_has_that_of_what_is_around_it():
    lines = TomlPlaces(TEXT)
    assert lines.line(("pass", 0, "set", "nothing", "there")) == 18
    assert lines.line(("pass", 7, "name")) == 16  # the first of the list
    assert lines.line(("nothing", 7, "name")) == 0
    assert lines.line(()) == 0


@pytest.mark.parametrize(
    "text",
    [
        "",
        "\n\n",
        "[",
        "[[",
        "[[pass]",
        "a",
        "a =",
        "a = [",
        "a = {",
        "= 1",
        'a = "',
        "[]",
        "a.=1",
        "]",
        "}",
        "a = [}",
    ],
)
def test_what_is_not_toml_gives_what_there_is(text):
    places = TomlPlaces("first = 1\n" + text)
    assert places.lines["first",] == 1 and places.pairs["first",].value == len("first = ")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, pytest.param(102, marks=pytest.mark.slow)])
def test_any_text_ends_soon_and_raises_nothing(seed):
    rng = random.Random(seed)
    for _ in range(750):
        letters = list(TEXT)
        for _ in range(rng.randint(1, 12)):
            at = rng.randrange(len(letters))
            letters[at : at + rng.randint(0, 3)] = rng.choice(
                ["", "[", '"', "'''", "{", "=", "\n", "\\", "}"]
            )
        TomlPlaces("".join(letters))
    TomlPlaces("a = " + "[" * 100_000)
    TomlPlaces("a = [" + "1, " * 100_000 + "]")
    TomlPlaces("a = {" + "b = {" * 50_000)
