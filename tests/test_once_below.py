"""What ``--once-below`` leaves out: tests below a folder, after their first parameters."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from .conftest import ROOT, pytest_collection_modifyitems


def left(items: list[str], *folders: str) -> tuple[list[str], list[str]]:
    """Return the tests that are run and those that are reported as left out."""
    made = [SimpleNamespace(nodeid=name, path=ROOT / Path(name.split("::")[0])) for name in items]
    out: list[SimpleNamespace] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: out.extend(items))
    config = SimpleNamespace(getoption=lambda name: list(folders), hook=hook)
    pytest_collection_modifyitems(config, made)  # type: ignore[arg-type]
    return [item.nodeid for item in made], [item.nodeid for item in out]


GLSL = ["tests/glsl/test_a.py::test[1]", "tests/glsl/test_a.py::test[2-[x]]", "tests/glsl/test_a.py::plain"]
OTHER = ["tests/glsl/test_b.py::test[2]", "tests/data/test_a.py::test[1]", "tests/data/test_a.py::test[2]"]


def test_without_it_all_run():
    assert left(GLSL + OTHER) == (GLSL + OTHER, [])


def test_functions_below_folder_run_once_and_others_fully():
    assert left(GLSL + OTHER, "tests/glsl") == ([GLSL[0], GLSL[2], *OTHER], [GLSL[1]])
    assert left(GLSL + OTHER, "tests/glsl", "tests/data") == (
        [GLSL[0], GLSL[2], *OTHER[:2]],
        [GLSL[1], OTHER[2]],
    )
