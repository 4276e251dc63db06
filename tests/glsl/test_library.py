"""Each library file introduces itself, compiles alone in every stage, and is pure."""

import re
from functools import cache

import moderngl
import pytest

from playground.paths import GLSL, SKETCHES
from playground.shader.header import parse_kernel
from playground.shader.source import read_source

from ..cases import each

TEXTS = sorted(
    p for p in GLSL.rglob("*") if p.suffix in (".glsl", ".comp") and not p.is_relative_to(SKETCHES)
)
NAMES = [p.relative_to(GLSL).as_posix() for p in TEXTS]
ASKED = re.compile(r"^(\w+) (\w+)\(([^()]*)\);$", re.MULTILINE)  # a function that the includer gives
FACTS = ("gives", "needs", "units", "source", "tested")
PURE = ("maths", "noise", "colour")


@cache
def pure_files():
    """Return the names of the files that others include: they hold no kernel."""
    return [n for n in NAMES if parse_kernel(n, read_source(GLSL / n, (GLSL,))) is None]


def parameter_blocks():
    """Return the names of those among them that hold parameters which several kernels share."""
    return [n for n in pure_files() if "/parameters/" in n]


def test_there_is_a_library():
    assert "noise/hash.glsl" in pure_files() and len(pure_files()) >= 5


@each("name", NAMES)
def test_it_introduces_itself(name):
    lines = (GLSL / name).read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith(f"// {name} -- ") and lines[0].endswith((".", "?")), (
        "the file's own name, then its sentence"
    )
    comment = []
    for line in lines:
        if not line.startswith("//"):
            break
        comment.append(line)
    facts = [m.group(1) for line in comment if (m := re.match(r"//   (\w+) +\S", line))]
    assert [f for f in facts if f in FACTS] == list(FACTS)


@each("name", NAMES)
def test_its_tests_are_there(name):
    tested = re.search(r"//   tested +(tests/\S+?\.py)", (GLSL / name).read_text(encoding="utf-8"))
    assert tested, "names the file that tests it"
    root = GLSL.parent
    if not (root / "tests").is_dir():
        pytest.skip("not a checkout")
    assert (root / tested.group(1)).is_file()


@each("name", lambda: [n for n in pure_files() if n not in parameter_blocks()])
def test_it_holds_no_state(name):
    """Nothing of it is a uniform, an input, an output or a buffer; a texture may come as an argument."""
    source = read_source(GLSL / name, (GLSL,))
    depth = 0
    for line in source.lines:
        if depth == 0:
            words = re.match(
                r"\s*(?:layout\s*\([^)]*\)\s*)?(uniform|in|out|buffer|shared|attribute|varying)\b", line.code
            )
            assert not words, f"{line.file}:{line.number}: {line.text}"
        depth += line.code.count("{") - line.code.count("}")
    if name.split("/")[0] in PURE:
        assert not any(word.startswith("sampler") for word in source.names)


@each("name", parameter_blocks)
def test_a_block_of_parameters_holds_nothing_else(name):
    source = read_source(GLSL / name, (GLSL,))
    code = [line.code for line in source.lines if line.code and not line.code.startswith("#")]
    assert code and all(line.startswith("uniform ") for line in code)
    assert all(line.comment.startswith("!") for line in source.lines if line.code.startswith("uniform "))


@each("name", NAMES)
def test_its_lines_can_be_quoted(name):
    lines = (GLSL / name).read_text(encoding="utf-8").splitlines()
    assert [f"{n}: {line}" for n, line in enumerate(lines, 1) if len(line) >= 100] == []


@each("name", pure_files)
def test_it_is_guarded(name):
    """Including it twice is including it once."""
    text = (GLSL / name).read_text(encoding="utf-8")
    guard = re.search(r"^#ifndef (\w+)\n#define \1$", text, re.MULTILINE)
    assert guard and text.rstrip().endswith("#endif")
    assert guard.group(1) == re.sub(r"\W", "_", name.removesuffix(".glsl")).upper()


def is_defined(function, code):
    """Return whether a text has a function's body, not only a prototype."""
    return bool(re.search(rf"\b{function}\([^;{{]*\) {{", code))


@pytest.mark.slow
@each("name", pure_files)
def test_it_compiles_alone(ctx, name):
    text, code = (GLSL / name).read_text(encoding="utf-8"), read_source(GLSL / name, (GLSL,)).code
    asked = [function for _, function, _ in ASKED.findall(text) if not is_defined(function, text)]
    assert bool(asked) == ("//   asks " in text)
    for kind, function, takes in ASKED.findall(code):
        if not is_defined(function, code):  # what it includes may ask what it gives
            code += f"{kind} {function}({takes}) {{ return {kind}(0); }}\n"
    quad = "#version 330\nvoid main() { gl_Position = vec4(0.0); }\n"
    for version in ("330", "430"):
        if ctx.version_code < int(version):
            continue
        fragment = f"#version {version}\n{code}\nout vec4 k_out;\nvoid main() {{ k_out = vec4(1.0); }}\n"
        ctx.program(vertex_shader=quad.replace("330", version), fragment_shader=fragment).release()
        vertex = f"#version {version}\n{code}\nvoid main() {{ gl_Position = vec4(0.0); }}\n"
        ctx.program(vertex_shader=vertex, varyings=["gl_Position"]).release()
    if ctx.version_code >= 430:
        compute = f"#version 430\nlayout(local_size_x = 1) in;\n{code}\nvoid main() {{ }}\n"
        ctx.compute_shader(compute).release()


def test_a_driver_takes_what_this_asks_of_it(ctx):
    """The check above can fail: a library file with a slip is refused."""
    with pytest.raises(moderngl.Error):
        ctx.program(
            vertex_shader="#version 330\nfloat f() { return g(); }\nvoid main() { gl_Position = vec4(f()); }"
        )
    _ = ctx.error


@pytest.mark.slow
def test_terrain_and_light_kernels_do_not_depend_on_camera():
    """A name that the engine gives makes a pass follow it, even where it names a variable or a field."""
    folders = ("generation/", "erosion/", "texturing/", "lighting/")
    follows = "texturing/alpha_map/distance.glsl"  # by its purpose
    maps = [n for n in NAMES if n.startswith(folders) and "/diagram/" not in n and n != follows]
    result = []
    for name in (*maps, "trees/wood.glsl", "trees/density.glsl", "trees/canopy.glsl"):
        kernel = parse_kernel(name, read_source(GLSL / name, (GLSL,)))
        if kernel is not None and kernel.kind != "draw":
            result += [(name, value) for value in ("eye", "clip_from_world") if kernel.reads(value)]
    assert not result
