"""GLSL texts: includes in place, every line with its own file and number, nothing from outside."""

from __future__ import annotations

import pickle
import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

from playground.errors import PlaygroundError, ShaderError, SketchError
from playground.paths import GLSL
from playground.shader.source import SourceText, read_source


@pytest.fixture
def write(tmp_path):
    def write_(name: str, text: str | bytes) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write_


def read(path: Path, *roots: Path) -> SourceText:
    return read_source(path, roots or (path.parent,))


def refused(path: Path, words: str, file: str, line: int, *roots: Path) -> ShaderError:
    with pytest.raises(ShaderError) as caught:
        read(path, *roots)
    diagnostic = caught.value.diagnostics[0]
    assert words in diagnostic.message and "\n" not in diagnostic.message, diagnostic
    assert (Path(diagnostic.file).name, diagnostic.line) == (file, line)
    return caught.value


# Lines


def test_each_line_knows_where_it_comes_from(write):
    write("lib/b.glsl", "float b;\nfloat bb;\n")
    write("lib/a.glsl", '#include "b.glsl"\nfloat a;\n')
    path = write("main.glsl", 'one\n#include "lib/a.glsl"\nthree\n')
    result = read(path)
    places = [(Path(line.file).name, line.number, line.code) for line in result.lines if line.code]
    assert places == [
        ("main.glsl", 1, "one"),
        ("b.glsl", 1, "float b;"),
        ("b.glsl", 2, "float bb;"),
        ("a.glsl", 2, "float a;"),
        ("main.glsl", 3, "three"),
    ]
    inner = next(line for line in result.lines if line.code == "float b;")
    assert [Path(position).name for position in inner.chain] == ["main.glsl:2", "a.glsl:1"]
    assert [Path(p).name for p in result.files] == ["main.glsl", "a.glsl", "b.glsl"]
    assert result.code.split("\n")[:-1] == [line.code for line in result.lines]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("last", [True, False])
def test_line_ends_marks_and_a_missing_last_end_change_nothing(write, end, mark, last):
    write("lib.glsl", mark + ("float x;" + end if last else "float x;").encode())
    text = end.join(["first", '#include "lib.glsl"', "third"]) + (end if last else "")
    result = read(write("main.glsl", mark + text.encode()))
    assert [line.code for line in result.lines if line.code] == ["first", "float x;", "third"]
    assert next(line.number for line in result.lines if line.code == "third") == 3
    assert result.canonical == "first\nfloat x;\nthird"


def test_driver_text_has_no_comments_quotes_or_non_ascii(write):
    write("lib.glsl", "float x;\n")
    text = 'float a; // größe "quoted"\n/* ü " */ float b; /* // */ float c;\n'
    text += '#pragma kernel(output = "h:r32f") // x\n'
    text += '  #  include   "lib.glsl"   // why\nfloat d = é;\n\tfloat\ve;\f\n'
    result = read(write("main.glsl", text))
    assert '"' not in result.code and result.code.isascii()
    assert result.lines[0].code == "float a;" and result.lines[0].comment == ' größe "quoted"'
    assert result.lines[1].code.split() == ["float", "b;", "float", "c;"]
    assert (result.lines[2].code, result.lines[2].comment) == ("", " x")
    assert result.lines[2].pragma == '#pragma kernel(output = "h:r32f")'
    assert result.lines[-3].code == "float d = ?;"
    assert result.lines[-2].code == "\tfloat e;"


def test_columns_stay_where_they_were(write):
    text = "a /* b */ c /* d\n   e */ f // g\n"
    result = read(write("main.glsl", text))
    for line in result.lines:
        for index, letter in enumerate(line.code):
            assert letter in (" ", line.text[index])


def stripped(text: str) -> str:
    """Blank comments by a pattern over the whole text, as a truth of another make."""
    pattern = r'"[^"\n]*"|//[^\n]*|/\*.*?(?:\*/|\Z)'
    return re.sub(
        pattern,
        lambda m: m[0] if m[0][0] == '"' else re.sub(r"[^\n]", " ", m[0]),
        text,
        flags=re.DOTALL,
    )


def test_comment_blanking_matches_whole_text_pattern(write):
    rng = random.Random(1)
    for _ in range(500):
        pieces = ["//", "/*", "*/", "\n", "a", " ", "x y", '"q//"', "//!", "/", "*", "\t"]
        text = "".join(rng.choice(pieces) for _ in range(30))
        result = read(write("main.glsl", text))
        expected = [line.replace("\t", " ").rstrip() for line in stripped(text).split("\n")]
        assert [line.code.replace("\t", " ") for line in result.lines] == expected, repr(text)


