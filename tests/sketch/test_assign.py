"""Parameters by path: what each resolves to, what is set, what is listed."""

from __future__ import annotations

import numpy as np
import pytest

from playground.errors import ParameterError
from playground.sketch.assign import (
    TERRAIN_KEYS,
    all_paths,
    flat_values,
    resolve,
    shown_parameters,
    value_of,
    values_of,
)

from ..sketch_texts import passes

NOISE = """\
#pragma kernel(output = "height:r32f")
uniform float gain = 1.0;      //! slider(0, 8)
uniform int octaves = 4;       //! slider(1, 9)
uniform vec2 sun = vec2(1.0);  //! direction
float kernel(ivec2 texel) { return gain; }
"""
INNER = (
    passes(coarse=("./noise", "set = { gain = 2 }"), fine=("./noise", "set = { gain = 3, octaves = 6 }"))
    + """[parameters]
gain = ["coarse.gain", "fine.gain"]
detail = "fine.octaves"
"""
)
OUTER = (
    passes(one=("./inner", "set = { gain = 4 }"), two="./inner")
    + """[parameters]
strength = ["one.gain", "two.coarse.gain"]
detail = "two.detail"
"""
)


@pytest.fixture
def sketch(folder):
    folder.write("noise.glsl", NOISE)
    folder.write("inner.toml", INNER)
    folder.write("outer.toml", OUTER)
    body = '[[pass]]\nname = "height"\nuse = "./outer"\n[[pass]]\nname = "more"\nuse = "./noise"\n'
    return folder.sketch(
        body, '[view]\nuse = "./look"\n[[preset]]\nname = "big"\nset = { relief = 9, height.strength = 7 }\n'
    )


def test_every_inner_parameter_has_a_path(sketch):
    paths = all_paths(sketch.graph)
    assert {"more.gain", "height.strength", "height.one.gain", "height.two.fine.octaves"} <= set(paths)
    for path in paths:
        assert resolve(sketch.graph, path)
    assert len(paths) == len(set(paths))


@pytest.mark.parametrize(
    ("path", "leaves"),
    [
        ("more.gain", ["more.gain"]),
        ("height.strength", ["height.one.coarse.gain", "height.one.fine.gain", "height.two.coarse.gain"]),
        ("height.one.gain", ["height.one.coarse.gain", "height.one.fine.gain"]),
        ("height.one.coarse.gain", ["height.one.coarse.gain"]),
        ("height.detail", ["height.two.fine.octaves"]),
    ],
)
def test_a_path_resolves_to_leaves_three_deep(sketch, path, leaves):
    assert [t.path for t in resolve(sketch.graph, path)] == leaves


@pytest.mark.parametrize(
    "path",
    ["", ".", "height", "height.", "height.strenght", "more.gain.x", "x.gain", "..", "height..gain", "\0"],
)
def test_a_path_that_is_none_names_the_nearest(sketch, path):
    with pytest.raises(ParameterError, match="no parameter"):
        resolve(sketch.graph, path)
    with pytest.raises(ParameterError, match="in sketch s"):
        sketch.with_values({path: 1})
    with pytest.raises(ParameterError, match=r"did you mean 'height\.strength'"):
        sketch.with_values({"height.strenght": 1})
    with pytest.raises(ParameterError, match="did you mean 'relief'"):
        sketch.with_values({"releif": 1})


def test_outer_settings_win_and_targets_share_the_first_s_value(sketch):
    values = values_of(sketch)
    # Written down from the three files, innermost first.
    assert values == {
        "height.one.coarse.gain": 4.0,
        "height.one.fine.gain": 4.0,
        "height.two.coarse.gain": 4.0,  # shares one.gain's, by strength
        "height.two.fine.gain": 2.0,  # shares coarse's own default, by the inner gain
        "height.one.coarse.octaves": 4,
        "height.one.fine.octaves": 6,
        "height.two.coarse.octaves": 4,
        "height.two.fine.octaves": 6,
        **{f"height.{a}.{b}.sun": (1.0, 1.0) for a in ("one", "two") for b in ("coarse", "fine")},
        "more.gain": 1.0,
        "more.octaves": 4,
        "more.sun": (1.0, 1.0),
    }


