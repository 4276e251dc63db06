"""Parameters that several kernels share: declared once in an included file."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.sketch_warnings import unread
from playground.errors import ShaderError
from playground.shader.header import parse_kernel
from playground.shader.source import read_source
from playground.sketch.model import Kernel

PRAGMA = '#pragma kernel(output = "height:r32f")\n'
SUN = """#ifndef SUN
#define SUN
uniform float gain = 2.0;  //! slider(0, 4) group("Sun")
                           //! The light is multiplied by it
uniform int steps = 4;     //! slider(1, 9)
#endif
"""


class Folder:
    """A folder of GLSL files."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, **texts: str) -> None:
        for name, text in texts.items():
            (self.path / f"{name}.glsl").write_text(text, encoding="utf-8")

    def kernel(self, text: str) -> Kernel:
        self.write(kernel=text)
        kernel = parse_kernel("kernel", read_source(self.path / "kernel.glsl", (self.path,)))
        assert kernel is not None
        return kernel

    def refused(self, text: str) -> tuple[str, str, int, tuple[str, ...]]:
        with pytest.raises(ShaderError) as caught:
            self.kernel(text)
        diagnostic = caught.value.diagnostics[0]
        chain = tuple(Path(position).name for position in diagnostic.chain)
        return diagnostic.message, Path(diagnostic.file).name, diagnostic.line, chain


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    made = Folder(tmp_path)
    made.write(sun=SUN)
    return made


def test_included_parameter_keeps_its_annotation_and_location(folder: Folder) -> None:
    gain = folder.kernel(PRAGMA + '#include "sun.glsl"\n').parameters[0]
    assert (gain.default, gain.widget.high, gain.group, gain.tooltip) == (
        2.0,
        4.0,
        "Sun",
        "The light is multiplied by it",
    )
    assert (Path(gain.file).name, gain.line) == ("sun.glsl", 3)


def test_the_panel_has_them_where_the_include_is(folder: Folder) -> None:
    text = f'{PRAGMA}uniform float first;\n#include "sun.glsl"\nuniform float last;\n'
    assert [p.name for p in folder.kernel(text).parameters] == ["first", "gain", "steps", "last"]


def test_an_expression_of_the_pragma_may_name_one(folder: Folder) -> None:
    pragma = '#pragma kernel(output = "height:r32f", repeat = "steps")\n'
    assert folder.kernel(pragma + '#include "sun.glsl"\n').repeat == "steps"


def test_a_file_that_comes_twice_gives_its_parameters_once(folder: Folder) -> None:
    folder.write(light='#include "sun.glsl"\nuniform float ambient;\n')
    kernel = folder.kernel(PRAGMA + '#include "sun.glsl"\n#include "light.glsl"\n#include "sun.glsl"\n')
    assert [p.name for p in kernel.parameters] == ["gain", "steps", "ambient"]


@pytest.mark.parametrize(
    ("own", "position"),
    [
        ('uniform float gain = 1.0;\n#include "sun.glsl"\n', ("sun.glsl", 3, ("kernel.glsl:3",))),
        ('#include "sun.glsl"\nuniform float gain = 1.0;\n', ("kernel.glsl", 3, ())),
    ],
)
def test_redeclared_shared_parameter_is_reported_at_both_places(
    folder: Folder, own: str, position: tuple[str, int, tuple[str, ...]]
) -> None:
    message, *result = folder.refused(PRAGMA + own)
    assert tuple(result) == position
    first = "kernel.glsl:2" if position[0] == "sun.glsl" else "sun.glsl:3"
    assert message.startswith("'gain' is declared twice: first at ") and message.endswith(first)


def test_kernel_declares_differing_parameter_and_includes_rest(folder: Folder) -> None:
    folder.write(steps="uniform int steps = 4;\n")
    text = f'{PRAGMA}uniform float gain = 1.0;  //! label("Brightness")\n#include "steps.glsl"\n'
    gain, steps = folder.kernel(text).parameters
    assert (gain.default, gain.label, steps.default) == (1.0, "Brightness", 4)


def test_what_no_code_reads_is_reported_at_its_declaration(folder: Folder) -> None:
    diagnostics = unread(
        folder.kernel(f'{PRAGMA}#include "sun.glsl"\nfloat kernel(ivec2 t) {{ return gain; }}\n')
    )
    assert [(Path(d.file).name, d.line, d.message) for d in diagnostics] == [
        ("sun.glsl", 5, "nothing reads 'steps', so it has no effect")
    ]
    assert [Path(position).name for position in diagnostics[0].chain] == ["kernel.glsl:2"]


# Annotations of several lines


@pytest.mark.parametrize(
    "text",
    [
        'uniform float a;  //! slider(0, 1) unit("m") How far\n',
        'uniform float a;  //! slider(0, 1)\n    //! unit("m")\n    //! How far\n',
        'uniform float a;  //! slider(0,\n//! 1) unit("m") How\n//! far\n',
        'uniform float a;  //!\n//! slider(0, 1) unit("m") How far\n',
    ],
)
def test_an_annotation_goes_on_in_lines_of_its_own(folder: Folder, text: str) -> None:
    parameters = folder.kernel(f"{PRAGMA}{text}// no part of it\nuniform float b;  //! Another\n").parameters
    assert (parameters[0].widget.high, parameters[0].unit, parameters[0].tooltip) == (1.0, "m", "How far")
    assert [(p.name, p.line) for p in parameters] == [("a", 2), ("b", text.count("\n") + 3)]
    assert parameters[1].tooltip == "Another"


def test_a_line_without_an_annotation_takes_none_from_the_next(folder: Folder) -> None:
    parameters = folder.kernel(f"{PRAGMA}uniform float a;\n//! Words\n").parameters
    assert parameters[0].tooltip == ""


# Named expressions of a pragma


def test_where_names_expressions_of_the_pragma(folder: Folder) -> None:
    kernel = folder.kernel(
        '#pragma kernel(output = "height:r32f", where = "half = size.x // 2; both = half + steps", \\\n'
        '               repeat = "2 * both")\nuniform int steps = 3;\n'
    )
    assert kernel.repeat == "2 * ((size.x // 2) + steps)"


def test_where_applies_to_groups_and_buffer_counts_not_names(folder: Folder) -> None:
    kernel = folder.kernel(
        '#pragma compute(where = "row = size.x + 1; float = 2", groups = "row, 1", \\\n'
        '                buffers = "row:float:row * size.y * float")\n'
    )
    assert kernel.groups == "(size.x + 1), 1"
    assert [(b.name, b.type, b.count) for b in kernel.storage.buffers] == [
        ("row", "float", "(size.x + 1) * size.y * (2)")
    ]
