"""Another tool's file in an old encoding is read: its bytes beyond ASCII are in comments."""

from __future__ import annotations

import pytest

from playground.errors import PlaygroundError
from playground.sketch.load import load

TOY = "// caf\u00e9 \u00a9\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }  // \u00fcber\n"


def test_latin_1_in_comments_is_read_line_by_line(folder):
    path = folder.path / "a.frag"
    path.write_bytes(TOY.encode("latin-1"))
    source = load(path).graph.find("view").technique.source
    assert [line.text for line in source.lines] == TOY.split("\n")


def test_an_include_and_a_vertex_file_are_read_so_too(folder):
    (folder.path / "part.glsl").write_bytes("// \u00e4\nfloat one() { return 1.0; }\n".encode("latin-1"))
    path = folder.path / "a.frag"
    path.write_bytes(
        b'#include "part.glsl"\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(one()); } // \xe4\n'
    )
    assert "one" in load(path).graph.find("view").technique.source.code


@pytest.mark.parametrize(
    "data",
    [
        '#pragma kernel(output = "a:r8")\nfloat kernel(ivec2 t) { return 1.0; } // \u00e4\n'.encode(
            "latin-1"
        ),
        TOY.encode("utf-16"),
        b"\xff\xfe\x00\x01",
    ],
    ids=["kernel", "utf-16", "no text"],
)
def test_a_kernel_of_our_own_and_what_is_no_text_are_refused(folder, data):
    path = folder.path / "a.glsl"
    path.write_bytes(data)
    with pytest.raises(PlaygroundError, match="not UTF-8"):
        load(path)