def test_what_is_in_a_comment_is_not_read(write):
    text = """\
    // #include "nothing.glsl"
    /* #include "nothing.glsl"
    #include "nothing.glsl"
    #pragma kernel(output = "h:r32f")
    uniform float x; //! slider(0, 1)
    */
    float y; //! yes
    """
    result = read(write("main.glsl", text))
    assert not any(line.pragma for line in result.lines)
    assert [line.comment for line in result.lines if line.comment.startswith("!")] == ["! yes"]


def test_a_backslash_joins_lines_and_numbers_stay(write):
    text = 'a \\\n b\\\nc\nd\n// e \\\nf\n#pragma kernel(output = \\\n  "h:r32f")\ng\n'
    result = read(write("main.glsl", text))
    assert [line.code for line in result.lines] == ["a  bc", "", "", "d", "", "", "", "", "g", ""]
    assert [line.number for line in result.lines] == list(range(1, 11))
    assert result.lines[4].comment == " e f"
    assert result.lines[6].pragma == '#pragma kernel(output =   "h:r32f")'
    assert read(write("main.glsl", "last \\")).lines[0].code == "last \\"
    assert read(write("main.glsl", "last \\\n")).lines[0].code == "last"


def test_an_include_may_be_joined_too(write):
    write("lib.glsl", "x\n")
    assert "x" in read(write("main.glsl", '#include \\\n "lib.glsl"\n')).code


def test_a_changed_comment_or_indentation_is_no_change(write):
    item = read(write("main.glsl", "float a;\n\n  float b; // x\n"))
    two = read(write("main.glsl", "// new\nfloat a;\n\tfloat   b;\n"))
    assert item.canonical == two.canonical and item.code != two.code
    assert read(write("main.glsl", "float a; float b;")).canonical != item.canonical


# Includes


def test_a_diamond_is_read_twice_and_listed_once(write):
    write("base.glsl", "#ifndef B\n#define B\nfloat base;\n#endif\n")
    write("a.glsl", '#include "base.glsl"\n')
    write("b.glsl", '#include "base.glsl"\n')
    result = read(write("main.glsl", '#include "a.glsl"\n#include "b.glsl"\n'))
    assert result.code.count("float base;") == 2
    assert len(result.files) == 4
    chains = [line.chain for line in result.lines if line.code == "float base;"]
    assert chains[0] != chains[1]


def test_cycles_are_reported_whole(write):
    write("a.glsl", '\n#include "b.glsl"\n')
    write("b.glsl", '#include "a.glsl"\n')
    path = write("main.glsl", '#include "a.glsl"\n')
    error = refused(path, "include cycle", "b.glsl", 1)
    assert re.search(r"a\.glsl → \S*b\.glsl → \S*a\.glsl", str(error))
    assert len(error.diagnostics[0].chain) == 2
    refused(write("self.glsl", 'x\n#include "self.glsl"\n'), "include cycle", "self.glsl", 2)


def test_a_link_to_itself_is_a_cycle_too(write, tmp_path):
    path = write("main.glsl", '#include "other.glsl"\n')
    (tmp_path / "other.glsl").symlink_to(path)
    refused(path, "include cycle", "main.glsl", 1)
    (tmp_path / "loop.glsl").symlink_to(tmp_path / "loop.glsl")
    refused(write("b.glsl", '#include "loop.glsl"\n'), "no file 'loop.glsl'", "b.glsl", 1)


def test_a_missing_include_names_the_nearest(write):
    write("noise/rough.glsl", "")
    error = refused(write("main.glsl", '\n\n#include "noise/rouhg.glsl"\n'), "no file", "main.glsl", 3)
    assert "did you mean 'noise/rough.glsl'" in str(error)
    assert '#include "noise/rouhg.glsl"' in str(error)


@pytest.mark.parametrize(
    "line",
    [
        '#include "a.glsl";',
        '#include "a.glsl" ; // why "so"; or not',
        "#include <a.glsl>; /* why */",
        '# pragma include "a.glsl"',
        "#pragma include <a.glsl>;",
    ],
)
def test_an_include_as_other_tools_write_it(write, line):
    write("a.glsl", "float a;")
    result = read(write("main.glsl", f"{line}\nfloat b;\n"))
    assert result.code.split() == ["float", "a;", "float", "b;"]


@pytest.mark.parametrize(
    "line",
    [
        "#include",
        "#include noise",
        '#include ""',
        '#include "a',
        '#include "a.glsl" b',
        "#include <>",
        "#include <a",
    ],
)
def test_an_include_without_one_name_is_refused(write, line):
    write("a.glsl", "")
    refused(write("main.glsl", line), "needs one file name in quotes", "main.glsl", 1)


