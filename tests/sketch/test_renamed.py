"""Parameters and choices that were renamed: files and people that use the former name get the present one."""

from __future__ import annotations

import pytest

from playground.errors import ParameterError
from playground.sketch.assign import values_of
from playground.sketch.keyframes import Keyframe
from playground.sketch.load import load
from playground.sketch.replace_technique import with_technique
from playground.sketch.save import save, save_keyframes, save_preset
from playground.sketch.warnings import former_names_used

from .conftest import TAIL

TERRAIN = """\
#pragma kernel(output = "height:r32f")
uniform float step_length = 1.0;  //! slider(0, 4) was("stride", "pace") How long a step is
uniform int seams = 0;            //! menu("left", "repaired") was("mended: repaired") What is done
float kernel(ivec2 texel) { return step_length * float(seams); }
"""
TWO = """\
[[pass]]
name = "inner"
use = "./terrain"
set = { stride = 3.0 }
[parameters]
step_length = "inner.stride"
"""
BODY = """
[[pass]]
name = "height"
use = "./terrain"
set = { stride = 2.0, seams = "mended" }  # as it was
"""
MORE = """
[[preset]]
name = "long"
set = { "height.stride" = 4.0 }

[[shot]]
name = "far"
[shot.set]
height.pace = 3.5  # long

[[keyframe]]
time = 0.0
set = { "height.stride" = 1.0 }
"""


@pytest.fixture
def renamed(folder):
    """Give a folder whose terrain has renamed parameters."""
    folder.write("terrain.glsl", TERRAIN)
    return folder


def said(sketch):
    return [(warning.line, warning.message) for warning in former_names_used(sketch)]


def test_every_table_of_a_sketch_may_use_the_former_name(renamed):
    head = 'format = 1\nmain = ["height.stride"]\n'
    sketch = renamed.sketch(head=head, body=BODY, tail=TAIL + MORE)
    assert values_of(sketch)["height.step_length"] == 2.0 and values_of(sketch)["height.seams"] == 1
    assert sketch.main == ("height.step_length",)
    assert dict(sketch.presets[0].values) == {"height.step_length": 4.0}
    assert dict(sketch.shot("far").values) == {"height.step_length": 3.5}
    assert dict(sketch.keyframes[0].values) == {"height.step_length": 1.0}
    now = "is called 'height.step_length' now; the former name is still read"
    assert said(sketch) == [
        (7, "pass 'height': 'stride' is called 'step_length' now; the former name is still read"),
        (7, "pass 'height': seams = 'mended' is called 'repaired' now; the former name is still read"),
        (2, f"main: 'height.stride' {now}"),
        (13, f"preset 'long': 'height.stride' {now}"),
        (18, f"shot 'far': 'height.pace' {now}"),
        (22, f"keyframe at 0 s: 'height.stride' {now}"),
    ]


def test_python_and_the_command_line_may_use_it(renamed):
    sketch = renamed.sketch()
    found = sketch.with_values({"height.stride": "2.5"})
    assert found.overrides == (("height.step_length", 2.5),)
    assert found == sketch.with_values({"height.step_length": 2.5})
    assert [message for _, message in said(found)] == [
        "'height.stride' is called 'height.step_length' now; the former name is still read"
    ]
    assert said(sketch.with_values({"height.step_length": 2.5, "height.seams": "repaired"})) == []


def test_both_names_at_once_are_refused(renamed):
    both = "'stride' is the former name of 'step_length': set one of them, not both"
    for values in ("stride = 1.0, step_length = 2.0", "step_length = 2.0, stride = 1.0"):
        renamed.refused(both, line=5, body=BODY.replace("stride = 2.0", values).lstrip("\n"))
    with pytest.raises(ParameterError, match=r"'height\.pace' is the former name of 'height\.step_length'"):
        renamed.sketch().with_values({"height.pace": 1, "height.step_length": 2})


