"""What no web page can run is refused in a message when it is exported."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.errors import ShaderError
from playground.publish.web.es_lacks import lacking
from playground.publish.web.page_data import page_data

from ...loading import load

TOY = "void mainImage(out vec4 c, in vec2 p) {{ c = vec4({}); }}\n"


@pytest.mark.parametrize(
    ("code", "name"),
    [
        ("vec4 a = textureGather(s, p);", "textureGather()"),
        ("int n = findMSB (5);", "findMSB()"),
        ("double d = 1.0;", "double"),
        ("uniform samplerCubeArray s;", "samplerCubeArray"),
        ("float fma(float a, float b, float c) { return a; } float x = fma(1.0, 2.0, 3.0);", ""),
        ("#define ldexp(a, b) (a)\nfloat x = ldexp(1.0, 2);", ""),
        ("float bitCount = 1.0, doubled = 2.0;", ""),
        ("vec4 a = texture(s, p) + texelFetch(s, ivec2(p), 0);", ""),
    ],
)
def test_what_the_glsl_of_pages_lacks_is_found(code: str, name: str):
    assert lacking(code) == name


def test_a_shader_that_no_page_can_run_is_refused_with_the_name(tmp_path: Path):
    (tmp_path / "toy.frag").write_text(TOY.format("textureGather(iChannel0, p).x"))
    with pytest.raises(ShaderError, match=r"names textureGather\(\), which the GLSL of web pages has not"):
        page_data([load(tmp_path / "toy.frag")])
    (tmp_path / "fine.frag").write_text(TOY.format("texture(iChannel0, p).x"))
    assert page_data([load(tmp_path / "fine.frag")])["sketches"]