def test_includes_stay_in_the_folder_and_the_library(write, tmp_path):
    write("secret.glsl", "secret\n")
    write("mine-too/x.glsl", "secret\n")
    write("mine/inner/ok.glsl", "wanted\n")
    folder = tmp_path / "mine"
    (folder / "link.glsl").symlink_to(tmp_path / "secret.glsl")
    (folder / "linked").symlink_to(tmp_path)
    for name in (
        "../secret.glsl",
        "inner/../../secret.glsl",
        "link.glsl",
        "linked/secret.glsl",
        "../mine-too/x.glsl",
    ):
        refused(write("mine/main.glsl", f'#include "{name}"\n'), "lies outside", "main.glsl", 1)
    for name in (tmp_path / "secret.glsl", "/etc/hostname"):
        refused(write("mine/main.glsl", f'#include "{name}"\n'), "lies outside", "main.glsl", 1)
    text = '#include "inner/ok.glsl"\n#include "inner/../inner/ok.glsl"\n#include <noise/hash.glsl>\n'
    assert read(write("mine/main.glsl", text)).code.count("wanted") == 2
    inner = write("mine/inner/main.glsl", '#include "../up.glsl"\n')
    write("mine/up.glsl", "up\n")
    assert "up" in read(inner, folder).code
    refused(inner, "lies outside", "main.glsl", 1, inner.parent)


def test_no_sketch_changes_what_a_library_file_means(write, tmp_path):
    write("noise/hash.glsl", "stolen\n")
    own = read(write("main.glsl", '#include "noise/hash.glsl"\n'))
    assert "stolen" in own.code
    borrowed = next(p for p in sorted(GLSL.rglob("*.glsl")) if '#include "noise/hash.glsl"' in p.read_text())
    assert "stolen" not in read_source(borrowed, (tmp_path,)).code
    name = borrowed.relative_to(GLSL).as_posix()
    assert "stolen" not in read(write("main.glsl", f'#include "{name}"\n')).code


@pytest.mark.parametrize("name", ["a\0b.glsl", "x" * 5000, "a/" * 3000, ".", "..", "/", "~", "noise"])
def test_names_that_no_file_can_have_are_sentences(write, name):
    with pytest.raises(ShaderError):
        read(write("main.glsl", f'#include "{name}"\n'))


@pytest.mark.slow
def test_a_few_lines_cannot_fill_the_memory(write):
    for i in range(40):
        write(f"l{i}.glsl", f'#include "l{i + 1}.glsl"\n#include "l{i + 1}.glsl"\n')
    write("l20.glsl", "x\n")
    with pytest.raises(ShaderError, match="over and over"):
        read(write("main.glsl", '#include "l0.glsl"\n'))
    write("l20.glsl", '#include "l21.glsl"\n')
    write("l40.glsl", "")
    with pytest.raises(ShaderError, match=r"nested more than 32 deep|over and over"):
        read(write("main.glsl", '#include "l0.glsl"\n'))


def test_files_that_cannot_be_read_are_sentences(write, tmp_path):
    for path, words in (
        (tmp_path / "none.glsl", "no such file"),
        (tmp_path, "a folder"),
        (write("latin.glsl", b"// gr\xf6\xdfe\n"), "not UTF-8 text .byte 5."),
        (write("large.glsl", b" " * (8 * 2**20 + 1)), "larger than 8 MiB"),
    ):
        with pytest.raises(SketchError, match=words):
            read(path)
    refused(write("main.glsl", 'x\n#include "large.glsl"\n'), "'large.glsl': larger than", "main.glsl", 2)
    error = refused(write("main.glsl", 'x\n#include "latin.glsl"\n'), "not UTF-8", "latin.glsl", 1)
    assert [Path(position).name for position in error.diagnostics[0].chain] == ["main.glsl:2"]


# Values


def test_source_text_is_a_value_and_pickles_without_caches(write):
    path = write("main.glsl", "float a;\n")
    item, two = read(path), read(path)
    assert item == two and hash(item) == hash(two) and item.canonical
    plain = len(pickle.dumps(two))
    assert item.code and item.names and len(pickle.dumps(item)) == plain
    back = pickle.loads(pickle.dumps(item))
    assert back == item and hash(back) == hash(item) and back.code == item.code
    assert read(write("main.glsl", "float b;\n")) != item


def test_reading_imports_no_opengl():
    code = "import sys, playground.sketch.load; print(sorted({'numpy', 'moderngl', 'PIL'} & {*sys.modules}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_any_bytes_are_read_or_refused(write):
    rng = random.Random(6)
    write("lib.glsl", "x\n")
    for _ in range(1500):
        pieces = [b'#include "lib.glsl"', b"#include ", b"\\\n", b"/*", b"*/", b"//", b"\xc3\xa9"]
        pieces += [b'"', b"\n", b"\xff", b"\0", b"#pragma kernel("]
        text = b"".join(rng.choice(pieces) for _ in range(rng.randint(0, 25)))
        try:
            result = read(write("main.glsl", text))
        except PlaygroundError as error:
            assert error.diagnostics[0].file
        else:
            assert result.code.isascii() and len(result.lines) >= text.count(b"\n") + 1
