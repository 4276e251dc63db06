"""Only panels and the modules of the window draw; the session and the state of features need no screen."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import playground

ROOT = Path(playground.__file__).resolve().parent
STUDIO = ROOT / "studio"
SCREEN = {"imgui_bundle", "glfw"}
WINDOW = {
    "app",
    "cursor",
    "draw",
    "focus",
    "guard",
    "key_queue",
    "keymap_panel",
    "keys",
    "mouse",
    "overlay",
    "panes",
    "status",
    "theme",
}
WINDOW |= {"settings_panel", "widgets", "window"}
"""Modules at the top of the studio that may draw."""


def draws(path: Path) -> bool:
    """Return whether a module may import Dear ImGui or GLFW."""
    return path.stem.endswith("panel") or (path.parent == STUDIO and path.stem in WINDOW)


def imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.partition(".")[0]


def test_only_panels_and_the_window_import_dear_imgui() -> None:
    importing = {path for path in STUDIO.rglob("*.py") if SCREEN.intersection(imports(path))}
    assert not [path for path in importing if not draws(path)]
    assert {path.stem for path in importing if path.parent == STUDIO} == WINDOW, "the list is up to date"


def test_all_else_is_imported_without_them() -> None:
    """In a process of its own, also where one module imports another that would import them."""
    states = [path for path in sorted(STUDIO.rglob("*.py")) if not draws(path)]
    names = [".".join(path.relative_to(ROOT.parent).with_suffix("").parts) for path in states]
    assert {"playground.studio.session", "playground.studio.bench"} < set(names)
    import_without(SCREEN, names)


def import_without(barred: set[str], names: list[str]) -> None:
    code = f"import importlib, sys\nsys.modules.update(dict.fromkeys({sorted(barred)!r}))\n"
    code += "for name in sys.argv[1:]: importlib.import_module(name)\n"
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
