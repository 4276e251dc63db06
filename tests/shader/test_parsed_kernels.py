"""Kernels are parsed again when anything they were made of is another, and only then."""

from __future__ import annotations

import os

import pytest

from playground.errors import ShaderError
from playground.shader.header import parsed_kernel
from playground.sketch.techniques import read_kernel

KERNEL = """#include "part.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return part(); }
"""
PART = "float part() { return 1.0; }\n"


@pytest.fixture
def files(tmp_path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "k.glsl").write_text(KERNEL)
    (tmp_path / "part.glsl").write_text(PART)
    return tmp_path


def read(files):
    return parsed_kernel("k", files / "inner" / "k.glsl", (files,))


def test_the_same_files_give_the_same_object(files):
    assert read(files) is read(files)


def test_a_change_within_one_tick_and_of_the_same_length_is_seen(files):
    before, part = read(files), files / "part.glsl"
    stat = part.stat()
    part.write_text(PART.replace("1.0", "2.0"))
    os.utime(part, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert "2.0" in read(files).source.code
    part.write_text(PART)
    assert read(files) == before


def test_an_include_that_appears_in_a_nearer_place_is_taken(files):
    read(files)
    (files / "inner" / "part.glsl").write_text(PART.replace("1.0", "3.0"))
    assert "3.0" in read(files).source.code
    (files / "inner" / "part.glsl").unlink()
    assert "1.0" in read(files).source.code


def test_an_include_that_goes_is_missed_and_found_again(files):
    read(files)
    (files / "part.glsl").unlink()
    with pytest.raises(ShaderError, match=r"part\.glsl"):
        read(files)
    (files / "part.glsl").write_text(PART)
    assert "1.0" in read(files).source.code


def test_retargeted_symlink_is_detected_despite_equal_text(files):
    (files / "one.glsl").write_text(PART)
    (files / "two.glsl").write_text(PART)
    (files / "part.glsl").unlink()
    (files / "part.glsl").symlink_to("one.glsl")
    assert any(file.endswith("one.glsl") for file in read(files).source.files)
    (files / "part.glsl").unlink()
    (files / "part.glsl").symlink_to("two.glsl")
    assert any(file.endswith("two.glsl") for file in read(files).source.files)


VARIANT = """#pragma compute(groups = "(size.x + 7) / 8, (size.y + 7) / 8")
void main() {}
"""


def test_kernel_and_variant_stay_cached_until_either_changes(files):
    path = files / "inner" / "k.glsl"
    path.with_suffix(".comp").write_text(VARIANT)
    first = read_kernel(path, files)
    assert first.variants and read_kernel(path, files) is first
    path.with_suffix(".comp").write_text(VARIANT.replace("{}", "{ }"))
    second = read_kernel(path, files)
    assert second.variants[0].technique.source.code != first.variants[0].technique.source.code
    (files / "part.glsl").write_text(PART.replace("1.0", "2.0"))
    third = read_kernel(path, files)
    assert third.variants == second.variants and "2.0" in third.source.code
