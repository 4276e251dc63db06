"""Parameters: by path, by widget, shared by kernels, and those that a sketch is about."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.commands.entries import Choice
from playground.engine.sketch_warnings import unread
from playground.errors import ParameterError, ShaderError
from playground.paths import SKETCHES
from playground.shader.header import parse_kernel
from playground.shader.parameter import coerce, expected, write
from playground.shader.source import read_source
from playground.sketch.assign import (
    TERRAIN_KEYS,
    all_paths,
    flat_values,
    resolve,
    shown_parameters,
    value_of,
    values_of,
)
from playground.sketch.find import shipped_sketches
from playground.sketch.model import Kernel
from playground.sketch.replace_technique import with_technique
from playground.sketch.save import save, saved_text

from ..cases import each
from ..loading import load
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


# ── The parameters that a sketch is about: read, checked, saved, and replaced with a technique


HEAD = 'format = 1\nmain = ["height.rise"]  # what it is about\n'
OTHER = '#pragma kernel(output = "height:r32f")\nuniform float fall = 1.0;  //! slider(0, 2)\n'
OTHER += "float kernel(ivec2 texel) { return fall; }\n"


def test_a_sketch_lists_its_main_parameters(folder):
    assert folder.sketch(head=HEAD).main == ("height.rise",)
    assert folder.sketch().main == ()


@pytest.mark.parametrize(
    ("path", "words"), [("height.rize", "did you mean 'height.rise'"), ("relief", "no parameter 'relief'")]
)
def test_one_that_is_gone_is_left_out_with_a_warning(folder, path, words):
    sketch = folder.sketch(head=f'format = 1\nmain = ["{path}", "height.rise"]\n')
    (warning,) = sketch.warnings
    assert sketch.main == ("height.rise",)
    assert warning.message.startswith(f"main leaves out {path}: ") and words in warning.message
    assert warning.line == 2


def test_it_stays_when_a_value_is_saved(folder):
    file = folder.sketch(head=HEAD)
    save(file, file.with_values({"height.rise": 1.5}))
    assert load(file.file).main == ("height.rise",)
    assert HEAD in (folder.path / "s.toml").read_text(encoding="utf-8")


def test_parameter_missing_in_new_technique_leaves_main_list(folder):
    folder.write("other.glsl", OTHER)
    file = folder.sketch(head=HEAD)
    other = with_technique(file, "height", "./other")
    assert other.main == ()
    save(file, other)
    assert load(file.file).main == ()


def test_of_a_technique_opened_alone_all_its_own_are_main(folder):
    assert load(folder.path / "terrain.glsl").main == ("height.rise",)


@pytest.mark.slow
@each("name", sorted(shipped_sketches()))
def test_a_shipped_sketch_says_what_it_is_about(name):
    sketch = load(SKETCHES / f"{name}.toml")
    assert 1 <= len(sketch.main) <= 8, "a handful: the rest is in the passes"
    for path in sketch.main:
        assert resolve(sketch.graph, path)


# ── Parameters that several kernels share: declared once in an included file ─


PRAGMA = '#pragma kernel(output = "height:r32f")\n'
SUN = """#ifndef SUN
#define SUN
uniform float gain = 2.0;  //! slider(0, 4) group("Sun")
                           //! The light is multiplied by it
uniform int steps = 4;     //! slider(1, 9)
#endif
"""


class Folder:
    """A folder of GLSL files."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, **texts: str) -> None:
        for name, text in texts.items():
            (self.path / f"{name}.glsl").write_text(text, encoding="utf-8")

    def kernel(self, text: str) -> Kernel:
        self.write(kernel=text)
        kernel = parse_kernel("kernel", read_source(self.path / "kernel.glsl", (self.path,)))
        assert kernel is not None
        return kernel

    def refused(self, text: str) -> tuple[str, str, int, tuple[str, ...]]:
        with pytest.raises(ShaderError) as caught:
            self.kernel(text)
        diagnostic = caught.value.diagnostics[0]
        chain = tuple(Path(position).name for position in diagnostic.chain)
        return diagnostic.message, Path(diagnostic.file).name, diagnostic.line, chain


@pytest.fixture
def glsl(tmp_path: Path) -> Folder:
    made = Folder(tmp_path)
    made.write(sun=SUN)
    return made


def test_included_parameter_keeps_its_annotation_and_location(glsl: Folder) -> None:
    gain = glsl.kernel(PRAGMA + '#include "sun.glsl"\n').parameters[0]
    assert (gain.default, gain.widget.high, gain.group, gain.tooltip) == (
        2.0,
        4.0,
        "Sun",
        "The light is multiplied by it",
    )
    assert (Path(gain.file).name, gain.line) == ("sun.glsl", 3)


def test_the_panel_has_them_where_the_include_is(glsl: Folder) -> None:
    text = f'{PRAGMA}uniform float first;\n#include "sun.glsl"\nuniform float last;\n'
    assert [p.name for p in glsl.kernel(text).parameters] == [
        "first",
        "gain",
        "steps",
        "last",
    ]


