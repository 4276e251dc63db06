"""Libraries that the user named once: shaders include from them by name, and from nowhere else."""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

from playground import cli
from playground.errors import DataError, ParameterError, ShaderError
from playground.publish.pack import pack
from playground.shader import libraries as named
from playground.sketch.find import read_pack
from playground.sketch.load import load
from playground.sketch.replace_technique import with_texts

pytestmark = pytest.mark.room("dialects")

TOP = """#include "stones/colour/red.glsl"
uniform vec2 u_resolution;
void main() { gl_FragColor = vec4(red(gl_FragCoord.x / u_resolution.x), 0.0, 0.0, 1.0); }
"""


@pytest.fixture(autouse=True)
def state(tmp_path, monkeypatch):
    """Give what is remembered a folder of its own."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "state"))
    monkeypatch.delenv(named.VARIABLE, raising=False)
    return tmp_path


@pytest.fixture
def write(tmp_path):
    def write_(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return write_


@pytest.fixture
def stones(write, tmp_path):
    """Return a small library: a file that includes another by its place, and one by the library's name."""
    write(
        "far/stones/maths/half.glsl",
        "#ifndef HALF\n#define HALF\nfloat half_of(float a) { return a * 0.5; }\n#endif\n",
    )
    write("far/stones/maths/twice.glsl", "float twice(float a) { return a * 2.0; }\n")
    inner = (
        '#include "../maths/half.glsl"\n#include "stones/maths/twice.glsl"\n#include "../maths/half.glsl"\n'
    )
    write("far/stones/colour/red.glsl", f"{inner}float red(float a) {{ return twice(half_of(a)); }}\n")
    return tmp_path / "far/stones"


def refused(path):
    with pytest.raises(ShaderError) as caught:
        load(path)
    (result,) = caught.value.diagnostics
    assert "\n" not in result.message
    return result


def test_an_include_is_found_once_its_library_is_named(write, stones, any_engine):
    path = write("own/a.frag", TOP)
    missing = refused(path)
    assert missing.line == 1 and missing.message == (
        "no file 'stones/colour/red.glsl' to include; if stones is a library on this computer, name its "
        "folder once: playground library add stones FOLDER"
    )
    assert named.add_library("stones", stones) == stones
    result = load(path)
    files = [Path(name).name for name in result.graph.find("view").technique.files]
    assert files == ["a.frag", "red.glsl", "half.glsl", "twice.glsl"]
    picture = any_engine.render(result, size=(4, 2)).array
    assert picture[0, :, 0].tolist() == [32, 96, 159, 223]  # (x + 1/2) / 4, twice a half


def test_it_is_remembered_and_forgotten(write, stones):
    path = write("own/a.frag", TOP)
    named.add_library("stones", stones)
    assert json.loads(named.libraries_file().read_text())["libraries"] == {"stones": str(stones)}
    load(path)
    named.remove_library("stones")
    assert "name its folder" in refused(path).message
    with pytest.raises(ParameterError, match="no library 'stone' was named"):
        named.remove_library("stone")


def test_another_folder_for_a_name_is_read_at_once(write, stones, any_engine):
    path = write("own/a.frag", TOP)
    named.add_library("stones", stones)
    assert any_engine.render(load(path), size=(4, 2)).array[0, 3, 0] == 223
    write("other/colour/red.glsl", "float red(float a) { return 0.2; }\n")
    named.add_library("stones", stones.parent.parent / "other")
    assert any_engine.render(load(path), size=(4, 2)).array[0, 3, 0] == 51


def test_environment_libraries_take_precedence(write, stones, monkeypatch):
    write("other/colour/red.glsl", "float red(float a) { return 0.2; }\n")
    named.add_library("stones", stones.parent.parent / "other")
    monkeypatch.setenv(named.VARIABLE, f"stones={stones}{os.pathsep}more = {stones}")
    assert named.libraries() == {"stones": stones, "more": stones}
    assert any(name.endswith("twice.glsl") for name in load(write("own/a.frag", TOP)).files)
    monkeypatch.setenv(named.VARIABLE, "stones")
    with pytest.raises(ParameterError, match="expected NAME=FOLDER, found 'stones'"):
        load(write("own/a.frag", TOP))


