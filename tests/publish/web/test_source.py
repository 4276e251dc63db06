"""Texts are flattened in a page as Python flattens them: code, files and lines, and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.errors import ShaderError
from playground.paths import GLSL
from playground.shader.source import SourceText, read_source

from .node import Node, NodeError
from .texts import kernels, shared_files

MANY = """async ([shared, files, texts], load) => {
  const { flatten } = await load("source.js");
  return files.map((file) => {
    try {
      const { lines, names } = flatten(shared, file, texts);
      return { lines: lines.map((line) => [line.code, line.raw, line.file, line.line]), names };
    } catch (error) {
      return { error: error.message, file: error.file, line: error.line };
    }
  });
}"""


def lines_of(source: SourceText, folder: Path, prefix: str = "") -> list[list[object]]:
    """Return what a page has of each line, worked out by Python."""
    root = folder.resolve()
    return [
        [line.code, line.text, prefix + Path(line.file).relative_to(root).as_posix(), line.number]
        for line in source.lines
    ]


@pytest.mark.slow
def test_every_program_of_the_library(node: Node):
    result = node.run(MANY, [shared_files(GLSL), list(kernels()), {}])
    assert len(result) > 120
    for kernel, flat in zip(kernels().values(), result, strict=True):
        assert flat["lines"] == lines_of(kernel.source, GLSL), kernel.name
        assert flat["names"] == kernel.source.names, kernel.name


@pytest.mark.parametrize("name", ["constructor", "toString", "__proto__"])
def test_a_name_that_javascript_gives_every_object_is_no_file(node: Node, name: str):
    shared = {"files": {"./a.glsl": f'\n#include "{name}"\n'}, "includes": {"./a.glsl": {}}}
    (result,) = node.run(MANY, [shared, ["./a.glsl"], {}])
    assert result == {"error": f"no file '{name}' to include", "file": "./a.glsl", "line": 2}


PARTS = [
    *("a", "b1", "x = 1;", ";", "(", ")", ",", "{", "}", " ", "  ", "\t", "\n", "\n", "\n"),
    *("/*", "*/", "//", "/", "*", '"', "\\", "\\\n", "\\\n", "'", "#", "##"),
    *('#include "b.glsl"', '#include "c.glsl"', '\n#include "sub/d.glsl"\n', "\n#include <c.glsl>\n"),
    *('\n#include "a.glsl"\n', '\n#include "none.glsl"\n', "\n#include\n", '\n# include "b.glsl" x\n'),
    *(
        "\n#define F(x) x\n",
        "\n#define G F\n",
        "\n#define H 1\n",
        "\n# define K(",
        "F",
        "F(",
        "G(",
        "H(",
        "F\n(1)",
    ),
    *("\n#line 7\n", "\n#pragma kernel(x)\n", "\n#pragma draw\n", "#pragma kernels", "\n#pragma once\n"),
    *("é", "\u0394x", "\U0001d11e", "\u2028", "\x85", "\x1c", "\x0b", "\x0c", "\xa0", "\ufeff", "\x00"),
    *("#includeé", "\u2003#line 3", "\x1c#pragma draw\x1c", "\ufeff#line 3", "#pragma\xa0draw "),
]


def hostile(rng: np.random.Generator, lengths: tuple[int, int]) -> str:
    """Return a text of pieces that meet where their authors did not think of it."""
    expected = [p for p in PARTS if "include" not in p or rng.random() < 0.3]
    return "".join(rng.choice(expected) for _ in range(rng.integers(*lengths)))


@pytest.mark.slow
def test_random_texts_flatten_or_fail_as_in_python(node: Node, tmp_path: Path):
    rng = np.random.default_rng(1)
    kinds = {"lines": 0, "error": 0}
    (tmp_path / "sub").mkdir()
    for case in range(200):
        for name in ("a", "b", "c", "sub/d"):
            (tmp_path / f"{name}.glsl").write_text(hostile(rng, (1, 60)), "utf-8", newline="")
        try:
            expected: object = lines_of(read_source(tmp_path / "a.glsl", [tmp_path]), tmp_path, "./")
        except ShaderError as error:
            first = error.diagnostics[0]
            assert first.file
            path = Path(first.file).resolve().relative_to(tmp_path.resolve()).as_posix()
            message = first.message.replace(f"{tmp_path.resolve()}/", "./").partition("; did you mean")[0]
            expected = [message, f"./{path}", first.line]
        texts = {
            f"./{p.relative_to(tmp_path).as_posix()}": p.read_bytes().decode()
            for p in tmp_path.rglob("*.glsl")
        }
        [result] = node.run(MANY, [{"files": texts, "includes": {}}, ["./a.glsl"], {}])
        kinds["error" if "error" in result else "lines"] += 1
        kind = [result["error"], result["file"], result["line"]] if "error" in result else result["lines"]
        assert kind == expected, f"case {case}"
    assert min(kinds.values()) > 40


def test_line_ends_and_a_byte_order_mark_are_those_of_any_system(node: Node, tmp_path: Path):
    (tmp_path / "a.glsl").write_bytes(b"\xef\xbb\xbfint a;\r\nint b; // x\rint c;\n")
    expected = lines_of(read_source(tmp_path / "a.glsl", [tmp_path]), tmp_path, "./")
    text = (tmp_path / "a.glsl").read_bytes().decode()
    [result] = node.run(MANY, [{"files": {"./a.glsl": text}, "includes": {}}, ["./a.glsl"], {}])
    assert result["lines"] == expected
    assert [line[0] for line in expected] == ["int a;", "int b;", "int c;", ""]


# ── errors, with their places ────────────────────────────────────────────────


def refused(node: Node, files: dict[str, str], file: str = "./a.glsl") -> tuple[str, str, int]:
    with pytest.raises(NodeError) as caught:
        node.call("source.js", "flatten", {"files": files, "includes": {}}, file)
    return caught.value.message, caught.value.details["file"], caught.value.details["line"]


def test_a_cycle_names_its_files(node: Node):
    files = {"./a.glsl": '#include "b.glsl"', "./b.glsl": '\n#include "a.glsl"'}
    assert refused(node, files) == ("include cycle: ./a.glsl → ./b.glsl → ./a.glsl", "./b.glsl", 2)


def test_a_missing_file_is_named(node: Node):
    assert refused(node, {"./a.glsl": '\n\n#include "x/y.glsl"'}) == (
        "no file 'x/y.glsl' to include",
        "./a.glsl",
        3,
    )


def test_too_many_levels_and_too_many_includes_are_refused(node: Node):
    deep = {f"./{i}.glsl": f'#include "{i + 1}.glsl"' for i in range(40)}
    assert refused(node, deep, "./0.glsl") == ("includes nested more than 32 deep", "./31.glsl", 1)
    wide = {f"./{i}.glsl": f'#include "{i + 1}.glsl"\n' * 9 for i in range(6)} | {"./6.glsl": ""}
    assert refused(node, wide, "./0.glsl")[0].startswith("more than 4096 includes;")


# ── edits ────────────────────────────────────────────────────────────────────


def test_edited_text_replaces_file_at_every_include(node: Node):
    files = {"./a.glsl": '#include "b.glsl"\nint a;', "./b.glsl": "int b;"}
    shared = {"files": files, "includes": {}}
    flat = node.call("source.js", "flatten", shared, "./a.glsl", {"./b.glsl": "int edited;"})
    assert [line["code"] for line in flat["lines"]] == ["", "int edited;", "int a;"]


def test_an_edit_may_include_what_it_did_not(node: Node):
    text = '#include "noise/hash.glsl"\n#include "../maths/cube.glsl"\n'
    flat = node.call(
        "source.js", "flatten", shared_files(GLSL), "lighting/l_dot_n.glsl", {"lighting/l_dot_n.glsl": text}
    )
    assert {line["file"] for line in flat["lines"]} >= {"noise/hash.glsl", "maths/cube.glsl"}


def test_a_known_include_goes_before_what_a_name_looks_like(node: Node):
    files = {"./a.glsl": '#include "b.glsl"', "./b.glsl": "int near;", "b.glsl": "int far;"}
    shared = {"files": files, "includes": {"./a.glsl": {"b.glsl": "b.glsl"}}}
    assert [line["code"] for line in node.call("source.js", "flatten", shared, "./a.glsl")["lines"]] == [
        "",
        "int far;",
    ]


def test_another_tools_shader_includes_each_file_once(node: Node):
    files = {"./a.glsl": '#include "b.glsl"\n#include "b.glsl"\n#include "a.glsl"', "./b.glsl": "int b;"}
    shared = {"files": files, "includes": {}}
    flat = node.call("source.js", "flatten", shared, "./a.glsl", {}, {"once": True})
    assert [line["code"] for line in flat["lines"]] == ["", "int b;", "", ""]
