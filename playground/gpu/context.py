"""Open an OpenGL context with no window, and say what it can do.

EGL on Linux (no display and no GPU needed), a hidden native context elsewhere. Versions
4.3, 4.1 and 3.3 are asked for in turn; compute shaders exist from 4.3 on.
"""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import ContextError
from playground.gpu.mend import mend

if TYPE_CHECKING:
    import moderngl

VERSIONS = (430, 410, 330)
_SOFTWARE = re.compile(r"llvmpipe|softpipe|swrast|software|SwiftShader|Microsoft Basic Render", re.IGNORECASE)
_MESA_VENDOR = Path("/usr/share/glvnd/egl_vendor.d/50_mesa.json")


@dataclass(frozen=True, slots=True)
class ContextInfo:
    """What a context is."""

    version_code: int  # 450 is OpenGL 4.5
    renderer: str
    vendor: str
    version: str
    max_texture: int  # texels a side
    max_samples: int

    @property
    def compute(self) -> bool:
        """Whether there are compute shaders."""
        return self.version_code >= 430

    @property
    def software(self) -> bool:
        """Whether the processor draws, so that timer queries mean nothing."""
        return bool(_SOFTWARE.search(self.renderer))

    @property
    def slug(self) -> str:
        """A folder's name for the renderer, the same for every build of it: "llvmpipe", "nvidia-h200"."""
        name = re.sub(r"\(.*?\)|/.*$", "", self.renderer)
        if _SOFTWARE.search(name):
            name = name.split()[0]
        return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "unknown"


def context_info(ctx: moderngl.Context) -> ContextInfo:
    """Read what a context is."""
    info = ctx.info
    return ContextInfo(
        ctx.version_code,
        str(info["GL_RENDERER"]),
        str(info["GL_VENDOR"]),
        str(info["GL_VERSION"]),
        int(info["GL_MAX_TEXTURE_SIZE"]),
        int(ctx.max_samples),
    )


def open_context(*, software: bool = False, device: int | None = None) -> moderngl.Context:
    """Open a context with no window.

    ``software`` asks for the processor's renderer (Mesa llvmpipe); ``device`` picks the
    EGL device by its number. Raises ``ContextError`` with the known failure's mend.
    """
    import moderngl

    if software:
        prefer_software()
    options: dict[str, object] = {"standalone": True}
    if sys.platform.startswith("linux"):
        options["backend"] = "egl"
        if device is not None:
            options["device_index"] = device
    elif device is not None:
        raise ContextError("--device picks an EGL device, which only Linux has")
    causes: list[str] = []
    for version in VERSIONS:
        try:
            ctx = moderngl.create_context(require=version, **options)
        except Exception as error:  # moderngl and glcontext raise bare Exception, ValueError, RuntimeError
            causes.append(str(error))
            continue
        ctx.gc_mode = "auto"
        if software and not context_info(ctx).software:
            renderer = context_info(ctx).renderer
            ctx.release()
            raise ContextError(f"--software was asked for, but OpenGL gave {renderer}; is Mesa's llvmpipe installed?")
        return ctx
    raise ContextError(mend(causes[0], sys.platform, os.environ))


def adopt_context() -> moderngl.Context:
    """Return the context that a window has made current, asking for the highest version it has."""
    import moderngl

    ctx = moderngl.create_context(require=330)
    ctx.gc_mode = "auto"
    return ctx


def prefer_software() -> None:
    """Ask Mesa for the processor's renderer, for contexts opened from now on in this process and its children."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    os.environ.setdefault("GALLIUM_DRIVER", "llvmpipe")
    if _MESA_VENDOR.is_file():
        os.environ["__EGL_VENDOR_LIBRARY_FILENAMES"] = str(_MESA_VENDOR)
