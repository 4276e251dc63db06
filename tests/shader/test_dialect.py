"""Without a room that reads other tools' shaders: our own kernels and plain shaders, and nothing else."""

from __future__ import annotations

import pytest

from playground.errors import ParameterError
from playground.shader.dialect import Dialects, check_name

KERNEL = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'
PLAIN = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }\n"
TOY = "void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (KERNEL, "own"),
        (PLAIN, "own"),
        (TOY, ""),
        ("// #pragma kernel\n", ""),
        ("void main() { gl_FragColor = vec4(1.0); }\n", ""),
        ("#version 330\nfloat twice(float x) { return 2.0 * x; }\n", ""),
    ],
    ids=["kernel", "plain", "toy", "comment", "old", "library"],
)
def test_without_a_room_only_our_own_texts_have_a_name(text, name):
    assert Dialects().name_of(text) == name


def test_without_a_room_a_json_is_no_shader(tmp_path):
    path = tmp_path / "a.json"
    path.write_text('{"renderpass": []}', encoding="utf-8")
    alone = Dialects()
    assert not alone.endings and not alone.is_export(path)
    assert alone.image_of(tmp_path) is None and not alone.is_inside(path)
    assert alone.read(path, "a", tmp_path, lambda use, folder, root: pytest.fail(use)) is None


def test_a_dialect_that_is_none_is_named_with_those_there_are():
    assert check_name("") == "" and check_name("own") == "own"
    with pytest.raises(ParameterError, match="--dialect nothing: no such dialect"):
        check_name("nothing")
