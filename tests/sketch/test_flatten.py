"""Flattening: what feeds what, in which order, with which values, at any nesting."""

from __future__ import annotations

import random

import pytest

from playground.errors import PlaygroundError
from playground.memo import GRAPHS
from playground.sketch import flatten as module
from playground.sketch.assign import values_of
from playground.sketch.find import shipped_sketches
from playground.sketch.flat import Fed, Leaf, Loop, Ref, leaves_of
from playground.sketch.flatten import flatten, substitute_variants
from playground.sketch.model import VARIANTS
from playground.sketch.wiring import (
    initial_names,
    input_names,
    output_names,
    outputs_with_formats,
    takes_input,
)

from ..loading import load


def kernel(outputs: str, *inputs: str, repeat: str = "", parameters: str = "") -> str:
    repeats = f', repeat = "{repeat}"' if repeat else ""
    lines = [f'#pragma kernel(output = "{outputs}"{repeats})']
    for name in inputs:
        name, _, mode = name.partition("?")
        lines.append(f"uniform sampler2D {name};  //! input({mode and chr(34) + mode + chr(34)})")
    lines += [f"uniform float {name} = 0.5;  //! slider(0, 9)" for name in parameters.split()]
    return "\n".join(lines) + "\n"


def passes(*specs: str) -> str:
    """Write passes, each as "name use; a line; another line"."""
    text = ""
    for spec in specs:
        head, *lines = (part.strip() for part in spec.split(";"))
        name, use = head.split()
        text += "\n".join(["[[pass]]", f'name = "{name}"', f'use = "./{use}"', *lines]) + "\n"
    return text


@pytest.fixture
def make(folder):
    folder.write("h.glsl", kernel("height:r32f", parameters="rise"))
    folder.write("water.glsl", kernel("water:r32f", "height", parameters="rain"))
    folder.write("light.glsl", kernel("light:r16f", "height", "water?black"))
    folder.write("both.glsl", kernel("height:r32f, water:r16f", "height"))
    folder.write("steps.glsl", kernel("height:r32f", "mask?white", repeat="size.x // 2"))
    folder.write("look.glsl", kernel("frame:rgba8", "light?white", "height?black"))

    def make_(body: str, **files: str):
        for name, text in files.items():
            folder.write(f"{name}.toml", text)
        return folder.sketch(body)

    make_.folder = folder
    return make_


def wires(sketch, *, variants=(), **options) -> dict[str, dict[str, str]]:
    """Return pass → input → what feeds it, as text, for every leaf."""
    names = {}
    for leaf in leaves_of(substitute_variants(flatten(sketch), variants, **options).nodes):
        names[leaf.path] = {
            name: str(s)
            if isinstance(s, Ref)
            else f"fed {s.loop}:{s.name}"
            if isinstance(s, Fed)
            else "nothing"
            for name, s in leaf.inputs
        }
    return names


# One rule for wiring


def test_unwired_input_takes_latest_same_name_pass_then_output(make):
    result = wires(make(passes("a h", "height h", "b h", "light light")))
    assert result["light"] == {"height": "height:height", "water": "nothing"}
    result = wires(make(passes("a h", "b h", "water water", "light light")))
    assert result["light"] == {"height": "b:height", "water": "water:water"}
    assert result["view"] == {"light": "light:light", "height": "b:height"}


def test_a_wire_names_a_pass_and_perhaps_an_output(make):
    body = passes(
        "a h", "b both; inputs = { height = 'a' }", "c light; inputs = { height = 'b:water', water = 'b' }"
    )
    assert wires(make(body))["c"] == {"height": "b:water", "water": "b:water"}


def test_later_passes_may_be_wired_and_then_run_first(make):
    sketch = make(passes("light light; inputs = { height = 'late' }", "late h"))
    assert [n.path for n in flatten(sketch).nodes] == ["late", "light", "view"]


def test_a_missing_wire_lists_the_candidates(make):
    make.folder.refused("needs its input 'height' wired", 2, body=passes("w water"))
    make.folder.write("odd.glsl", kernel("odd:r8, even:r8"))
    error = make.folder.refused("candidates: o:odd, o:even", 5, body=passes("o odd", "w water"))
    assert 'inputs = { height = "…" }' in str(error)
    assert "there is no earlier pass" in str(make.folder.refused("wired", 2, body=passes("w water")))


