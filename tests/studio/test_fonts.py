"""Every character that the window may show is in the fonts that it loads."""

from __future__ import annotations

import ast
import re
import string
import unicodedata
from collections.abc import Iterator
from pathlib import Path

import imgui_bundle
import pytest
from imgui_bundle import imgui

from playground import rooms
from playground.studio.theme import Theme

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "playground"


@pytest.fixture(scope="module")
def theme() -> Iterator[Theme]:
    before, context = imgui.get_current_context(), imgui.create_context()
    imgui.set_current_context(context)
    yield Theme(Path(imgui_bundle.__file__).parent / "assets" / "fonts")
    imgui.destroy_context(context)
    if before is not None:
        imgui.set_current_context(before)


def constants(path: Path) -> Iterator[str]:
    """Yield the texts in a module that are not documentation, unless all of them are ASCII."""
    source = path.read_text(encoding="utf-8")
    code = re.sub(r"^\s*#.*$", "", source, flags=re.MULTILINE)
    if code.isascii() and not re.search(r"\\[uUxN]", code):
        return
    tree = ast.parse(source)
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


def missing(text: str, font: imgui.ImFont) -> str:
    seen = {c for c in text if unicodedata.category(c) not in ("Cc", "Cf", "Cs", "Zl", "Zp")}
    return " ".join(f"{c} U+{ord(c):04X}" for c in sorted(seen) if not font.is_glyph_in_font(ord(c)))


@pytest.mark.slow
def test_messages_and_labels_can_be_shown(theme: Theme):
    # Any module's: what the engine or a file's reader has to say appears in the panel.
    modules = [p for p in PACKAGE.rglob("*.py") if p.relative_to(PACKAGE).parts[0] not in rooms.ROOMS]
    text = string.printable + "".join(s for path in modules for s in constants(path))
    assert "→" in text
    for font in (theme.text, theme.bold, theme.italic):
        assert not missing(text, font)


def test_shaders_and_sketches_can_be_shown(theme: Theme):
    shipped = [path for path in (ROOT / "glsl").rglob("*") if path.suffix in (".glsl", ".comp", ".toml")]
    text = "".join(path.read_text(encoding="utf-8") for path in shipped)
    for font in (theme.text, theme.code):
        assert not missing(text, font)
