"""What ``check`` says of a file, and where; what opening the same file says is the same."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.engine.sandbox import Sandbox
from playground.errors import Diagnostic, PlaygroundError
from playground.paths import GLSL
from playground.verify.check import check_file, find_files

from ..loading import load


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    with Sandbox() as made:
        yield made


def wrong(path: Path, sandbox: Sandbox) -> Diagnostic:
    report = check_file(path, sandbox)
    assert not report.ok
    assert "subject" not in json.dumps(report.as_json())
    return report.errors[0]


HEADERS = {
    "repeat": ("", ', repeat = "2 - size.x"', "float kernel(ivec2 texel) { return 1.0; }"),
    "visits": (
        "",
        ', repeat = "2", visits = "size.x / iteration, 1"',
        "ivec2 visit(ivec2 cell) { return cell; }\nfloat kernel(ivec2 texel) { return 1.0; }",
    ),
}


@pytest.mark.parametrize("what", HEADERS)
def test_a_header_that_is_wrong_is_reported_at_its_line(folder, sandbox, what):
    before, option, body = HEADERS[what]
    path = folder.write(
        "hills.glsl", f'// hills\n{before}\n#pragma kernel(output = "a:r32f"{option})\n{body}\n'
    )
    result = wrong(path, sandbox)
    assert (Path(result.file).name, result.line) == ("hills.glsl", 3), result
    assert result.message.startswith(f"pass 'hills': {what}")
    assert result.excerpt.startswith("#pragma kernel")


def test_a_compute_variant_s_groups_are_reported_at_its_own_line(folder, sandbox):
    if trial_has_no_compute(folder, sandbox):
        pytest.skip("this context has no compute shaders")
    folder.write(
        "hills.glsl", '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 texel) { return 1.0; }\n'
    )
    text = '\n#pragma compute(groups = "size.x / (size.x - size.y), 1")\nvoid main() {}\n'
    result = wrong(folder.write("hills.comp", text), sandbox)
    assert (Path(result.file).name, result.line) == ("hills.comp", 2), result


def trial_has_no_compute(folder, sandbox: Sandbox) -> bool:
    path = folder.write(
        "any.glsl", '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 t) { return 1.0; }\n'
    )
    return bool(check_file(path, sandbox).skipped)


def test_a_sketch_s_own_kernel_is_reported_at_its_header_too(any_engine, folder):
    sketch = folder.one(
        '// one\n#pragma kernel(output = "a:r32f", repeat = "2 - size.x")\n'
        "float kernel(ivec2 texel) { return 1.0; }\n"
    )
    with pytest.raises(PlaygroundError, match="gives -15") as caught:
        any_engine.read(sketch, "a")
    diagnostic = caught.value.diagnostics[0]
    assert (Path(diagnostic.file).name, diagnostic.line) == ("one.glsl", 2)


def test_a_part_of_a_sketch_is_checked_and_opened_by_one_rule(folder, sandbox):
    folder.write("lib.glsl", "float half_of(float x) { return 0.5 * x; }\n")
    part = folder.write(
        "parts/k.glsl",
        '#include "../lib.glsl"\n#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 texel) { return half_of(float(texel.x)); }\n",
    )
    assert "outside" in wrong(part, sandbox).message
    with pytest.raises(PlaygroundError, match="outside"):
        load(part)
    folder.write("sketch.toml", "")
    assert check_file(part, sandbox).ok
    load(part)


def test_shader_without_kernel_gets_same_error_in_check_and_load(folder, sandbox):
    bare = folder.write("bare.frag", "float x;\n")
    said = wrong(bare, sandbox).message
    assert said == "nothing to run: no main, mainImage or #pragma kernel"
    with pytest.raises(PlaygroundError) as caught:
        load(bare)
    assert caught.value.diagnostics[0].message == said


HOLE = '// h\n#pragma kernel(output = "height:r32f")\nuniform float root = -1.0; //! slider(-1, 1)\n'
ALL = HOLE + "float kernel(ivec2 texel) { return sqrt(root); }\n"
SOME = HOLE + "float kernel(ivec2 texel) { return texel.x == 1 ? sqrt(root) : 0.5; }\n"


def test_all_nan_output_fails_check_and_single_hole_passes(folder, sandbox):
    result = wrong(folder.write("all.glsl", ALL), sandbox)
    assert "output 'height': none of its 1089 texels is finite; the first is NaN" in result.message
    assert (Path(result.file).name, result.line) == ("all.glsl", 2)
    assert check_file(folder.write("some.glsl", SOME), sandbox).ok
    assert check_file(folder.write("none.glsl", ALL.replace("= -1.0;", "= 1.0;")), sandbox).ok


def test_a_sketch_may_have_no_hole_at_all(folder, sandbox):
    folder.write("some.glsl", SOME)
    text = 'format = 1\nsize = 33\n[[pass]]\nname = "height"\nuse = "./some"\n'
    sketch = folder.write("sketch.toml", text)
    result = wrong(sketch, sandbox)
    assert "pass 'height', output 'height': NaN at texel (1, 0)" in result.message
    assert (Path(result.file).name, result.line) == ("some.glsl", 2)
    folder.write("sketch.toml", text + "set = { root = 1.0 }\n")
    assert check_file(sketch, sandbox).ok


@pytest.mark.slow
def test_a_file_that_the_child_does_not_survive_is_not_read_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """2 GiB of holes, by columns, so that they are not read by rows: more than the child may take."""
    from playground.engine import file_sources

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("read by the parent")

    with (tmp_path / "heights.npy").open("wb") as file:
        head = {"descr": "<f8", "fortran_order": True, "shape": (16384, 16384)}
        np.lib.format.write_array_header_1_0(file, head)
        file.truncate(file.tell() + 8 * 16384**2)
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        'set = { elevation = "heights.npy" }\n[view]\nuse = "view/map"\ninputs = { shown = "height" }\n',
        encoding="utf-8",
    )
    monkeypatch.setattr(file_sources, "open_elevation", refuse)
    with Sandbox(memory_bytes=2**30) as small:
        result = wrong(tmp_path / "sketch.toml", small)
    assert "not enough memory to read it" in result.message and "heights.npy" in result.message


LIBRARY = "float height_at(ivec2 texel);\nvoid count_step(inout int steps);\n"
READS = "float twice(ivec2 texel) { int n = 0; count_step(n); return 2.0 * height_at(texel); }\n"


def test_library_file_may_declare_functions_its_includer_defines(folder, sandbox):
    assert check_file(folder.write("march.glsl", LIBRARY + READS), sandbox).ok
    result = wrong(folder.write("slip.glsl", LIBRARY + READS.replace("height_at(", "hight_at(")), sandbox)
    assert (Path(result.file).name, result.line) == ("slip.glsl", 3), result


COUNTED = """#pragma draw(mesh = "sheet", instances = "min(list.y, 6)", output = "drawn:rgba32f")
uniform sampler2D list;  //! input
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(2.0 * corner.xy - 1.0, 0.0, 1.0);
}
vec4 fragment(vec2 place) { return texelFetch(list, ivec2(0), 0); }
"""


def test_an_input_that_counts_instances_is_a_whole_number(folder, sandbox):
    draw = folder.write("draw.glsl", COUNTED)
    assert check_file(draw, sandbox).errors == ()
    inner = '[[pass]]\nname = "a"\nuse = "./draw"\n[inputs]\nnumbers = "a.list"\n[outputs]\ndrawn = "a"\n'
    outer = inner.replace("./draw", "./inner").replace("a.list", "a.numbers").replace("numbers =", "rows =")
    assert check_file(folder.write("inner.toml", inner), sandbox).errors == ()
    assert check_file(folder.write("outer.toml", outer), sandbox).errors == ()
    fraction = folder.write("draw.glsl", COUNTED.replace("min(list.y, 6)", "list.y / 7"))
    assert "a whole number was expected" in check_file(fraction, sandbox).errors[0].message


FOLDERS = sorted(path.name for path in GLSL.iterdir() if path.is_dir())


@pytest.mark.slow
@pytest.mark.parametrize("name", FOLDERS)
def test_what_ships_is_checked_without_an_error(name, sandbox):
    reports = [check_file(path, sandbox, root) for path, root in find_files([GLSL / name])]
    assert [str(error) for report in reports for error in report.errors] == []