def test_the_sketch_s_own_folder_comes_first(write, stones):
    named.add_library("stones", stones)
    write("own/stones/colour/red.glsl", "float red(float a) { return 0.2; }\n")
    assert not any(name.startswith(str(stones)) for name in load(write("own/a.frag", TOP)).files)


def test_a_kernel_of_our_own_includes_from_it(write, stones, any_engine):
    text = '#include "stones/colour/red.glsl"\n#pragma kernel(output = "height:r32f")\n'
    path = write("own/k.glsl", f"{text}float kernel(ivec2 texel) {{ return red(0.25); }}\n")
    named.add_library("stones", stones)
    assert (any_engine.read(load(path), "height") == 0.25).all()


def test_nothing_outside_is_read(write, stones, tmp_path):
    named.add_library("stones", stones)
    write("far/secret.glsl", "float secret;\n")
    write("own/secret.glsl", "float secret;\n")
    write("far/hidden.glsl", "float hidden;\n")
    outside = 'include "stones/../hidden.glsl"'
    assert "lies outside" in refused(write("own/a.frag", f"#{outside}\nvoid main() {{}}\n")).message
    write("far/stones/leak.glsl", '#include "../secret.glsl"\n')
    leak = refused(write("own/b.frag", '#include "stones/leak.glsl"\nvoid main() {}\n'))
    assert (leak.file.endswith("stones/leak.glsl"), leak.line) == (True, 1) and "lies outside" in leak.message
    write("far/stones/back.glsl", '#include "secret.glsl"\n')  # the including sketch's is not the library's
    back = refused(write("own/c.frag", '#include "stones/back.glsl"\nvoid main() {}\n'))
    assert "no file 'secret.glsl'" in back.message
    (stones / "link.glsl").symlink_to(tmp_path / "far/secret.glsl")
    link = refused(write("own/d.frag", '#include "stones/link.glsl"\nvoid main() {}\n'))
    assert "lies outside the library stones" in link.message


def test_a_mistake_in_a_library_is_at_its_own_line(write, stones, any_engine):
    write("far/stones/maths/twice.glsl", "float twice(float a) {\n    return not_declared;\n}\n")
    named.add_library("stones", stones)
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(write("own/a.frag", TOP)), size=(4, 2))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.file.endswith("maths/twice.glsl"), diagnostic.line, len(diagnostic.chain)) == (
        True,
        2,
        2,
    )


