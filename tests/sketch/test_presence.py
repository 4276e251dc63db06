"""Passes that are present only where something is wired: named inputs, lists of sources, exports by "*"."""

from itertools import compress, product

import numpy as np
import pytest

from playground.commands.entries import entries_named
from playground.errors import ParameterError, SketchError
from playground.paths import GLSL
from playground.sketch.assign import shown_parameters
from playground.sketch.flatten import flatten
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import as_wired, deciding_inputs, form_of, input_names, missing_input

from ..sketch_texts import passes

NUMBER = """
#pragma kernel(output = "{name}:r32f")
uniform float {name}_is = {value};  //! slider(0, 100)
uniform float common_share = 1.0;  //! slider(0, 9)
float kernel(ivec2 texel) {{ return {name}_is * common_share; }}
"""
SUM = """
#pragma kernel(output = "sum:r32f")
uniform sampler2D base;   //! input
uniform sampler2D extra;  //! input("black")
float kernel(ivec2 texel) {
    return 10.0 * texelFetch(base, texel, 0).r + (wired_extra ? texelFetch(extra, texel, 0).r : 0.5);
}
"""
ADDED = """
#pragma kernel(output = "more:r32f, twice:r32f")
uniform sampler2D density;  //! input
uniform float by = 1.0;     //! slider(0, 9)
void kernel(ivec2 texel, out float more, out float twice) {
    more = by * texelFetch(density, texel, 0).r;
    twice = 2.0 * more;
}
"""
INNER = (
    "\n"
    + passes(
        plain="./plain",
        added=("./added", 'inputs = { density = "density" }'),
        sum=("./sum", 'inputs = { base = ["added:more", "plain"], extra = ["added:twice"] }'),
    )
    + """[inputs]
density = "added.density"
[parameters]
"*" = "*"
"""
)
OUTER = """
[[pass]]
name = "within"
use = "./inner"
[inputs]
density = "within.density"
[parameters]
by = "within.by"
"""
END = "\n" + passes(plain="./plain", end=("./sum", 'inputs = { base = ["within", "plain"] }'))
VIEW = '[view]\nuse = "view/map"\ninputs = { shown = "it" }\n'


@pytest.fixture
def make(folder):
    for name, value in (("plain", 3.0), ("density", 7.0), ("other", 9.0)):
        folder.write(f"{name}.glsl", NUMBER.format(name=name, value=value))
    folder.write("sum.glsl", SUM)
    folder.write("added.glsl", ADDED)
    folder.write("inner.toml", INNER)
    folder.write("outer.toml", OUTER)

    def build(*passes, tail=VIEW, **files):
        for name, text in files.items():
            folder.write(f"{name}.toml", text)
        body = "".join(
            f'[[pass]]\nname = "{n}"\nuse = "./{u}"\n{more}\n'
            for n, u, more in ((*each.split(" ", 2), "")[:3] for each in passes)
        )
        return folder.sketch(body, tail, head="format = 1\nsize = 4\n")

    build.folder = folder
    return build


BARE = ("it inner",)
WIRED = ("it inner inputs = { density = 'late' }", "late density")


@pytest.mark.parametrize("use", ["inner", "outer"])
def test_a_pass_is_there_only_where_its_input_is_wired(engine, make, use):
    """Each form gives what its own passes make: 10 base + extra, base and extra by hand."""
    bare = make(f"it {use}")
    wired = make(f"it {use} inputs = {{ density = 'late' }}", "late density")
    by_name = make("density density", f"it {use}")
    for sketch, expected in ((bare, 10 * 3 + 0.5), (wired, 10 * 7 + 14), (by_name, 10 * 7 + 14)):
        np.testing.assert_array_equal(engine.read(sketch, "it"), np.float32(expected))
    ran = {step.path for step in engine.record.plan.walk()}
    assert not any("plain" in path for path in ran) and any("added" in path for path in ran)


def test_the_name_of_an_output_alone_does_not_decide(make):
    """``./both`` happens to give a density: no trees for that, but for a kernel's input it is as ever."""
    make.folder.write("both.glsl", NUMBER.format(name="density", value=2.0))
    sketch = make("field both", "it inner", "kernel added")
    leaves = {leaf.path: dict(leaf.inputs) for leaf in flatten(sketch).leaves}
    assert "it.added" not in leaves and str(leaves["kernel"]["density"]) == "field:density"


