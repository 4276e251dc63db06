"""A shader's text becomes a new file, and opens in the window."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.sketch.pasted import keep_text
from playground.studio.edits.autosave import Autosave, memory_of

from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
SKETCH = (
    'format = 1\nsize = 9\n[[pass]]\nname = "height"\nuse = "./terrain"\n'
    '[view]\nuse = "view/map"\ninputs = { shown = "height" }\n'
)
SHADER = "// Half red\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(0.5, 0.0, 0.0, 1.0); }\n"
BROKEN = "void mainImage(out vec4 c, in vec2 p) { c = vec4(not_declared); }\n"
FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH}


@pytest.fixture
def pasting(bare: Bare, folder: Path) -> Iterator[Bare]:
    """Give the panel with a memory of each sketch, as the window has it."""
    memory = memory_of(folder / "sketch.toml", folder / "state")
    autosave = Autosave(bare.session, memory, now=lambda: bare.time)
    bare.bench.actions.opens = autosave.open  # type: ignore[assignment]
    bare.autosave = autosave  # type: ignore[attr-defined]
    bare.run_frames(2)
    autosave.look((900, 600))
    imgui.get_platform_io().platform_get_clipboard_text_fn = lambda _: bare.clipboard
    yield bare
    autosave.close()


def paste(bare: Bare, text: str) -> None:
    bare.clipboard = text
    bare.key(imgui.Key.mod_ctrl, imgui.Key.v)
    bare.run_frames(3)
    bare.autosave.look((900, 600))  # type: ignore[attr-defined]


def said(bare: Bare) -> str:
    return "\n".join(notice.text for notice in bare.bench.notices.items)


def level(bare: Bare) -> object:
    return dict(bare.session.sketch.overrides).get("height.level")


@pytest.mark.room("dialects")
def test_a_text_on_the_clipboard_opens_as_a_new_file(pasting: Bare, folder: Path) -> None:
    paste(pasting, SHADER)
    assert pasting.session.path == folder / "half_red.frag" and pasting.session.error is None
    assert (folder / "half_red.frag").read_text("utf-8") == SHADER
    assert pasting.session.read() is not None
    frame = pasting.session.read()
    assert frame is not None and tuple(frame.array[0, 0][:3]) == (128, 0, 0)
    assert f"pasted as half_red.frag in {folder}" in said(pasting)


@pytest.mark.room("dialects")
def test_the_sketch_before_comes_back_with_its_edits(pasting: Bare, folder: Path) -> None:
    pasting.session.drafts.set("height.level", 0.25)
    pasting.run_frames(2)
    paste(pasting, SHADER)
    assert level(pasting) is None
    pasting.key(imgui.Key.backspace)
    pasting.run_frames(3)
    assert pasting.session.path == folder / "sketch.toml" and level(pasting) == 0.25
    pasting.autosave.look((900, 600))  # type: ignore[attr-defined]
    pasting.key(imgui.Key.backspace)
    assert "no other sketch was opened before this one" in said(pasting)
    assert pasting.session.path == folder / "sketch.toml"
    pasting.key(imgui.Key.mod_shift, imgui.Key.backspace)
    pasting.run_frames(3)
    assert pasting.session.path == folder / "half_red.frag"


@pytest.mark.room("dialects")
def test_a_text_with_a_mistake_is_kept_and_the_picture_stays(pasting: Bare, folder: Path) -> None:
    paste(pasting, BROKEN)
    assert "not_declared" in str(pasting.session.error)
    assert pasting.session.shown is not None and pasting.session.drafts.shown_path.name == "sketch.toml"
    assert (folder / "pasted_1.frag").read_text("utf-8") == BROKEN
    pasting.key(imgui.Key.backspace)
    pasting.run_frames(3)
    assert pasting.session.error is None and pasting.session.path == folder / "sketch.toml"


@pytest.mark.parametrize("text", ["", "just some words", "float twice(float x) { return 2.0 * x; }"])
def test_a_text_with_nothing_to_run_opens_nothing(pasting: Bare, folder: Path, text: str) -> None:
    files = sorted(folder.iterdir())
    paste(pasting, text)
    assert pasting.session.path == folder / "sketch.toml" and sorted(folder.iterdir()) == files
    assert len(pasting.bench.notices.items) == 1 and "the clipboard: " in said(pasting)


def test_a_text_pasted_into_a_field_stays_there(pasting: Bare, folder: Path) -> None:
    pasting.key(imgui.Key.slash)
    pasting.bench.interface.search()
    pasting.run_frames(3)
    assert imgui.get_io().want_text_input
    paste(pasting, SHADER)
    assert pasting.session.path == folder / "sketch.toml"
    assert not (folder / "half_red.frag").exists()


@pytest.mark.room("dialects")
def test_the_same_text_twice_is_one_file(any_engine: Engine, pasting: Bare, folder: Path) -> None:
    paste(pasting, SHADER)
    paste(pasting, SHADER)
    assert sorted(path.name for path in folder.glob("*.frag")) == ["half_red.frag"]
    assert pasting.session.path == folder / "half_red.frag" and pasting.session.error is None


# ── pasted ────────────────────────────────────────────────────────────────────


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
