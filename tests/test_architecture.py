"""The project's shape, kept: imports point down and do nothing, the engine names no technique."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from .power import SUBJECTS

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "playground"

# Each may import from those on its own line and on the lines below. A room that is not there yet has
# its place already.
LAYERS = (
    ("__main__",),
    ("cli",),
    ("course",),
    ("flight",),
    ("lsp",),
    ("verify",),
    ("publish",),
    ("studio",),
    ("commands",),
    ("doctor", "terminal"),
    ("signals", "streams"),
    ("api",),
    ("dialects",),
    ("engine",),
    ("sketch",),
    ("shader",),
    ("data",),
    (
        "_version",
        "allowed_files",
        "errors",
        "extras",
        "files",
        "json_text",
        "local_server",
        "markup",
        "memo",
        "paths",
        "rooms",
    ),
)
LEVEL = {name: level for level, names in enumerate(LAYERS) for name in names}

# Where a technique's name is allowed in Python, and why.
NAMED = {
    "sketch": {"map", "terrain"},  # what shows a sketch that has no [view], or one without a use
    "studio": {"map"},  # shows any texture from above
}

# The lists of what is still to go: what is fixed is taken out of its list, and nothing is added.
CIRCLES: tuple[set[str], ...] = ()
UNCLEAR = ("beside", "drawn", "hasty", "kept", "lay", "mend", "pictures", "said", "same", "seen", "words")
UNCLEAR_MODULES: set[str] = set()
GLSL_IN_PYTHON: set[str] = set()


@cache
def modules() -> list[Path]:
    own = (p for p in PACKAGE.rglob("*.py") if not {"templates", "glsl"} & {*p.relative_to(PACKAGE).parts})
    return sorted(own)


def layer_of(path: Path) -> str:
    relative = path.relative_to(PACKAGE)
    return relative.parts[0] if len(relative.parts) > 1 else relative.stem


def imported(tree: ast.Module, path: Path) -> Iterator[tuple[int, str]]:
    """Yield (line, dotted name) of each import of our own, those inside functions included."""
    package = ("playground", *path.relative_to(PACKAGE).parts[:-1])
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) + "." if node.level else ""
            module = f"{base}{node.module or ''}".rstrip(".")
            if module == "playground":
                yield from ((node.lineno, f"playground.{alias.name}") for alias in node.names)
            else:
                yield node.lineno, module


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


ALONE = ("data", "shader")  # these two know nothing of the package but what stands below all rooms


def test_each_of_the_two_lowest_rooms_knows_no_other_room():
    wrong = []
    for path in modules():
        if (room := layer_of(path)) in ALONE:
            names = {name for _, name in imported(tree_of(path), path) if name.startswith("playground.")}
            others = {name for name in names if name.split(".")[1] in LEVEL.keys() - {room, *LAYERS[-1]}}
            wrong += [f"{path.relative_to(ROOT)} imports {name}" for name in sorted(others)]
    assert not wrong, "\n".join(wrong)


def test_every_module_has_its_layer():
    unknown = {layer_of(path) for path in modules()} - set(LEVEL) - {"__init__"}
    assert not unknown, f"LAYERS above has no place for {unknown}"


def test_imports_point_down():
    wrong = []
    for path in modules():
        layer = layer_of(path)
        for line, name in imported(tree_of(path), path):
            parts = name.split(".")
            if parts[0] != "playground" or layer == "__init__":
                continue
            target = parts[1] if len(parts) > 1 else "__init__"
            if target not in LEVEL:  # a name of the package itself
                target = "__init__"
            if target == "__init__" or LEVEL[target] < LEVEL[layer]:
                wrong.append(f"{path.relative_to(ROOT)}:{line} imports {name}, which lies above {layer}")
    assert not wrong, "\n".join(wrong)


def files_named(tree: ast.Module, path: Path, there: dict[str, Path]) -> set[Path]:
    """Return the files of our own that a module takes names from, wherever its imports are."""
    result = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            result |= {there[alias.name] for alias in node.names if alias.name in there}
        elif isinstance(node, ast.ImportFrom):
            package = ("playground", *path.relative_to(PACKAGE).parts[:-1])
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            module = ".".join(filter(None, (base, node.module)))
            for alias in node.names:
                file = there.get(f"{module}.{alias.name}") or there.get(module)
                result |= {file} if file else set()
    return result - {path}


def circles_of(takes: dict[Path, set[Path]]) -> list[set[Path]]:
    """Return the sets of files that reach each other, with more than one file."""
    files = sorted(takes)
    number = {file: i for i, file in enumerate(files)}
    rows, columns = zip(*((number[a], number[b]) for a in files for b in takes[a]), strict=True)
    shape = (len(files), len(files))
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=shape)
    count, labels = connected_components(graph, connection="strong")
    rooms = [{files[i] for i in np.flatnonzero(labels == n)} for n in range(count)]
    return [room for room in rooms if len(room) > 1]


def test_no_files_import_each_other_in_a_circle():
    """Imports for type checkers and inside functions count too: they hide a circle, they do not open it."""
    there = {}
    for path in modules():
        name = path.relative_to(PACKAGE.parent).with_suffix("").as_posix().replace("/", ".")
        there[name.removesuffix(".__init__")] = path
    circles = circles_of({path: files_named(tree_of(path), path, there) for path in modules()})
    named = [{path.relative_to(PACKAGE).as_posix() for path in circle} for circle in circles]
    new = [" ↔ ".join(sorted(circle)) for circle in named if circle not in CIRCLES]
    assert not new, "import each other in a circle:\n" + "\n".join(new)
    gone = [" ↔ ".join(sorted(circle)) for circle in CIRCLES if circle not in named]
    assert not gone, "are no circle any more, take them out of CIRCLES:\n" + "\n".join(gone)


def test_the_lowest_layers_import_no_opengl():
    """Sketches are text and numbers: they load where there is no OpenGL, no window, no imgui."""
    barred = {"moderngl", "glfw", "imgui_bundle", "glcontext"}
    for path in modules():
        if layer_of(path) in ("shader", "sketch", "data", "errors", "paths", "__init__"):
            result = {name.split(".")[0] for _, name in imported(tree_of(path), path)} & barred
            assert not result, f"{path.relative_to(ROOT)} imports {result}"


@pytest.mark.slow
def test_only_four_rooms_have_a_window():
    for path in modules():
        if layer_of(path) not in ("studio", "publish", "flight", "course"):
            tops = {name.split(".")[0] for _, name in imported(tree_of(path), path)}
            assert not tops & {"glfw", "imgui_bundle"}, path


FRESH = """
import sys
import playground
slow = {"moderngl", "glcontext", "glfw", "numpy", "imgui_bundle", "PIL", "pyrr", "typer", "rich"}
heavy = sorted(slow & set(sys.modules))
print(",".join(heavy), playground.__version__)
"""


def test_importing_loads_nothing_that_is_slow():
    done = subprocess.run(
        [sys.executable, "-c", FRESH],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    heavy, _version = done.stdout.rstrip("\n").split(" ")
    assert heavy == "", f"importing playground imports {heavy}"


RARE = """
import sys
import playground
from playground.engine import disk_cache, engine
from playground.studio.picture import disk_caching
from playground.studio import session
playground.load("jacksboro")
disk_cache.tool()
"""
WINDOW = """
import sys
import playground.studio.app
"""
PRINTED = """
readers = "playground.dialects"
print(",".join(name for name in sys.modules if name in rare or name.startswith(readers)))
"""
OF_MISTAKES = ["playground.shader.driver_log"]
OF_LESSONS = [
    "playground.course.window.panel",
    "playground.course.talk.slide",
    "latex2mathml",
    "markdown_it",
    "PIL",
    "pygments",
]


@pytest.mark.parametrize(
    ("opened", "rare"),
    [(RARE, [*OF_MISTAKES, "importlib.metadata", "email"]), (WINDOW, [*OF_MISTAKES, *OF_LESSONS])],
    ids=["sketch", "window"],
)
def test_start_imports_no_module_of_errors_lessons_or_dialects(opened, rare):
    """They take a fifth of the time that the imports of a first picture take, and a third of a window's."""
    done = subprocess.run(
        [sys.executable, "-c", f"{opened}rare = {rare}{PRINTED}"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == ""


def test_every_public_name_comes_from_its_listed_module():
    """The table that is run, the imports that type checkers read, and what is there, are the same."""
    import playground

    tree = tree_of(PACKAGE / "__init__.py")
    block = next(n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    typed = [(a.asname, a.name, n.module) for n in block.body for a in n.names]
    assert sorted(typed) == sorted((name, name, home) for name, home in playground._HOMES.items())
    assert set(playground.__all__) == {*playground._HOMES, "__version__"} == set(dir(playground))
    for name, home in playground._HOMES.items():
        result = getattr(playground, name)
        assert (result.__module__, result.__name__) == (home, name)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = playground.nothing


def techniques() -> set[str]:
    """Return the names that techniques go by: their files' stems, long enough to be no accident."""
    names: set[str] = set()
    for folder in ("generation", "simulation", "texturing", "lighting", "view"):
        names |= {
            p.stem for p in (ROOT / "glsl" / folder).glob("*") if p.suffix in (".glsl", ".toml", ".comp")
        }
    return names


def documented(tree: ast.Module) -> set[int]:
    """Return the identities of the strings that are docstrings: prose may name what it likes."""
    numbers = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            numbers.add(id(node.value))
    return numbers


def test_the_engine_names_no_technique():
    """A technique is a file in glsl/: Python that knew one by name would have to change with it."""
    names, wrong = techniques(), []
    assert names, "the library is there"
    for path in modules():
        tree = tree_of(path)
        prose = documented(tree)
        allowed = NAMED.get(layer_of(path), set())
        for node in ast.walk(tree):
            if not isinstance(node, ast.Constant) or not isinstance(node.value, str) or id(node) in prose:
                continue
            for text in (node.value, *re.findall(r'^\s*use\s*=\s*"([^"]*)"', node.value, re.MULTILINE)):
                last = text.removesuffix(".glsl").removesuffix(".toml").rpartition("/")[2]
                is_path = "/" in text
                if last in names - allowed and (is_path or "_" in last):
                    wrong.append(f"{path.relative_to(ROOT)}:{node.lineno} names {text!r}")
    assert not wrong, "\n".join(wrong)


def test_one_module_chooses_what_a_software_renderer_gains_by():
    """What is done otherwise there is in one module, behind the ``Tuning`` that an engine is made with."""
    naming = [
        path.relative_to(PACKAGE).as_posix()
        for path in modules()
        if any(name.startswith("playground.engine.software") for _, name in imported(tree_of(path), path))
    ]
    assert naming == ["engine/renderer.py"]


def test_a_module_is_named_by_what_it_does():
    """These words say nothing to who has not read the file."""
    paths = {p.relative_to(PACKAGE).as_posix() for p in modules() if p.stem in UNCLEAR}
    paths |= {
        p.relative_to(PACKAGE).as_posix() + "/"
        for p in PACKAGE.rglob("*")
        if p.is_dir() and p.name in UNCLEAR and "node_modules" not in p.parts
    }
    shrinks("UNCLEAR_MODULES", paths, UNCLEAR_MODULES, "has a name that says nothing")


def shrinks(name: str, names: set[str], allowed: set[str], what: str) -> None:
    """Fail for what is new, and for what is allowed and no longer there."""
    assert not names - allowed, "\n".join(f"{file} {what}" for file in sorted(names - allowed))
    assert not allowed - names, f"take out of {name}: {', '.join(sorted(allowed - names))}"


# A whole shader, or a part of one: lines of GLSL. What is put together from names (a wrapper's
# `uniform` for each output, one `main` for each kind of kernel) has no file to be in.
SHADER = re.compile(
    r"^#version|^\s*(?:in|out|uniform|flat|varying|attribute) \w+ \w+.*;"
    r"|^\s*(?:void|float|[iu]?vec[234]) \w+\(.*\{",
    re.MULTILINE,
)


def shaders_in(tree: ast.Module) -> Iterator[int]:
    """Yield the line of each string of three lines and more that is GLSL."""
    prose = documented(tree)
    for node in ast.walk(tree):
        is_text = isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose
        if is_text and node.value.count("\n") > 2 and SHADER.search(node.value):
            yield node.lineno


def test_shaders_stand_in_files():
    """In a file every tool of GLSL reads it, the line table knows it, and it can be edited live."""
    paths = {p.relative_to(PACKAGE).as_posix() for p in modules() if any(shaders_in(tree_of(p)))}
    shrinks("GLSL_IN_PYTHON", paths, GLSL_IN_PYTHON, "has a shader in a string")


def test_nothing_must_be_edited_in_two_places():
    """What two places say has one home, or a test that they agree."""
    wrong = []
    asks = re.compile(r"\bmust match\b|\bkeep (?:this |these |it )?in (?:sync|step)\b|\bsame as in\b", re.I)
    for path in (*PACKAGE.rglob("*"), *(ROOT / "glsl").rglob("*")):
        if (
            path.suffix not in (".py", ".js", ".css", ".glsl", ".comp", ".toml")
            or "node_modules" in path.parts
        ):
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            comment = re.search(r"(?:#|//|/\*)(.*)", line)
            if comment and asks.search(comment[1]):
                wrong.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert not wrong, "\n".join(wrong)


def test_a_test_has_a_name_of_at_most_60_letters():
    wrong = [
        f"{path.relative_to(ROOT)}: {node.name}"
        for path in filter(Path.is_file, (ROOT / "tests").rglob("test_*.py"))
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and len(node.name) > 60
    ]
    assert not wrong, "\n".join(wrong)


def test_the_modules_whose_tests_are_measured_exist():
    assert not [file for files in SUBJECTS.values() for file in files if not (ROOT / file).is_file()]


def test_the_checks_above_can_fail():
    tree = ast.parse("from playground.engine import engine\ndef f():\n    import playground.studio.app\n")
    path = PACKAGE / "sketch" / "made_up.py"
    assert [name for _, name in imported(tree, path)] == ["playground.engine", "playground.studio.app"]
    relative = ast.parse("from ..engine import plan\nfrom . import model\n")
    assert [name for _, name in imported(relative, path)] == ["playground.engine", "playground.sketch"]
    a, b, c = PACKAGE / "a.py", PACKAGE / "b.py", PACKAGE / "c.py"
    late = ast.parse("if TYPE_CHECKING:\n    from playground import b\ndef f():\n    from .c import x\n")
    assert files_named(late, a, {"playground.b": b, "playground.c": c}) == {b, c}
    assert circles_of({a: {b}, b: {a, c}, c: set()}) == [{a, b}]
    text = 'A = """#version 330\nout vec4 x;\nvoid main() {\n}\n"""\nB = f"void main() {{ {A} }}"\n'
    assert list(shaders_in(ast.parse(text))) == [1]
