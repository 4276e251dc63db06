"""The clipboard's text, before there is a window."""

from __future__ import annotations

import os
import sys
from typing import Any

import imgui_bundle  # noqa: F401  # before glfw, so that both use one GLFW library

# isort: split
import glfw

from playground.engine.driver_advice import advice
from playground.errors import ContextError


def clipboard_text() -> str:
    """Return the text on the clipboard, "" where there is none; raise ``ContextError`` without a display."""
    glfw.ERROR_REPORTING = "ignore"  # an empty clipboard is an error for GLFW
    if not glfw.init():
        raise ContextError(advice("glfw.init failed", sys.platform, os.environ))
    try:
        no_window: Any = None
        data: Any = glfw.get_clipboard_string(no_window)  # bytes, or None
        return data.decode("utf-8", "replace") if data else ""
    finally:
        glfw.terminate()