def test_what_is_not_there_is_seen_by_nobody(make):
    bare, wired = make(*BARE), make(*WIRED)
    for sketch, there, gone in ((bare, "plain_is", "by"), (wired, "by", "plain_is")):
        paths = [shown.path for shown in shown_parameters(sketch)]
        assert f"it.{there}" in paths and not any(gone in path for path in paths)
        assert {leaf.path for leaf in flatten(sketch).leaves} >= {"it.sum"}
        assert as_wired(sketch.graph) is sketch.graph
    assert set(bare.files) == set(wired.files) - {str(make.folder.path / "density.glsl")}
    listed = read_technique("./inner", make.folder.path, make.folder.path)
    assert [export.name for export in listed.parameters] == ["plain_is", "common_share", "by"]


def test_setting_what_is_not_there_says_why(make):
    bare, wired = make(*BARE), make(*WIRED)
    for path in ("it.by", "it.added.by"):
        with pytest.raises(ParameterError, match=rf"^{path}: has an effect only where 'density' is wired$"):
            bare.with_values({path: 2.0})
    with pytest.raises(ParameterError, match=r"it\.plain_is: has no effect: another source takes the place"):
        wired.with_values({"it.plain_is": 2.0})
    with pytest.raises(ParameterError, match=r"did you mean 'it\.added\.by'"):
        wired.with_values({"it.added.bye": 2.0})


def test_a_file_that_sets_what_is_not_there_is_warned_once(make):
    rest = '[[preset]]\nname = "p"\nset = { "it.by" = 3.0 }\n[[shot]]\nname = "s"\nset = { "it.by" = 2.0 }\n'
    sketch = make("it inner set = { by = 4.0, common_share = 2.0 }", tail=VIEW + rest)
    warnings = [(warning.message, warning.line) for warning in sketch.warnings]
    why = "by: has an effect only where 'density' is wired"
    assert warnings == [
        (f"pass 'it': {why}", 6),
        (f"preset 'p': it.{why}", 12),
        (f"shot 's': it.{why}", 15),
    ]
    assert sketch.graph.find("it").values == (("common_share", 2.0),)
    assert sketch.with_preset("p") == sketch and sketch.for_shot(sketch.shots[0]) == sketch
    assert not make("density density", "it inner set = { by = 4.0 }", tail=VIEW + rest).warnings


def test_the_latest_earlier_pass_is_one_that_is_there(make):
    """The kernel's ``density`` is unwired: of two passes that give one, only the first is there."""
    text = """
    [[pass]]
    name = "first"
    use = "./density"
    [[pass]]
    name = "second"
    use = "./density"
    inputs = { water = "water" }
    [[pass]]
    name = "end"
    use = "./added"
    [inputs]
    water = "second.water"
    """
    make.folder.write(
        "density.glsl",
        NUMBER.format(name="density", value=1.0) + 'uniform sampler2D water;  //! input("black")\n',
    )
    for sketch, source in (
        (make("it two", two=text), "it.first:density"),
        (make("water other", "it two"), "it.second:density"),
    ):
        inputs = {leaf.path: dict(leaf.inputs) for leaf in flatten(sketch).leaves}
        assert str(inputs["it.end"]["density"]) == source


def changed(text, *pairs):
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    ("pairs", "words", "line"),
    [
        ((('= "density" }', '= "densty" }'),), "input 'density' names no pass 'densty'; did you mean", 4),
        (
            (('["added:more", "plain"]', '["addd", "plain"]'),),
            "names no pass 'addd'; did you mean 'added'",
            8,
        ),
        ((('["added:more", "plain"]', "[]"),), "expected text in quotes, or a list of such", 11),
        ((('base = ["added:more", "plain"]', 'base = "density"'),), "is not for 'sum.base'; list it in", 8),
        ((("[parameters]", '[outputs]\nmore = "aded:more"\n[parameters]'),), "no pass 'aded' inside", None),
    ],
)
def test_a_source_that_is_none_is_refused(make, pairs, words, line):
    make.folder.write("inner.toml", changed(INNER.removeprefix("\n"), *pairs))
    make.folder.refused(words, line, "inner.toml", body='[[pass]]\nname = "it"\nuse = "./inner"\n', tail=VIEW)


