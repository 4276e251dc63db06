"""An ISF shader that fails is reduced with its description, its vertex shader and its images."""

from __future__ import annotations

import pytest

from playground.errors import ShaderError
from playground.verify.reduce.case import copied, inline_sketch
from tests.isf_texts import TEXTS, VERTEX, with_mistake

from ..loading import load


@pytest.fixture
def write(tmp_path):
    def written(name, text):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return written


@pytest.mark.parametrize("name", ["inputs", "passes", "persistent", "with_vertex", "tabs"])
def test_what_is_written_fails_in_the_same_way(any_engine, write, name):
    text, _ = with_mistake(TEXTS[name])
    write("a.vs", VERTEX.get(name, "void main() { isf_vertShaderInit(); }\n"))
    case = inline_sketch(load(write("a.fs", text)), frame=(8, 8))
    assert case.passes[0].text.count("not_declared") == 1
    result = {path: write(f"small/{path}", written) for path, written in case.texts().items()}
    assert sorted(result) == ["shader.frag", "shader.vs"]
    with pytest.raises(ShaderError, match="not_declared"):
        any_engine.render(load(result["shader.frag"]), size=(8, 8))


def test_its_images_go_with_it(write):
    photo = write("photo.png", "")
    case = inline_sketch(load(write("a.fs", TEXTS["imported"])), frame=(8, 8))
    assert copied(case.files, case.texts()) == [("photo.png", photo)]