@pytest.mark.parametrize("size", [2, 3, 5])
def test_a_circle_is_named_whole(make, size):
    names = [f"p{i}" for i in range(size)]
    body = passes(
        "start h",
        *(
            f"{a} water; inputs = {{ height = '{b}' }}"
            for a, b in zip(names, names[1:] + names[:1], strict=True)
        ),
    )
    error = make.folder.refused("read each other in a circle: p0 → p1", None, body=body)
    assert str(error).count("p0") == 2


def test_a_pass_that_reads_itself_is_a_circle(make):
    make.folder.refused("p → p", 2, body=passes("p water; inputs = { height = 'p' }"))
    text = passes("p both; repeat = 3; inputs = { height = 'p' }; feedback = { height = 'water' }")
    make.folder.refused("pass 'p' reads itself; feedback", 2, body=text)


def test_passes_run_after_their_inputs_in_any_file_order(make):
    rng = random.Random(1)
    for _ in range(60):
        count = rng.randint(2, 9)
        reads = {i: rng.randrange(i) for i in range(1, count)}
        order = list(range(count))
        rng.shuffle(order)
        specs = [f"p{i} water; inputs = {{ height = 'p{reads[i]}' }}" if i else "p0 h" for i in order]
        sketch = make(passes(*specs))
        flat = flatten(sketch)
        position = {node.path: k for k, node in enumerate(flat.nodes)}
        assert (
            all(position[f"p{a}"] > position[f"p{b}"] for a, b in reads.items())
            and len(position) == count + 1
        )


# Nesting

INNER = passes("low h", "high both; inputs = { height = 'low' }") + '[parameters]\nrise = "low.rise"\n'
MIDDLE = passes("core inner", "top water") + (
    '[parameters]\nrise = "core.rise"\nrain = "top.rain"\n[inputs]\nsea = "top.height"\n'
    '[outputs]\nwater = "top"\nheight = "core.low"\ndepth = "core:water"\n'
)
OUTER = passes("deep middle; inputs = { sea = 'ground' }", "ground h") + (
    '[outputs]\nheight = "deep"\nwater = "deep:depth"\nlow = "deep.core.low:height"\n'
)
NESTED = {"inner": INNER, "middle": MIDDLE, "outer": OUTER}


def test_three_levels_become_leaves_with_whole_paths(make):
    sketch = make(passes("height outer", "light light"), **NESTED)
    assert wires(sketch) == {
        "height.ground": {},
        "height.deep.core.low": {},
        "height.deep.core.high": {"height": "height.deep.core.low:height"},
        "height.deep.top": {"height": "height.ground:height"},
        "light": {"height": "height.deep.core.low:height", "water": "height.deep.core.high:water"},
        "view": {"light": "light:light", "height": "height.deep.core.low:height"},
    }


def test_outputs_go_down_to_leaves_and_paths_go_inside(make):
    sketch = make(
        passes(
            "height outer", "light light; inputs = { height = 'height.deep.core.high', water = 'height:low' }"
        ),
        **NESTED,
    )
    assert wires(sketch)["light"] == {
        "height": "height.deep.core.high:height",
        "water": "height.deep.core.low:height",
    }
    flat = flatten(sketch)
    for text, expected in (
        ("height", "height.deep.core.low:height"),
        ("height:water", "height.deep.core.high:water"),
        ("height.deep", "height.deep.top:water"),
        ("height.deep:depth", "height.deep.core.high:water"),
        ("height.deep.core", "height.deep.core.high:height"),
        ("height.deep.core.high:water", "height.deep.core.high:water"),
        ("view", "view:frame"),
    ):
        assert str(flat.ref(text, "s")) == expected
    for text, words in (
        ("hieght", "did you mean 'height'"),
        ("height:dept", "no output 'dept'"),
        ("", "no pass ''"),
    ):
        with pytest.raises(PlaygroundError, match=words):
            flat.ref(text, "s")
    technique = sketch.graph.find("height").technique
    assert output_names(technique) == ("height", "water", "low") and input_names(technique) == ()
    assert [(o.name, o.format) for o in outputs_with_formats(technique)] == [
        ("height", "r32f"),
        ("water", "r16f"),
        ("low", "r32f"),
    ]


