"""The runtime's shape, kept: modules without a circle, which introduce themselves."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from .node import RUNTIME

MAX_COLUMNS = 110
EDITORS = ("code_field.js", "glsl_language.js")
"""The modules that import CodeMirror."""
IMPORT = re.compile(r'^(?:import |(?:import|export)\b[^;"]*?\bfrom )"([^"]+)";', re.MULTILINE)
# What makes code or markup of a text: a page's policy forbids the first, and texts of sketches are anyone's.
UNSAFE = re.compile(
    r"\beval\(|\bnew Function\b|\b(?:inner|outer)HTML\b|\binsertAdjacentHTML\b|\bdocument\.write"
)


@cache
def modules() -> dict[str, str]:
    """Return the modules' texts by name."""
    return {path.name: path.read_text("utf-8") for path in sorted(RUNTIME.glob("*.js"))}


def without_comments(text: str) -> str:
    return re.sub(r"/\*[\s\S]*?\*/|^\s*//.*$", "", text, flags=re.MULTILINE)


def test_a_module_begins_with_what_it_does():
    wrong = [name for name, text in modules().items() if not text.startswith(f"// {name} -- ")]
    assert not wrong


def test_a_module_is_no_wider_than_it_should_be():
    wide = [
        f"{name}:{number}"
        for name, text in modules().items()
        for number, line in enumerate(text.split("\n"), 1)
        if len(line) > MAX_COLUMNS
    ]
    assert not wide


def test_modules_import_other_modules_without_cycles():
    names = {
        name: [Path(path).name for path in IMPORT.findall(without_comments(text))]
        for name, text in modules().items()
    }
    assert sum(map(len, names.values())) > 10
    for name, text in modules().items():
        paths = IMPORT.findall(without_comments(text))
        outside = [path for path in paths if not path.startswith("./")]
        assert not outside or name in EDITORS, name
    left = dict(names)
    while free := [name for name, imports in left.items() if not left.keys() & set(imports)]:
        for name in free:
            del left[name]
    assert not left, f"import each other in a circle: {', '.join(left)}"


def test_no_module_makes_code_or_markup_of_text():
    wrong = [name for name, text in modules().items() if UNSAFE.search(without_comments(text))]
    assert not wrong