def test_a_technique_of_several_passes_may_use_it_and_has_it_itself(renamed):
    renamed.write("two.toml", TWO)
    sketch = renamed.sketch(body='[[pass]]\nname = "height"\nuse = "./two"\nset = { pace = 2.0 }\n')
    assert values_of(sketch) == {"height.inner.step_length": 2.0, "height.inner.seams": 0}
    inner = sketch.with_values({"height.inner.stride": 0.5})
    assert inner.overrides == (("height.inner.step_length", 0.5),)
    found = [(w.file.rpartition("/")[2], w.line, w.message) for w in former_names_used(sketch)]
    now = "is called '{}' now; the former name is still read"
    assert found == [
        ("s.toml", 5, f"pass 'height': 'pace' {now.format('step_length')}"),
        ("two.toml", 4, f"pass 'inner': 'stride' {now.format('step_length')}"),
        ("two.toml", 6, f"step_length: 'inner.stride' {now.format('inner.step_length')}"),
    ]
    # A name of the technique's own is no former one.
    renamed.write("two.toml", TWO.replace('step_length = "inner.stride"', 'stride = "inner.step_length"'))
    assert said(
        renamed.sketch(body='[[pass]]\nname = "height"\nuse = "./two"\nset = { stride = 2.0 }\n')
    ) == [(4, "pass 'inner': 'stride' is called 'step_length' now; the former name is still read")]


def test_saving_writes_the_present_names_and_leaves_the_rest(renamed):
    head = "format = 1\nmain = [\n    \"height.stride\",  # as it was\n    'height.seams',\n]\n"
    file = renamed.sketch(head=head, body=BODY, tail=TAIL + MORE)
    path = renamed.path / "s.toml"
    before = path.read_text(encoding="utf-8")
    save(file, file.with_values({"height.stride": 1.5}))
    after = path.read_text(encoding="utf-8")
    wanted = before.replace("stride = 2.0", "step_length = 1.5").replace(
        "height.stride", "height.step_length"
    )
    assert after == wanted.replace("height.pace", "height.step_length")
    # The choice's former name stays until that parameter is set.
    assert [message for _, message in said(load(path))] == [
        "pass 'height': seams = 'mended' is called 'repaired' now; the former name is still read"
    ]
    save(load(path), load(path).with_values({"height.seams": "repaired"}))
    assert said(load(path)) == []


def test_presets_and_keyframes_are_saved_by_the_present_name(renamed):
    path = renamed.path / "s.toml"
    file = renamed.sketch(tail=TAIL + MORE)
    save_preset(file, "long", {"height.step_length": 2.0})
    save_keyframes(load(path), [Keyframe(0.0, values=(("height.step_length", 0.5),))])
    text = path.read_text(encoding="utf-8")
    assert "stride" not in text and "pace" not in text
    assert dict(load(path).presets[0].values) == {"height.step_length": 2.0}
    assert dict(load(path).keyframes[0].values) == {"height.step_length": 0.5}


def test_a_technique_that_was_chosen_takes_values_by_their_former_names(renamed):
    renamed.write("other.glsl", TERRAIN.replace('was("stride", "pace")', "").replace("step_length", "stride"))
    sketch = renamed.sketch(body=BODY.replace("./terrain", "./other"))
    assert dict(with_technique(sketch, "height", "./terrain").graph.passes[0].values)["step_length"] == 2.0
    head = 'format = 1\nmain = ["height.stride"]\n'
    about = renamed.sketch(head=head, body=BODY.replace("./terrain", "./other"))
    assert with_technique(about, "height", "./terrain").main == ("height.step_length",)


def test_an_input_has_no_former_name(renamed):
    line = 'uniform sampler2D ground;  //! input was("soil")\n'
    renamed.write("terrain.glsl", TERRAIN.replace("float kernel", f"{line}float kernel"))
    renamed.refused("'ground' is an input; was is for a parameter", 4, "terrain.glsl")


@pytest.mark.parametrize(
    ("annotation", "words"),
    [
        ("slider(0, 4) was()", "was of 'step_length': expected its former name, as was(\"stride\")"),
        ('slider(0, 4) was("a stride")', "expected its former name"),
        ('slider(0, 4) was("seams")', "was of 'step_length': 'seams' is the name of 'seams'"),
        ('slider(0, 4) was("old") \n//! was("old")', "'was' appears twice"),
        ('slider(0, 4) was("a: b")', "was of 'step_length': no choice 'b'"),
    ],
)
def test_a_former_name_that_cannot_be_is_refused(renamed, annotation, words):
    renamed.write("terrain.glsl", TERRAIN.replace('slider(0, 4) was("stride", "pace")', annotation))
    renamed.refused(words, file="terrain.glsl")


def test_two_parameters_have_not_the_same_former_name(renamed):
    renamed.write("terrain.glsl", TERRAIN.replace('"mended: repaired"', '"mended: repaired", "pace"'))
    renamed.refused("was of 'seams': 'pace' is the name of 'step_length'", 3, "terrain.glsl")
    renamed.write("terrain.glsl", TERRAIN.replace('"mended: repaired"', '"left: repaired"'))
    renamed.refused("was of 'seams': 'left' is one of its choices still", 3, "terrain.glsl")