def test_a_path_s_own_name_is_its_output_before_the_first(make):
    make.folder.write("water2.glsl", kernel("height:r32f, water:r32f"))
    flat = flatten(make(passes("a t"), t=passes("water water2")))
    assert str(flat.ref("a.water", "s")) == "a.water:water"


def test_what_is_wired_inside_wins_over_the_export_around_it(make):
    two = passes("x water; inputs = { }", "y water") + '[inputs]\nheight = ["x.height", "y.height"]\n'
    body = passes("a h", "b h", "t two; inputs = { height = 'a', 'y.height' = 'b' }")
    result = wires(make(body, two=two))
    assert (result["t.x"], result["t.y"]) == ({"height": "a:height"}, {"height": "b:height"})
    body = passes("a h", "b h", "t two; inputs = { 'y.height' = 'a' }")
    result = wires(make(body, two=two))
    assert (result["t.x"], result["t.y"]) == ({"height": "b:height"}, {"height": "a:height"})
    # Once all targets of an export are wired, the export itself needs nothing.
    item = passes("x water") + '[inputs]\nheight = "x.height"\n'
    body = passes("t one; inputs = { 'x.height' = 'late' }", "late h")
    assert wires(make(body, one=item))["t.x"] == {"height": "late:height"}


def test_optional_inputs_stay_empty_through_techniques(make):
    shell = passes("inner light") + '[inputs]\nheight = "inner.height"\nwet = "inner.water"\n'
    result = wires(make(passes("a h", "t shell"), shell=shell))
    assert result["t.inner"] == {"height": "a:height", "water": "nothing"}
    make.folder.refused("needs its input 'height' wired", 2, body=passes("t shell"))


def test_initial_states_are_optional_inputs(make):
    sketch = make(passes("a h", "b steps; inputs = { initial = 'a' }"))
    assert wires(sketch)["b"] == {"mask": "nothing", "initial": "a:height"}
    technique = sketch.graph.find("b").technique
    assert initial_names(technique) == {"initial": "height"}
    assert takes_input(technique, "initial") and not takes_input(technique, "initial_height")
    make.folder.write("two.glsl", kernel("a:r8, b:r8", repeat="3"))
    technique = make(passes("x h", "t two")).graph.find("t").technique
    assert initial_names(technique) == {"initial_a": "a", "initial_b": "b"}
    assert initial_names(make(passes("x h")).graph.find("x").technique) == {}


# Loops

ERODE = passes("rain water", "flow both; inputs = { height = 'rain' }") + '[inputs]\nheight = "rain.height"\n'


def test_a_loop_feeds_its_own_output_back(make):
    body = passes(
        "h h", "e erode; repeat = '2 + 1'; feedback = { height = 'height' }; inputs = { height = 'h' }"
    )
    sketch = make(body, erode=ERODE)
    loop = next(n for n in flatten(sketch).nodes if isinstance(n, Loop))
    assert (loop.path, loop.repeat) == ("e", "2 + 1")
    assert loop.feedback == (("height", Ref("h", "height"), Ref("e.flow", "height")),)
    assert [n.path for n in loop.body] == ["e.rain", "e.flow"]
    assert wires(sketch)["e.rain"] == {"height": "fed e:height"}
    assert wires(sketch)["view"]["height"] == "e.flow:height"


def test_loops_nest_and_start_from_outside(make):
    middle = (
        passes("in erode; repeat = 2; feedback = { height = 'water' }", "out both")
        + '[inputs]\nheight = "in.height"\n'
    )
    body = passes(
        "m middle; repeat = 3; feedback = { height = 'height' }; inputs = { height = 'late' }", "late h"
    )
    sketch = make(body, erode=ERODE, middle=middle)
    nodes = flatten(sketch).nodes
    assert [n.path for n in nodes] == ["late", "m", "view"]
    outer = nodes[1]
    inner = next(n for n in outer.body if isinstance(n, Loop))
    assert inner.feedback == (("height", Fed("m", "height"), Ref("m.in.flow", "water")),)
    assert outer.feedback[0][1] == Ref("late", "height")
    assert wires(sketch)["m.in.rain"] == {"height": "fed m.in:height"}


