"""Shaders of one file become passes: what feeds them, what they share, what is of the frame before."""

from __future__ import annotations

import pytest

from playground.dialects import shadertoy
from playground.dialects.es import rewritten
from playground.dialects.foreign import Shader, ShaderChannel, graph_of_shaders
from playground.errors import ShaderError
from playground.paths import GLSL
from playground.shader.source import read_source_and_origin
from playground.sketch.techniques import Techniques
from playground.sketch.wiring import check_graph

TOY = "uniform {} level;\nvoid mainImage(out vec4 c, in vec2 p) {{\n    c = level * texture({}, p);\n}}\n"
PLAIN = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p, iTime, 1.0); }\n"


@pytest.fixture
def graph(folder):
    def made(*shaders):
        result = []
        for number, (name, text, more) in enumerate(shaders):
            source = read_source_and_origin(
                folder.write(f"{number}.frag", text), (folder.path,), {}, foreign=True
            )[0]
            result.append(Shader(name, rewritten(source), shadertoy.RULES, **more))
        graph = graph_of_shaders("toy", result, Techniques().read, GLSL)
        check_graph(graph)
        check_graph(graph.passes[-1].technique)
        return graph

    return made


def reads(target):
    return {"channels": {"iChannel0": ShaderChannel(target=target)}}


def test_a_pass_reads_what_an_earlier_one_writes_in_this_frame(graph):
    result = graph(("a", PLAIN, {"target": "A"}), ("image", TOY.format("float", "iChannel0"), reads("A")))
    view = result.passes[-1]
    assert [spec.name for spec in result.passes] == ["view"]
    assert dict(view.technique.passes[1].inputs) == {"iChannel0": "a"}
    assert (view.repeat, view.feedback) == ("", ())


@pytest.mark.parametrize("keeps", [True, False])
def test_kept_buffer_written_later_is_read_from_previous_frame(graph, keeps):
    result = graph(
        ("a", TOY.format("float", "iChannel0"), {"target": "A", "keeps": keeps, **reads("A")}),
        ("image", TOY.format("float", "iChannel0"), reads("A")),
    )
    view = result.passes[-1]
    assert view.repeat == ("frames" if keeps else "")
    assert view.feedback == ((("before_A", "A"),) if keeps else ())
    assert [e.targets for e in view.technique.inputs] == ([("a.iChannel0",)] if keeps else [])
    assert dict(view.technique.outputs)["frame"] == "image:frame"
    assert view.technique.passes[0].technique.inputs[0].fallback == "zero"


def test_of_two_that_write_one_target_the_latest_before_counts(graph):
    text = TOY.format("float", "iChannel0")
    result = graph(
        ("a", PLAIN, {"target": "A", "keeps": True}),
        ("b", text, {"target": "A", "keeps": True, **reads("A")}),
        ("image", text, reads("A")),
    )
    wires = [dict(spec.inputs) for spec in result.passes[-1].technique.passes]
    assert wires == [{}, {"iChannel0": "a"}, {"iChannel0": "b"}]
    assert not result.passes[-1].repeat


def test_parameters_of_one_name_are_one_and_of_two_types_two(graph):
    same = graph(
        ("a", TOY.format("float", "iChannel0"), {"target": "A"}),
        ("image", TOY.format("float", "iChannel0"), {}),
    )
    assert [e.name for e in same.parameters] == ["level"]
    assert same.passes[-1].technique.parameters[0].targets == ("a.level", "image.level")
    other = graph(
        ("a", TOY.format("float", "iChannel0"), {"target": "A"}),
        ("image", TOY.format("vec4", "iChannel0"), {}),
    )
    assert [e.name for e in other.parameters] == ["a_level", "image_level"]


def test_channels_of_equal_source_share_one_input(graph):
    text = TOY.format("float", "iChannel0")
    alike = graph(("a", text, {"target": "A"}), ("image", text, {}))
    assert [spec.name for spec in alike.passes] == ["iChannel0", "view"]
    assert alike.passes[-1].technique.inputs[0].targets == ("a.iChannel0", "image.iChannel0")
    picture = ShaderChannel(use="foreign/picture", values=(("number", 3),))
    unlike = graph(("a", text, {"target": "A"}), ("image", text, {"channels": {"iChannel0": picture}}))
    assert [(spec.name, spec.use) for spec in unlike.passes[:-1]] == [
        ("a_iChannel0", "foreign/noise"),
        ("image_iChannel0", "foreign/picture"),
    ]


def test_a_target_that_no_pass_writes_is_named_at_its_line(graph):
    with pytest.raises(
        ShaderError, match="iChannel0 reads 'B', which no pass writes; there are: A"
    ) as caught:
        graph(("a", PLAIN, {"target": "A"}), ("image", TOY.format("float", "iChannel0"), reads("B")))
    assert caught.value.diagnostics[0].line == 3