def test_what_is_wrong_is_one_sentence(write, stones, tmp_path):
    named.add_library("stones", stones)
    typo = refused(write("own/a.frag", '\n#include "stones/colour/rad.glsl"\nvoid main() {}\n'))
    assert (typo.line, "in the library stones" in typo.message) == (2, True)
    assert typo.message.endswith("did you mean 'colour/red.glsl'?")
    with pytest.raises(DataError, match="no such folder"):
        named.add_library("x", tmp_path / "nothing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(DataError, match="holds no shader"):
        named.add_library("x", tmp_path / "empty")
    with pytest.raises(DataError, match="holds a folder 'stones'; name that one"):
        named.add_library("stones", stones.parent)
    with pytest.raises(ParameterError, match=r"'\.\./x' is no name"):
        named.add_library("../x", stones)
    stones.rename(tmp_path / "gone")
    assert "which is gone" in refused(write("own/a.frag", TOP)).message
    named.libraries_file().write_text("[]")
    with pytest.raises(DataError, match="does not list libraries"):
        load(write("own/a.frag", TOP))


def test_sketch_without_includes_ignores_damaged_libraries_file(write):
    named.libraries_file().parent.mkdir(parents=True)
    named.libraries_file().write_text("damaged")
    load(write("own/a.frag", "void main() { gl_FragColor = vec4(1.0); }\n"))


def test_a_window_sees_a_library_that_is_named_meanwhile(write):
    from playground.allowed_files import noting_places

    path = write("own/a.frag", TOP)
    with noting_places() as places, pytest.raises(ShaderError):
        load(path)
    assert places[named.libraries_file()] is None


def test_an_edited_text_includes_from_it(write, stones):
    named.add_library("stones", stones)
    path = write("own/a.frag", TOP.replace("#include", "// #include").replace("red(", "sin("))
    changed = with_texts(load(path), {str(path): TOP})
    assert any(name.endswith("half.glsl") for name in changed.files)


def test_a_pack_leaves_it_out_and_says_so(write, stones, tmp_path, capsys):
    named.add_library("stones", stones)
    path = write("own/a.frag", TOP)
    assert cli.main(["pack", str(path), "-o", str(tmp_path / "a.zip")]) == 0
    said = capsys.readouterr().err
    assert "without 3 files of the library stones, whose licence may forbid to pass it on" in said
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert archive.namelist() == ["a/a.frag", "pack.json"]
    assert read_pack(tmp_path / "a.zip").manifest.libraries == ("stones",)
    assert any(name.endswith("half.glsl") for name in load(tmp_path / "a.zip").files)
    named.remove_library("stones")
    assert "name its folder once" in refused(tmp_path / "a.zip").message
    plain = load(write("own/b.frag", "void main() { gl_FragColor = vec4(1.0); }\n"))
    with zipfile.ZipFile(pack(plain, tmp_path / "b.zip")) as archive:
        assert "libraries" not in json.loads(archive.read("pack.json"))


def test_the_commands(stones, capsys):
    assert cli.main(["library", "list"]) == 0
    assert "playground library add NAME FOLDER" in capsys.readouterr().err
    assert cli.main(["library", "add", "stones", str(stones)]) == 0
    assert capsys.readouterr().out == f"{stones}\n"
    assert cli.main(["library", "list"]) == 0
    assert capsys.readouterr().out == f"stones\t{stones}\t\n"
    assert cli.main(["library", "list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"stones": str(stones)}
    assert cli.main(["library", "remove", "stones"]) == 0
    assert cli.main(["library", "remove", "stones"]) == 2
    assert "no library 'stones' was named" in capsys.readouterr().err


def test_passes_of_one_text_include_from_it_once_for_all(write, stones, any_engine):
    sampler = "#ifndef STONE_LOOK\n#if __VERSION__ >= 300\n#define STONE_LOOK(T, P) texture(T, P)\n#else\n"
    write("far/stones/look.glsl", f"{sampler}#define STONE_LOOK(T, P) texture2D(T, P)\n#endif\n#endif\n")
    blur = '#include "look.glsl"\n#ifndef FNC_BLUR\n#define FNC_BLUR\nvec4 blur(sampler2D t, vec2 p) {\n'
    blur += "    return (STONE_LOOK(t, p) + STONE_LOOK(t,\n        p + 0.25)) * 0.5;\n}\n#endif\n"
    write("far/stones/blur.glsl", blur)
    text = (
        '#include "stones/blur.glsl"\nuniform vec2 u_resolution;\nuniform sampler2D u_buffer0, u_buffer1;\n'
    )
    text += (
        '#include "stones/colour/red.glsl"\nvoid main() {\n    vec2 st = gl_FragCoord.xy / u_resolution;\n'
    )
    text += "#if defined(BUFFER_0)\n    gl_FragColor = vec4(red(st.x));\n#elif defined(BUFFER_1)\n"
    text += (
        "    gl_FragColor = blur(u_buffer0, st);\n#else\n    gl_FragColor = blur(u_buffer1, st);\n#endif\n}\n"
    )
    named.add_library("stones", stones)
    path = write("own/a.frag", text)
    picture = any_engine.render(load(path), size=(4, 4)).array
    # A quarter of the picture is a texel: each blur is the mean of two neighbours, around the edge.
    once = (np.arange(4) + 0.5) / 4
    for _ in range(2):
        once = (once + np.roll(once, -1)) / 2
    np.testing.assert_allclose(picture[0, :, 0], once * 255, atol=1)
    write("far/stones/blur.glsl", blur.replace("* 0.5", "* not_declared"))
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(path), size=(4, 4))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.file.endswith("stones/blur.glsl"), diagnostic.line, len(diagnostic.chain)) == (
        True,
        5,
        1,
    )