def test_an_expression_of_the_pragma_may_name_one(glsl: Folder) -> None:
    pragma = '#pragma kernel(output = "height:r32f", repeat = "steps")\n'
    assert glsl.kernel(pragma + '#include "sun.glsl"\n').repeat == "steps"


def test_a_file_that_comes_twice_gives_its_parameters_once(glsl: Folder) -> None:
    glsl.write(light='#include "sun.glsl"\nuniform float ambient;\n')
    kernel = glsl.kernel(PRAGMA + '#include "sun.glsl"\n#include "light.glsl"\n#include "sun.glsl"\n')
    assert [p.name for p in kernel.parameters] == ["gain", "steps", "ambient"]


@pytest.mark.parametrize(
    ("own", "position"),
    [
        ('uniform float gain = 1.0;\n#include "sun.glsl"\n', ("sun.glsl", 3, ("kernel.glsl:3",))),
        ('#include "sun.glsl"\nuniform float gain = 1.0;\n', ("kernel.glsl", 3, ())),
    ],
)
def test_redeclared_shared_parameter_is_reported_at_both_places(
    glsl: Folder, own: str, position: tuple[str, int, tuple[str, ...]]
) -> None:
    message, *result = glsl.refused(PRAGMA + own)
    assert tuple(result) == position
    first = "kernel.glsl:2" if position[0] == "sun.glsl" else "sun.glsl:3"
    assert message.startswith("'gain' is declared twice: first at ") and message.endswith(first)


def test_kernel_declares_differing_parameter_and_includes_rest(glsl: Folder) -> None:
    glsl.write(steps="uniform int steps = 4;\n")
    text = f'{PRAGMA}uniform float gain = 1.0;  //! label("Brightness")\n#include "steps.glsl"\n'
    gain, steps = glsl.kernel(text).parameters
    assert (gain.default, gain.label, steps.default) == (1.0, "Brightness", 4)


def test_what_no_code_reads_is_reported_at_its_declaration(glsl: Folder) -> None:
    diagnostics = unread(
        glsl.kernel(f'{PRAGMA}#include "sun.glsl"\nfloat kernel(ivec2 t) {{ return gain; }}\n')
    )
    assert [(Path(d.file).name, d.line, d.message) for d in diagnostics] == [
        ("sun.glsl", 5, "nothing reads 'steps', so it has no effect")
    ]
    assert [Path(position).name for position in diagnostics[0].chain] == ["kernel.glsl:2"]


# Annotations of several lines


@pytest.mark.parametrize(
    "text",
    [
        'uniform float a;  //! slider(0, 1) unit("m") How far\n',
        'uniform float a;  //! slider(0, 1)\n    //! unit("m")\n    //! How far\n',
        'uniform float a;  //! slider(0,\n//! 1) unit("m") How\n//! far\n',
        'uniform float a;  //!\n//! slider(0, 1) unit("m") How far\n',
    ],
)
def test_an_annotation_goes_on_in_lines_of_its_own(glsl: Folder, text: str) -> None:
    parameters = glsl.kernel(f"{PRAGMA}{text}// no part of it\nuniform float b;  //! Another\n").parameters
    assert (parameters[0].widget.high, parameters[0].unit, parameters[0].tooltip) == (1.0, "m", "How far")
    assert [(p.name, p.line) for p in parameters] == [("a", 2), ("b", text.count("\n") + 3)]
    assert parameters[1].tooltip == "Another"


def test_a_line_without_an_annotation_takes_none_from_the_next(glsl: Folder) -> None:
    parameters = glsl.kernel(f"{PRAGMA}uniform float a;\n//! Words\n").parameters
    assert parameters[0].tooltip == ""


# Named expressions of a pragma


def test_where_names_expressions_of_the_pragma(glsl: Folder) -> None:
    kernel = glsl.kernel(
        '#pragma kernel(output = "height:r32f", where = "half = size.x // 2; both = half + steps", \\\n'
        '               repeat = "2 * both")\nuniform int steps = 3;\n'
    )
    assert kernel.repeat == "2 * ((size.x // 2) + steps)"


def test_where_applies_to_groups_and_buffer_counts_not_names(glsl: Folder) -> None:
    kernel = glsl.kernel(
        '#pragma compute(where = "row = size.x + 1; float = 2", groups = "row, 1", \\\n'
        '                buffers = "row:float:row * size.y * float")\n'
    )
    assert kernel.groups == "(size.x + 1), 1"
    assert [(b.name, b.type, b.count) for b in kernel.storage.buffers] == [
        ("row", "float", "(size.x + 1) * size.y * (2)")
    ]


# ── A button, a point with ranges, a menu with values: read, written, saved, drawn


