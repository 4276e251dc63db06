"""The project's shape, kept: imports point down and do nothing, the engine names no technique."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "playground"

# Each may import from those on its own line and on the lines below.
LAYERS = (
    ("__main__",),
    ("cli",),
    ("commands",),
    ("terminal",),
    ("signals", "streams"),
    ("live",),
    ("workbench",),
    ("reduce",),
    ("shots",),
    ("lessons",),
    ("capture", "flight", "templates"),
    ("api",),
    ("engine",),
    ("process",),
    ("gpu",),
    ("terrain",),
    ("images",),
    ("sketch",),
    ("errors", "folders", "json_text", "markup", "partial", "paths", "_version"),
)
LEVEL = {name: level for level, names in enumerate(LAYERS) for name in names}
LONGEST = 500

# Where a technique's name is allowed in Python, and why.
NAMED = {
    "sketch": {"map", "terrain"},  # what shows a sketch that has no [view], or one without a use
    "workbench": {"map"},  # shows any texture from above
}


def modules() -> list[Path]:
    return sorted(p for p in PACKAGE.rglob("*.py") if "templates" not in p.parts and "glsl" not in p.parts)


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


def test_every_module_has_its_layer():
    unknown = {layer_of(path) for path in modules()} - set(LEVEL) - {"__init__"}
    assert not unknown, f"LAYERS above has no place for {unknown}"


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_down(path):
    layer = layer_of(path)
    wrong = []
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


def test_the_lowest_layers_import_no_opengl():
    """Sketches are text and numbers: they load where there is no OpenGL, no window, no imgui."""
    barred = {"moderngl", "glfw", "imgui_bundle", "glcontext"}
    for path in modules():
        if layer_of(path) in ("sketch", "terrain", "images", "errors", "paths", "__init__"):
            found = {name.split(".")[0] for _, name in imported(tree_of(path), path)} & barred
            assert not found, f"{path.relative_to(ROOT)} imports {found}"


def test_only_live_has_a_window():
    for path in modules():
        if layer_of(path) != "live":
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


def test_every_public_name_comes_from_the_home_that_it_is_said_to_have():
    """The table that is run, the imports that type checkers read, and what is there, are the same."""
    import playground

    tree = tree_of(PACKAGE / "__init__.py")
    block = next(n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    typed = [(a.asname, a.name, n.module) for n in block.body for a in n.names]
    assert sorted(typed) == sorted((name, name, home) for name, home in playground._HOMES.items())
    assert set(playground.__all__) == {*playground._HOMES, "__version__"} == set(dir(playground))
    for name, home in playground._HOMES.items():
        found = getattr(playground, name)
        assert (found.__module__, found.__name__) == (home, name)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = playground.nothing


def techniques() -> set[str]:
    """Return the names that techniques go by: their files' stems, long enough to be no accident."""
    found: set[str] = set()
    for folder in ("generation", "texturing", "lighting", "view"):
        found |= {
            p.stem for p in (ROOT / "glsl" / folder).glob("*") if p.suffix in (".glsl", ".toml", ".comp")
        }
    return found


def documented(tree: ast.Module) -> set[int]:
    """Return the identities of the strings that are docstrings: prose may name what it likes."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found.add(id(node.value))
    return found


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
            last = node.value.removesuffix(".glsl").removesuffix(".toml").rpartition("/")[2]
            is_path = "/" in node.value
            if last in names - allowed and (is_path or "_" in last):
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno} names {node.value!r}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_module_introduces_itself_and_is_no_longer_than_it_should_be(path):
    text = path.read_text(encoding="utf-8")
    assert ast.get_docstring(tree_of(path)), f"{path.relative_to(ROOT)} has no docstring"
    assert text.count("\n") <= LONGEST, f"{path.relative_to(ROOT)} has more than {LONGEST} lines"


def undocumented(body: list[ast.stmt], prefix: str) -> Iterator[str]:
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            if node.name.startswith("_"):
                continue
            if not ast.get_docstring(node):
                yield f"{prefix}{node.name}"
            if isinstance(node, ast.ClassDef):
                yield from undocumented(node.body, f"{prefix}{node.name}.")


def test_what_is_public_is_documented():
    missing = []
    for path in modules():
        missing += [f"{path.relative_to(ROOT)}: {name}" for name in undocumented(tree_of(path).body, "")]
    assert not missing, "\n".join(missing)


def test_only_the_command_prints():
    """A function that prints and returns cannot be used by another program."""
    wrong = []
    for path in modules():
        if layer_of(path) in ("cli", "commands", "terminal", "__main__"):
            continue
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert not wrong, f"print in {', '.join(wrong)}"


def test_nothing_is_evaluated():
    """A sketch is data: no way leads from its text to Python's own evaluation."""
    wrong = []
    for path in modules():
        for node in ast.walk(tree_of(path)):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in ("eval", "exec")
            ):
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert not wrong, f"eval or exec in {', '.join(wrong)}"


def test_the_checks_above_can_fail():
    tree = ast.parse("from playground.engine import engine\ndef f():\n    import playground.live.app\n")
    path = PACKAGE / "sketch" / "made_up.py"
    assert [name for _, name in imported(tree, path)] == ["playground.engine", "playground.live.app"]
    relative = ast.parse("from ..engine import plan\nfrom . import model\n")
    assert [name for _, name in imported(relative, path)] == ["playground.engine", "playground.sketch"]
    assert list(
        undocumented(ast.parse("def f(): pass\nclass A:\n    'x'\n    def g(self): pass\n").body, "")
    ) == ["f", "A.g"]
