"""A stranger's shader reads nothing outside its folder, whatever leads there and whatever the file is for."""

from __future__ import annotations

import sys

import pytest

from playground.errors import PlaygroundError, ShaderError, SketchError
from playground.sketch.load import load

from ..foreign_cases import TEXTS

ISF = '/*{"ISFVSN": "2", "INPUTS": []}*/\nvoid main() { gl_FragColor = vec4(1.0); }\n'
LEVEL = "float level() { return 0.25; }\n"
READS_ABOVE = '#include "{}"\nvoid main() {{ gl_FragColor = vec4(level()); }}\n'
IMAGE, PLAIN = TEXTS["image"], TEXTS["plain"]
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


def test_image_linked_outside_folder_is_not_used(folder, secret, opened):
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


# ── the root that a user names ───────────────────────────────────────────────


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", ["../lib/m.glsl", "lib/m.glsl"])
def test_an_include_above_names_the_way_to_open_it(tmp_path, monkeypatch, name):
    write(tmp_path / "all/lib/m.glsl", LEVEL)
    path = write(tmp_path / "all/a/x.frag", READS_ABOVE.format(name))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ShaderError, match=r"--root all opens it, .* empty sketch.toml in all") as caught:
        load(path)
    assert caught.value.diagnostics[0].line == 1
    monkeypatch.setenv("PLAYGROUND_ROOT", "all")
    assert "level" in load(path).graph.find("view").technique.source.names
    write(tmp_path / "out.glsl", LEVEL)
    with pytest.raises(ShaderError, match="lies outside") as caught:
        load(write(tmp_path / "all/a/y.frag", READS_ABOVE.format("../../out.glsl")))
    assert "--root" in str(caught.value)
    monkeypatch.setenv("PLAYGROUND_ROOT", "elsewhere")
    with pytest.raises(ShaderError, match="lies outside"):
        load(path)
    monkeypatch.delenv("PLAYGROUND_ROOT")
    write(tmp_path / "all/sketch.toml", "")
    assert load(path).folder == str(tmp_path / "all")


def test_a_link_out_of_the_named_root_stays_closed(tmp_path, monkeypatch):
    write(tmp_path / "secret.glsl", LEVEL)
    path = write(tmp_path / "all/x.frag", READS_ABOVE.format("m.glsl"))
    (tmp_path / "all/m.glsl").symlink_to(tmp_path / "secret.glsl")
    monkeypatch.setenv("PLAYGROUND_ROOT", str(tmp_path / "all"))
    with pytest.raises(ShaderError, match="lies outside"):
        load(path)


def test_a_sketch_uses_a_shader_above_in_the_named_root(tmp_path, monkeypatch):
    write(tmp_path / "all/t.frag", "void mainImage(out vec4 c, in vec2 p) { c = vec4(0.5); }\n")
    path = write(tmp_path / "all/a/s.toml", 'format = 1\nsize = 65\n[view]\nuse = "./../t"\n')
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SketchError, match="--root all opens it"):
        load(path)
    monkeypatch.setenv("PLAYGROUND_ROOT", "all")
    assert load(path).graph.find("view").use == "./../t"
