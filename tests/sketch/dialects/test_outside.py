"""A stranger's shader reads nothing outside its folder, whatever leads there and whatever the file is for."""

from __future__ import annotations

import sys

import pytest

from playground.errors import PlaygroundError
from playground.sketch.load import load
from tests.toy_texts import IMAGE, PLAIN

ISF = '/*{"ISFVSN": "2", "INPUTS": []}*/\nvoid main() { gl_FragColor = vec4(1.0); }\n'
SECRET = "not_for_strangers\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n"
_opened: list[str] | None = None


def _note(event, args):
    if _opened is not None and event == "open":
        _opened.append(str(args[0]))


@pytest.fixture(scope="module", autouse=True)
def audited():
    sys.addaudithook(_note)  # there is no way to take it out again


@pytest.fixture
def secret(tmp_path):
    path = tmp_path / "secret.glsl"
    path.write_text(SECRET)
    return path


@pytest.fixture
def opened(secret):
    global _opened
    _opened = []
    yield _opened
    _opened = None


def test_a_vertex_file_that_leads_out_of_the_folder_is_not_read(folder, secret, opened):
    path = folder.write("a.fs", ISF)
    (folder.path / "a.vs").symlink_to(secret)
    with pytest.raises(PlaygroundError) as caught:
        load(path)
    said = str(caught.value)
    assert "a.vs" in said and "outside" in said and "not_for_strangers" not in said
    assert not [name for name in opened if name.endswith("secret.glsl")]


@pytest.mark.parametrize("name", ["Buffer A.glsl", "Common.glsl", "Cube A.frag"])
def test_a_pass_of_a_folder_that_leads_out_of_it_is_not_read(folder, secret, opened, name):
    folder.write("Image.glsl", IMAGE)
    folder.write("Buffer B.glsl", PLAIN)
    (folder.path / name).unlink(missing_ok=True)
    (folder.path / name).symlink_to(secret)
    with pytest.raises(PlaygroundError) as caught:
        load(folder.path)
    said = str(caught.value)
    assert name in said and "outside" in said and "not_for_strangers" not in said
    assert not [name for name in opened if name.endswith("secret.glsl")]


def test_an_image_that_leads_out_of_its_folder_is_none_of_the_folder_s(folder, secret, opened):
    folder.write("Buffer A.glsl", PLAIN)
    (folder.path / "Image.glsl").symlink_to(secret)
    with pytest.raises(PlaygroundError, match="no Image of Shadertoy of its own"):
        load(folder.path)
    assert not [name for name in opened if name.endswith("secret.glsl")]


def test_a_pass_that_leads_elsewhere_in_the_folder_is_read(folder):
    folder.write("Image.glsl", IMAGE)
    folder.write("passes/first.glsl", PLAIN)
    (folder.path / "Buffer A.glsl").symlink_to(folder.path / "passes/first.glsl")
    assert [spec.name for spec in load(folder.path).graph.find("view").technique.passes] == [
        "buffer_a",
        "image",
    ]
