"""What a driver says of a program that it takes: its warnings, which moderngl keeps to itself."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from playground.errors import Diagnostic
from playground.gpu.logs import parse_log
from playground.gpu.program import diagnostic_of
from playground.gpu.wrap import Wrapped

if TYPE_CHECKING:
    import moderngl

_MOST = 64 * 1024  # bytes of a log
_MOST_STAGES = 6
_STAGES = {0x8B31: "vertex", 0x8B30: "fragment", 0x91B9: "compute"}
_SHADER_TYPE = 0x8B4F

_UINT, _INT = ctypes.c_uint, ctypes.c_int
_AT = ctypes.POINTER


def warnings_of(ctx: moderngl.Context, compiled: object, wrapped: Wrapped) -> tuple[Diagnostic, ...]:
    """Return the warnings in the logs of a program's stages, in the kernel's own files.

    Only those at a line that the kernel's author wrote. Empty where the logs cannot be read:
    OpenGL's functions are asked of whatever moderngl asks, which is not among its promises.
    """
    load = getattr(getattr(ctx.mglo, "_context", None), "load_opengl_function", None)
    number = getattr(compiled, "glo", 0)
    if load is None or not number:
        return ()
    found: dict[tuple[str, int, str], Diagnostic] = {}
    for kind, log in _logs(load, number):
        stage = wrapped.stages.get(_STAGES.get(kind, ""))
        for entry in parse_log(log) if stage is not None else ():
            if entry.severity == "warning" and stage is not None and stage.locate(entry.line) is not None:
                diagnostic = diagnostic_of(entry, stage, wrapped)
                found.setdefault((diagnostic.file, diagnostic.line, diagnostic.message), diagnostic)
    return tuple(found.values())


def _logs(load: Callable[[str], int], number: int) -> list[tuple[int, str]]:
    """Return (type, log) of each shader attached to a program."""

    def function(name: str, *types: Any) -> Any:
        address = load(name)
        return ctypes.CFUNCTYPE(None, *types)(address) if address else None

    attached = function("glGetAttachedShaders", _UINT, _INT, _AT(_INT), _AT(_UINT))
    get = function("glGetShaderiv", _UINT, _UINT, _AT(_INT))
    read = function("glGetShaderInfoLog", _UINT, _INT, _AT(_INT), ctypes.c_char_p)
    if attached is None or get is None or read is None:
        return []
    count, shaders = _INT(), (_UINT * _MOST_STAGES)()
    attached(number, _MOST_STAGES, ctypes.byref(count), shaders)
    logs = []
    for shader in shaders[: count.value]:
        kind, text = _INT(), ctypes.create_string_buffer(_MOST)
        get(shader, _SHADER_TYPE, ctypes.byref(kind))
        read(shader, _MOST, None, text)
        logs.append((kind.value, text.value.decode("utf-8", "replace")))
    return logs