def test_two_loops_that_start_from_each_other_are_a_circle(make):
    body = passes(
        "a erode; repeat = 2; feedback = { height = 'height' }; inputs = { height = 'b' }",
        "b erode; repeat = 2; feedback = { height = 'height' }; inputs = { height = 'a' }",
    )
    make(passes("h h"), erode=ERODE)
    make.folder.refused("in a circle: a", None, body=body)


def test_mistakes_in_a_loop_have_its_line(make):
    make(passes("h h"), erode=ERODE)
    head = "[[pass]]\nname='h'\nuse='./h'\n[[pass]]\nname='e'\nuse='./erode'\n"
    for line, words in (
        ("repeat = 2\nfeedback = { hieght = 'height' }", "has no input 'hieght'; did you mean 'height'"),
        ("repeat = 2\nfeedback = { height = 'hieght' }", "has no output 'hieght'; did you mean 'height'"),
        ("repeat = 2\nfeedback = { height = 3 }", "expected text in quotes"),
    ):
        make.folder.refused(words, 9, body=head + line + "\n")
    make.folder.refused(
        "repeat: 'tims'", 5, body=head + "repeat = 'tims'\nfeedback = { height = 'height' }\n"
    )


def test_a_repeat_may_read_time_sizes_and_parameters(make):
    tail = "feedback = { height = 'height' }\n"
    for text in ("time * 3", "h.size.x", "size.y", "h.rise * 2", "e.rain.rain", "e.rain.size.x"):
        body = passes("h h", "e erode") + f"repeat = '{text}'\n{tail}"
        make(body, erode=ERODE)


# Fast variants


@pytest.fixture
def doubled(make, trusted_variants):
    """A technique of two passes with a compute variant, and one around it."""
    make.folder.write(
        "fast.comp",
        '#pragma compute(groups = "1, 1")\nuniform float rise;\nuniform sampler2D height; //! input\n',
    )
    fast = passes("a h", "b both") + '[parameters]\nrise = "a.rise"\n[inputs]\nheight = "b.height"\n'
    around = passes("g h", "f fast") + '[parameters]\nrise = "f.rise"\n'

    def doubled_(body: str):
        return make(body, fast=fast, around=around)

    return doubled_


def test_a_fast_variant_replaces_its_technique_where_it_can_run(doubled):
    sketch = doubled(passes("h h", "t fast; set = { rise = 3 }", "l light"))
    assert set(wires(sketch)) == {"h", "t.a", "t.b", "l", "view"}
    assert wires(sketch, variants=VARIANTS)["t"] == {"height": "h:height"}
    flat = substitute_variants(flatten(sketch), VARIANTS)
    leaf = next(leaf for leaf in leaves_of(flat.nodes) if leaf.path == "t")
    assert leaf.kernel.kind == "compute" and flat.values_of(leaf) == {"rise": 3.0}
    assert str(flat.ref("t:water", "s")) == "t:water"


@pytest.mark.parametrize(
    "body",
    [
        passes("h h", "t fast", "l light; inputs = { height = 't.a' }"),
        passes("h h", "t around", "l light; inputs = { height = 't.f.a' }"),
        passes("h h", "t fast; inputs = { 'b.height' = 'h' }", "l light"),
        passes("h h", "t around; inputs = { 'f.b.height' = 'h' }", "l light"),
    ],
)
def test_variant_gives_way_when_inner_pass_is_wired(doubled, body):
    sketch = doubled(body)
    result = wires(sketch, variants=VARIANTS)
    assert result == wires(sketch)
    known_names = set(result)
    assert all(
        s == "nothing" or s.partition(":")[0] in known_names for w in result.values() for s in w.values()
    )


def test_a_fast_variant_steps_back_for_a_path_that_is_wanted(doubled):
    sketch = doubled(passes("h h", "t around", "l light"))
    assert "t.f" in wires(sketch, variants=VARIANTS) and "t.f.a" not in wires(sketch, variants=VARIANTS)
    assert wires(sketch, variants=VARIANTS, ref="t.f.a") == wires(sketch)
    assert (
        str(substitute_variants(flatten(sketch), VARIANTS, ref="t.f.b:water").ref("t.f.b:water", "s"))
        == "t.f.b:water"
    )
    for expected in ("t.f", "h", "nothing.there"):
        assert "t.f" in wires(sketch, variants=VARIANTS, ref=expected)