def test_what_is_set_last_wins(sketch):
    item = sketch.with_values({"height.strength": 5, "height.one.fine.gain": 6})
    values = values_of(item)
    assert (values["height.one.coarse.gain"], values["height.one.fine.gain"]) == (5.0, 6.0)
    assert value_of(item, "height.strength", values) == 5.0
    two = item.with_values({"height.strength": 7})
    assert values_of(two)["height.one.fine.gain"] == 7.0
    assert [path for path, _ in two.overrides] == ["height.one.fine.gain", "height.strength"]
    assert values_of(sketch)["height.one.fine.gain"] == 4.0


def test_values_come_in_any_form(sketch):
    result = sketch.with_values(
        {"more.sun": {"azimuth": 10, "elevation": 20}, "more.octaves": "7", "more.gain": np.float32(2)}
    )
    values = values_of(result)
    assert (values["more.sun"], values["more.octaves"], values["more.gain"]) == ((10.0, 20.0), 7, 2.0)
    hash(result)


@pytest.mark.parametrize(
    ("arguments", "field", "value"),
    [
        ({"size": 513}, "size", (513, 513)),
        ({"size": "513x257"}, "size", (513, 257)),
        ({"size": "513,257"}, "size", (513, 257)),
        ({"size": [9, 8]}, "size", (9, 8)),
        ({"size": np.array([9, 8])}, "size", (9, 8)),
        ({"extent": "1e3"}, "extent", (1000.0, 1000.0)),
        ({"extent": (10, 20.5)}, "extent", (10.0, 20.5)),
        ({"relief": "0"}, "relief", 0.0),
        ({"base_elevation": -5}, "base_elevation", -5.0),
    ],
)
def test_the_terrain_is_set_like_a_parameter(sketch, arguments, field, value):
    result = sketch.with_values(arguments)
    assert getattr(result.terrain, field) == value and result.overrides == ()
    hash(result)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *[
            ("size", v)
            for v in (
                0,
                -1,
                16385,
                1.5,
                "x",
                "",
                "1x2x3",
                None,
                True,
                [],
                [1, 2, 3],
                float("nan"),
                16**5000,
                {},
            )
        ],
        *[("extent", v) for v in (0, -1, 1e9, "inf", "nan", "a", [1, 2, 3])],
        *[("relief", v) for v in (-1, 1e9, "nan", [1, 2], "1,2")],
        *[("base_elevation", v) for v in (1e9, "nan", None)],
    ],
    ids=[str(i) for i in range(29)],
)
def test_what_is_no_terrain_is_one_sentence(sketch, key, value):
    assert key in TERRAIN_KEYS
    with pytest.raises(ParameterError, match=f"^{key} = .*: expected") as caught:
        sketch.with_values({key: value})
    assert len(str(caught.value)) < 200


def test_a_preset_may_change_the_terrain(sketch):
    result = sketch.with_preset("big")
    assert result.terrain.relief == 9.0 and values_of(result)["height.one.fine.gain"] == 7.0
    with pytest.raises(ParameterError, match="no preset 'bog'; did you mean 'big'"):
        sketch.with_preset("bog")


def test_exported_parameters_are_shown_first_and_once(sketch):
    shown = [(s.path, s.exported, s.parameter.name) for s in shown_parameters(sketch)]
    height = [s for s in shown if s[0].startswith("height.")]
    assert height[:2] == [("height.strength", True, "strength"), ("height.detail", True, "detail")]
    assert all(not exported for _, exported, _ in height[2:])
    paths = [path for path, _, _ in height[2:]]
    covered = {
        "height.one.coarse.gain",
        "height.one.fine.gain",
        "height.two.coarse.gain",
        "height.two.fine.octaves",
    }
    leaves = {path for path in values_of(sketch) if path.startswith("height.")}
    assert set(paths) == leaves - covered and len(paths) == len(set(paths))
    assert ("more.gain", True, "gain") in shown


def test_tables_join_into_paths_but_not_a_value_that_is_a_table(sketch):
    value = {"height": {"one": {"coarse.sun": {"azimuth": 1, "elevation": 2}}, "strength": 3}, "size": [3, 4]}
    assert flat_values(sketch.graph, value) == {
        "height.one.coarse.sun": {"azimuth": 1, "elevation": 2},
        "height.strength": 3,
        "size": [3, 4],
    }
    with pytest.raises(ParameterError, match="set twice"):
        flat_values(sketch.graph, {"more.gain": 1, "more": {"gain": 2}})
