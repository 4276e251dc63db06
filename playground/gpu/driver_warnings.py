"""Read a driver's warnings of a text that compiles, which moderngl does not give.

Mesa reports nothing of a text that it finds in its cache on disk, so each stage is compiled
once more, with a comment at its end that no cache can know, and thrown away.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from playground.errors import Diagnostic
from playground.gpu.program import diagnostic_of
from playground.gpu.wrap import Wrapped

if TYPE_CHECKING:
    import moderngl

_MOST = 64 * 1024  # bytes of a log
_STAGES = {"vertex": 0x8B31, "fragment": 0x8B30, "compute": 0x91B9}

_UINT, _INT = ctypes.c_uint, ctypes.c_int
_AT = ctypes.POINTER


def warnings_of(ctx: moderngl.Context, wrapped: Wrapped) -> tuple[Diagnostic, ...]:
    """Return what a driver warns of in a kernel's text, in the kernel's own files.

    Only what is at a line of the files, not of what the wrapper adds. Empty where the text
    does not compile, and where OpenGL's functions cannot be reached: they are taken from where
    moderngl takes them, which is not part of its interface.
    """
    from playground.gpu.driver_log import parse_log

    load = getattr(getattr(ctx.mglo, "_context", None), "load_opengl_function", None)
    found: dict[tuple[str, int, str], Diagnostic] = {}
    if load is None:
        return ()
    for name, stage in wrapped.stages.items():
        if not stage.first:  # none of it is the author's
            continue
        for entry in parse_log(_log(load, _STAGES[name], f"{stage.text}// {time.time_ns()}\n")):
            if entry.severity == "error":
                return ()
            if wrapped.kernel.kind == "plain_fragment" and "uninitialized" in entry.message:
                continue  # it begins at 0: see zero_values
            if stage.locate(entry.line) is not None:
                diagnostic = diagnostic_of(entry, stage, wrapped)
                found.setdefault((diagnostic.file, diagnostic.line, diagnostic.message), diagnostic)
    return tuple(found.values())


def _log(load: Callable[[str], int], kind: int, text: str) -> str:
    """Compile a text, return the driver's log, and leave nothing behind."""

    def function(name: str, result: Any, *types: Any) -> Any:
        address = load(name)
        return ctypes.CFUNCTYPE(result, *types)(address) if address else None

    create = function("glCreateShader", _UINT, _UINT)
    source = function("glShaderSource", None, _UINT, _INT, _AT(ctypes.c_char_p), _AT(_INT))
    build = function("glCompileShader", None, _UINT)
    read = function("glGetShaderInfoLog", None, _UINT, _INT, _AT(_INT), ctypes.c_char_p)
    delete = function("glDeleteShader", None, _UINT)
    if None in (create, source, build, read, delete):
        return ""
    shader = create(kind)
    if not shader:
        return ""
    log = ctypes.create_string_buffer(_MOST)
    source(shader, 1, ctypes.byref(ctypes.c_char_p(text.encode())), None)
    build(shader)
    read(shader, _MOST, None, log)
    delete(shader)
    return log.value.decode("utf-8", "replace")
