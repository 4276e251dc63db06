"""A shader's text becomes a new file: its name, its ending, and what is refused."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from playground.errors import PlaygroundError
from playground.sketch.pasted import keep_text

SHADERTOY = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p / iResolution.xy, 0.0, 1.0); }\n"
MAIN = "void main() { gl_FragColor = vec4(1.0); }\n"
KERNEL = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'
COMPUTE = "#version 430\nlayout(local_size_x = 8) in;\nvoid main() {}\n"
EXPORT = """{"Shader": {"info": {"name": "Two hills"}, "renderpass": [{"type": "image", "name": "Image",
  "inputs": [], "outputs": [], "code": "void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }"}]}}
"""
ISF = '/*{"ISFVSN": "2", "INPUTS": []}*/\nvoid main() { gl_FragColor = vec4(1.0); }\n'
VSCODE = f'#iChannel0 "self"\n{SHADERTOY}'
SOUND = "vec2 mainSound(int sample, float time) { return vec2(0.0); }\n"


@pytest.mark.parametrize(
    "text, name",
    [
        (SHADERTOY, "pasted_1.frag"),
        (MAIN, "pasted_1.frag"),
        (KERNEL, "pasted_1.glsl"),
        (COMPUTE, "pasted_1.comp"),
        (EXPORT, "two_hills.json"),
        (ISF, "pasted_1.fs"),
        (VSCODE, "pasted_1.frag"),
        (f"// Waves at night\n{SHADERTOY}", "waves_at_night.frag"),
        (f"// waves.glsl -- Waves at night.\n{KERNEL}", "waves_at_night.glsl"),
        (f"/* Waves\n * by me */\n{MAIN}", "waves.frag"),
        (f"// Created by someone in 2013\n{MAIN}", "pasted_1.frag"),
        (f"// License: MIT\n{MAIN}", "pasted_1.frag"),
        (f"// float old = sin(x);\n{MAIN}", "pasted_1.frag"),
        (f"// ../../etc/passwd\n{MAIN}", "pasted_1.frag"),
        (f"#define A 1 // not a title\n{MAIN}", "pasted_1.frag"),
        (f"// {'long ' * 30}\n{MAIN}", "pasted_1.frag"),
        (f"\ufeff// Waves\r\n{MAIN}", "waves.frag"),
    ],
)
@pytest.mark.room("dialects")
def test_pasted_text_gets_dialect_extension_and_title_name(tmp_path: Path, text: str, name: str) -> None:
    path = keep_text(text, tmp_path)
    assert path == tmp_path / name
    assert path.read_text("utf-8") == text.removeprefix("\ufeff").replace("\r\n", "\n")
    assert [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.room("dialects")
def test_nothing_is_overwritten_and_the_same_text_is_kept_once(tmp_path: Path) -> None:
    first, second = keep_text(MAIN, tmp_path), keep_text(SHADERTOY, tmp_path)
    assert (first.name, second.name) == ("pasted_1.frag", "pasted_2.frag")
    assert keep_text(MAIN, tmp_path) == first and first.read_text("utf-8") == MAIN
    titled = f"// Waves\n{MAIN}"
    (tmp_path / "waves.toml").write_text("format = 1\n", "utf-8")  # use = "./waves" must stay what it is
    third = keep_text(titled, tmp_path)
    assert third.name == "waves_2.frag"
    first.write_text("// mine now\n", "utf-8")
    assert keep_text(MAIN, tmp_path).name == "pasted_3.frag"
    assert first.read_text("utf-8") == "// mine now\n"


@pytest.mark.parametrize(
    "text, part",
    [
        ("", "there is no text"),
        (" \n\t", "there is no text"),
        ("https://example.org/shader", "nothing to run: no main, mainImage or #pragma kernel"),
        ("float twice(float x) { return 2.0 * x; }", "nothing to run"),
        ("// void main() {}", "nothing to run"),
        (SOUND, "which is not drawn"),
        ("\0" + MAIN, "no text"),
        (MAIN + " " * 5_000_000, "larger than 4 MiB"),
    ],
)
def test_what_has_nothing_to_run_is_not_kept(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(PlaygroundError) as raised:
        keep_text(text, tmp_path)
    assert part in str(raised.value) and "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="the superuser writes anywhere")
def test_where_the_folder_is_read_only_the_user_s_own_takes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "read_only"
    folder.mkdir(0o500)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    path = keep_text(MAIN, folder)
    assert path.parent.name == "pasted" and path.is_relative_to(tmp_path / "state")


@pytest.mark.room("dialects")
def test_where_the_folder_is_gone_the_user_s_own_takes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    path = keep_text(MAIN, tmp_path / "gone")
    assert path.is_relative_to(tmp_path / "state") and path.read_text("utf-8") == MAIN