KERNEL = """#pragma kernel(output = "colour:rgba32f", repeat = "1 + (mode == 40)")
uniform int mode = 9;       //! menu("soft", "hard", "none") values(-3, 9, 40) What it does
uniform vec2 place = vec2(0.0, 3.0);  //! point(-1, 1, 2, 4) Where
uniform vec2 even = vec2(0.5);        //! point(-2, 2)
uniform bool go;            //! button label("Go!") Begins anew
vec4 kernel(ivec2 texel) { return vec4(float(mode), place, go ? 1.0 : 0.0) + 0.0 * vec4(even.x); }
"""
SKETCH = """[[pass]]
name = "a"
use = "./a"
size = 2
{}

[view]
use = "view/map"
inputs = {{ shown = "a" }}
"""


@pytest.fixture
def widgets(folder):
    folder.write("a.glsl", KERNEL)
    return lambda more="": load(folder.write("s.toml", f"format = 1\n{SKETCH.format(more)}"))


def parameters(widgets):
    return {p.name: p for p in widgets.graph.find("a").technique.parameters}


def test_what_an_annotation_says(widgets):
    result = parameters(widgets())
    assert (result["mode"].default, result["mode"].widget.values) == (1, (-3, 9, 40))
    assert result["place"].widget.axes == ((-1.0, 1.0), (2.0, 4.0))
    assert (result["place"].widget.low, result["place"].widget.high) == (-1.0, 4.0)
    assert (result["even"].widget.axes, result["even"].widget.low) == ((), -2.0)
    assert (result["go"].widget.kind, result["go"].default, result["go"].title) == ("button", False, "Go!")


def test_values_are_taken_and_written(widgets):
    result = parameters(widgets())
    assert [coerce(result["mode"], name) for name in ("none", 0)] == [2, 0]
    assert write(result["mode"], 2) == "none"
    assert coerce(result["place"], "0.5,4") == (0.5, 4.0)
    assert (coerce(result["go"], "on"), write(result["go"], True)) == (True, "true")
    for name, value, words in (
        ("mode", "nine", "expected one of soft, hard, none; did you mean 'none'"),
        ("mode", "9", "expected one of"),
        ("place", "1,1", "1 is outside its range 2 to 4"),
        ("even", "a", "expected two numbers from -2 to 2, as 0,0"),
    ):
        with pytest.raises(ParameterError, match=words):
            coerce(result[name], value)
    assert expected(result["place"]) == "two numbers from -1 to 1 and from 2 to 4, as 0,3"
    assert Choice("a.place", result["place"], (0.0, 3.0), True).range == "-1 to 1, 2 to 4"
    assert Choice("a.go", result["go"], False, True).range == "true while pressed"
    assert Choice("a.mode", result["mode"], 1, True).as_json()["choices"] == ["soft", "hard", "none"]


def test_the_uniform_gets_the_value_and_a_repeat_names_it(any_engine, widgets):
    for choice, (value, repeat) in {"hard": (9, 1), "soft": (-3, 1), "none": (40, 2)}.items():
        made = widgets(f'set = {{ mode = "{choice}", place = [-1, 4] }}')
        np.testing.assert_array_equal(any_engine.read(made, "a")[0, 0], [value, -1, 4, 0])
        assert any_engine.plan(made, (4, 4)).walk()[0].total == repeat


def test_a_pressed_button_is_true_and_stale_afterwards(any_engine, widgets):
    made = widgets()
    for pressed, seen in ((frozenset({"a.go"}), 1.0), (frozenset({"b.go"}), 0.0), (frozenset(), 0.0)):
        any_engine.runner.pressed = pressed
        assert any_engine.read(made, "a")[0, 0, 3] == seen
    assert any_engine.read(made.with_values({"a.go": True}), "a")[0, 0, 3] == 1.0


def test_it_is_saved_by_its_label(widgets):
    made = widgets().with_values({"a.mode": "none", "a.place": (0.25, 2.5)})
    text = saved_text(SKETCH.format(""), widgets(), made)
    assert 'mode = "none"' in text and "place = [0.25, 2.5]" in text


def test_it_is_reduced_to_the_same_values(widgets):
    from playground.verify.reduce.case import inline_sketch

    case = inline_sketch(widgets('set = { mode = "none" }'), frame=(8, 8))
    assert dict(case.passes[0].values)["mode"] == 2
    assert "values(-3, 9, 40)" in case.passes[0].text


def test_random_values_keep_to_each_range_and_press_nothing(widgets):
    from playground.studio.panel.randomise import at_random, mutated

    result = [(name, p) for name, p in parameters(widgets()).items()]
    now = {name: p.default for name, p in result}
    for seed in range(40):
        for made in (at_random(result, seed), mutated(result, now, seed, 0.9)):
            assert "go" not in made and made["mode"] in (0, 1, 2)
            assert -1 <= made["place"][0] <= 1 and 2 <= made["place"][1] <= 4


def test_a_sweep_goes_through_labels_and_ranges(widgets):
    from playground.publish.sweep import parts_of, sweep_text

    result = parameters(widgets())
    assert sweep_text("a.mode", result["mode"]) == "a.mode=soft,hard,none"
    assert parts_of(result["place"]) == ("x", "y")
    assert sweep_text("a.place", result["place"], "y") == "a.place.y=2..4,9"