@pytest.mark.parametrize(
    ("body", "options", "reason"),
    [
        ("t fast; inputs = { 'b.height' = 'h' }", {}, "something is wired to a pass inside"),
        ("t fast", {"ref": "t.a"}, "a pass inside is read"),
        ("t fast", {"stopped": ("t.b",)}, "it is stopped early"),
        ("t fast", {"refused": ("t",)}, "the plan refuses it"),
        ("t fast", {"kinds": ("draws",)}, "there are no compute shaders here"),
    ],
)
def test_a_fast_variant_that_does_not_run_has_a_reason(doubled, body, options, reason):
    kinds = options.pop("kinds", VARIANTS)
    flat = flatten(doubled(passes("h h", body, "l light")))
    (omission,) = substitute_variants(flat, kinds, **options).shape.omitted
    sentence = f"t: fast.comp is left out, the plain form runs: {reason}"
    assert (str(omission), omission.is_news) == (sentence, False)
    assert substitute_variants(flat, VARIANTS).shape.omitted == () or "ref" not in options


def test_a_fast_variant_with_a_parameter_of_its_own_is_refused(make, doubled):
    path = make.folder.write("fast.comp", '#pragma compute(groups = "1, 1")\nuniform float rize;\n')
    fast = passes("h h", "t fast")
    doubled_text = "[[pass]]\nname='a'\nuse='./h'\n[parameters]\nrise='a.rise'\n"
    make.folder.write("fast.toml", doubled_text)
    make.folder.refused(
        "'rize' is not among the parameters and inputs of ./fast; did you mean 'rise'",
        2,
        file=path.name,
        body=fast,
    )


# Values


def test_leaves_have_the_values_of_their_paths(make):
    sketch = make(passes("height outer", "light light"), **NESTED).with_values(
        {"height.deep.rise": 7, "height.deep.top.rain": 2}
    )
    flat = flatten(sketch)
    assert flat.values == values_of(sketch)
    for leaf in leaves_of(flat.nodes):
        for name, value in flat.values_of(leaf).items():
            assert flat.values[f"{leaf.path}.{name}"] == value
    assert flat.values["height.deep.core.low.rise"] == 7.0


def test_a_slider_changes_values_and_nothing_else(make):
    sketch = make(passes("height outer", "light light"), **NESTED)
    before = flatten(sketch)
    after = flatten(sketch.with_values({"height.deep.rise": 1.25}))
    assert wires(sketch) == wires(sketch.with_values({"height.deep.rise": 1.25}))
    assert after.nodes is before.nodes
    changed = [leaf.path for leaf in after.leaves if not after.has_values_of(before, leaf)]
    assert changed == ["height.deep.core.low"]
    assert flatten(sketch).values == before.values
    assert isinstance(before.nodes[0], Leaf) and hash(before.nodes) == hash(flatten(sketch).nodes)


def test_an_edited_file_is_wired_anew(make):
    first = wires(make(passes("a h", "b h", "light light")))
    second = wires(make(passes("a h", "b h", "light light; inputs = { height = 'a' }")))
    assert (first["light"]["height"], second["light"]["height"]) == ("b:height", "a:height")


@pytest.mark.slow
@pytest.mark.parametrize("variants", [(), ("passes",), VARIANTS], ids=["none", "passes", "all"])
@pytest.mark.parametrize("name", shipped_sketches())
def test_every_shipped_sketch_runs_in_the_order_of_its_wires(name, variants):
    done: set[str] = set()
    for node in substitute_variants(flatten(load(name)), variants).nodes:
        inside = {leaf.path for leaf in leaves_of([node])}
        reads = {s.path for leaf in leaves_of([node]) for _, s in leaf.inputs if isinstance(s, Ref)}
        assert reads - inside <= done
        done |= inside


def test_a_nested_sketch_is_flattened_in_passing():
    # The live window does this for each frame.
    sketch = load()
    substitute_variants(flatten(sketch), VARIANTS)
    made = module.graph_shape, module.substituted_shape
    counts = [GRAPHS.count_of(function) for function in made]
    for i in range(20):
        substitute_variants(flatten(sketch.with_values({"relief": i})), VARIANTS)
    assert [GRAPHS.count_of(function) for function in made] == counts