def test_a_size_that_names_an_absent_pass_is_refused(make):
    sized = INNER.replace('use = "./sum"', 'use = "./sum"\nsize = "added.size.x"')
    assert make(*WIRED, inner=sized)
    with pytest.raises(SketchError, match=r"pass 'sum': size: .*added\.size\.x"):
        make(*BARE, inner=sized)


def test_an_output_needs_its_passes(make):
    """Inside a technique such a pass is absent, and what names it; in a sketch it is refused."""
    needy = INNER.replace("[parameters]", '[outputs]\nmore = "added:more"\n[parameters]')
    with pytest.raises(SketchError, match=r"pass 'it' needs its input 'density' wired, as inputs"):
        make(*BARE, inner=needy)
    assert make(*WIRED, inner=needy)
    outer = OUTER.split("[parameters]")[0].replace("[inputs]", f"{END}[inputs]")
    for sketch, inner in (
        (make("it outer", inner=needy, outer=outer), "end plain"),
        (make(*WIRED), "added sum"),
    ):
        assert {leaf.path for leaf in flatten(sketch).leaves} >= {f"it.{name}" for name in inner.split()}
    assert not [path for path in flatten(make("it outer")).specs if "within" in path]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("inputs = { density = ['a', 'b'] }", "all passes of a sketch are present"),
        ("inputs = { 'added.density' = 'late' }", "pass 'added' has an effect only where 'density'"),
        ("when = 'density'", "no key 'when' here"),
    ],
)
def test_a_sketch_itself_has_no_conditions(make, more, words):
    with pytest.raises(SketchError, match=words):
        make(f"it inner {more}", "late density")


def test_all_parameters_export_by_name_unless_passes_conflict(make):
    make.folder.write(
        "odd.glsl", NUMBER.format(name="odd", value=1.0).replace("common_share = 1.0", "common_share = 2.0")
    )
    both = INNER.replace('name = "sum"\n', 'name = "odd"\nuse = "./odd"\n[[pass]]\nname = "sum"\n')
    with pytest.raises(
        SketchError,
        match=r"cannot export odd\.common_share as 'common_share': it is not that of plain\.common_share",
    ):
        make(*BARE, inner=both)
    with pytest.raises(SketchError, match="an export of that name is written"):
        make(*BARE, inner=both + 'common_share = "plain.common_share"\n')
    sketch = make(*BARE, inner=both + 'common_share = "plain.common_share"\nodd_share = "odd.common_share"\n')
    paths = [shown.path for shown in shown_parameters(sketch)]
    assert [path for path in paths if path.startswith("it.")] == [
        "it.plain_is",
        "it.odd_is",
        "it.common_share",
        "it.odd_share",
    ]
    with pytest.raises(SketchError, match=r'"\*" = \'sum\': expected "\*"'):
        make(*BARE, inner=INNER.replace('"*" = "*"', '"*" = "sum"'))


def test_the_catalogue_lists_what_any_form_has():
    listed = {choice.path for choice in entries_named("scene/terrain")[0].parameters}
    assert {"trees", "mist", "zenith", "exposure"} <= listed


def test_the_scene_offers_every_parameter_of_every_pass_once():
    """In each of its forms; all combinations of what may be wired are whole."""
    scene = read_technique("scene/terrain", GLSL, GLSL)
    deciding = deciding_inputs(scene)
    assert set(deciding) == {
        *("dome", "density", "rocks", "tufts", "water", "sky_picture"),
        *("cloud", "drift", "weights", "wetness"),
    }
    others = set(input_names(scene)) - set(deciding)
    for chosen in product((True, False), repeat=len(deciding)):
        wired = set(compress(deciding, chosen))
        form = form_of(scene, others | wired)
        assert missing_input(form) == ""
        offered = [target for export in form.parameters for target in export.targets]
        own = [f"{s.name}.{p.name}" for s in form.passes for p in s.technique.parameters]
        assert sorted(offered) == sorted(own)
        names = {spec.name for spec in form.passes}
        assert ("heaven" in names) == ("dome" in wired) and ("watered" in names) == ("water" in wired)
        assert ("sky" in names) == wired.isdisjoint({"dome", "sky_picture"})
        assert ("strewn" in names) == ("rocks" in wired) and ("grown" in names) == ("tufts" in wired)
        trees = {"place", "species", "crowns", "near_trees", "seen", "shade", "wood", "leaves", "wooded"}
        assert trees & names == (trees if "density" in wired else set())
