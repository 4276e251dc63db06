"""Which folder a technique opened alone may read from, and where links lead: one rule for all callers."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import pytest

from playground.errors import ShaderError
from playground.paths import GLSL
from playground.sketch.allowed_files import noting_places, real, root_of
from playground.sketch.load import load

KERNEL = """#include "../lib.glsl"
#pragma kernel(output = "height:r32f")
uniform sampler2D grass;  //! file("../grass.png")
float kernel(ivec2 texel) { return half_of(float(texel.x)); }
"""


@pytest.fixture
def hills(tmp_path: Path) -> Path:
    folder = tmp_path / "hills"
    (folder / "parts").mkdir(parents=True)
    (folder / "lib.glsl").write_text("float half_of(float x) { return 0.5 * x; }\n")
    (folder / "parts" / "k.glsl").write_text(KERNEL)
    return folder


def test_the_root_is_the_library_or_the_sketch_s_folder_or_the_file_s_own(hills: Path):
    part = hills / "parts" / "k.glsl"
    assert root_of(GLSL / "noise" / "hash.glsl") == GLSL
    assert root_of(part) == hills / "parts"
    (hills / "sketch.toml").touch()
    assert root_of(part) == hills
    (hills / "parts" / "sketch.toml").touch()
    assert root_of(part) == hills / "parts"


def test_a_part_of_a_sketch_reads_from_the_sketch_s_folder(hills: Path):
    part = hills / "parts" / "k.glsl"
    with pytest.raises(ShaderError, match="outside"):
        load(part)
    (hills / "sketch.toml").touch()
    opened = load(part)
    assert opened.folder == str(hills)
    assert opened.graph.find("height").use == "./parts/k"  # type: ignore[union-attr]
    assert str(hills / "lib.glsl") in opened.files


def test_a_technique_of_several_passes_does_too(hills: Path):
    (hills / "sketch.toml").touch()
    whole = hills / "parts" / "whole.toml"
    whole.write_text('[[pass]]\nname = "height"\nuse = "./k"\n[outputs]\nheight = "height"\n')
    assert str(hills / "lib.glsl") in load(whole).files


def test_links_are_followed_once_in_a_load_and_anew_in_the_next(tmp_path):
    first, second, link = tmp_path / "first", tmp_path / "second", tmp_path / "link"
    first.mkdir()
    second.mkdir()
    link_to(link, first)
    with noting_places():
        assert real(link) == first
        link.unlink()
        link_to(link, second)
        assert real(link) == first, "one load sees one state"
        with noting_places():
            assert real(link) == second
    assert real(link) == second


def link_to(link: Path, target: Path) -> None:
    try:
        link.symlink_to(target, target_is_directory=True)
    except OSError:
        pytest.skip("this system makes no links")


def test_a_load_follows_the_links_of_a_path_once_and_the_next_load_follows_them_anew(
    hills: Path, monkeypatch: pytest.MonkeyPatch
):
    followed: Counter[Path] = Counter()
    resolve = Path.resolve

    def counted(path: Path, strict: bool = False) -> Path:
        if sys._getframe(1).f_code is real.__code__:
            followed[path] += 1
        return resolve(path, strict)

    monkeypatch.setattr(Path, "resolve", counted)
    view = '[view]\nuse = "view/map"\ninputs = { shown = "height" }\n'
    (hills / "sketch.toml").write_text(f'format = 1\n[[pass]]\nname = "height"\nuse = "./parts/k"\n{view}')
    load(hills)
    assert followed[hills / "parts" / "k.glsl"] == 1 and set(followed.values()) == {1}
    load(hills)
    assert followed[hills / "parts" / "k.glsl"] == 2
