"""Report what this machine offers: an OpenGL context, its limits, a display, the packages.

It opens a context and releases it; what is missing is reported in a message, with the advice for it.
"""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from importlib import metadata
from typing import TYPE_CHECKING

from playground._version import __version__
from playground.engine.context import ContextInfo, context_info, open_context, release_context
from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl

PACKAGES = (
    "moderngl", "glcontext", "glfw", "imgui-bundle", "numpy", "pillow", "pyrr", "rasterio", "rich",
    "tifffile", "typer", "watchfiles",
)  # fmt: skip
_LIMITS = {
    "texture, texels a side": "GL_MAX_TEXTURE_SIZE",
    "textures in a shader": "GL_MAX_TEXTURE_IMAGE_UNITS",
    "outputs of a kernel": "GL_MAX_DRAW_BUFFERS",
    "samples": "GL_MAX_SAMPLES",
    "work group, invocations": "GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS",
    "storage block, bytes": "GL_MAX_SHADER_STORAGE_BLOCK_SIZE",
}
_SSH = ("SSH_CONNECTION", "SSH_CLIENT", "SSH_TTY")


@dataclass(frozen=True)
class Health:
    """What a machine offers."""

    trouble: str  # why there is no context, and the advice; "" where there is one
    context: ContextInfo | None
    limits: dict[str, int] = field(default_factory=dict)
    display: str = ""  # where a window would open; "": nowhere
    system: str = ""
    python: str = ""
    packages: dict[str, str] = field(default_factory=dict)  # name → version, "" where it is missing

    @property
    def ok(self) -> bool:
        """Whether pictures can be made."""
        return self.context is not None

    def as_json(self) -> dict[str, object]:
        """Return it as JSON takes it."""
        values = {"ok": self.ok, **asdict(self), "playground": __version__}
        if self.context is not None:
            values["context"] |= {"compute": self.context.compute, "software": self.context.software}
        return values


def examine(*, software: bool = False, device: int | None = None) -> Health:
    """Open a context as a headless picture would, and report; never raises for a missing one."""
    trouble, info, limits = "", None, {}
    try:
        ctx = open_context(software=software, device=device)
    except ContextError as error:
        trouble = str(error)
    except ImportError as error:  # a missing system library shows when moderngl's own are loaded
        trouble = f"moderngl cannot be loaded: {error}"
    else:
        info, limits = context_info(ctx), _limits(ctx)
        release_context(ctx)
    packages = {name: _version(name) for name in PACKAGES}
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    display = where_to_show(os.environ, sys.platform)
    return Health(trouble, info, limits, display, system, platform.python_version(), packages)


def where_to_show(environ: Mapping[str, str], system: str) -> str:
    """Return where a window would open, or "" where there is no display.

    ``system`` is ``sys.platform``. On Linux DISPLAY or WAYLAND_DISPLAY says so; macOS and
    Windows always have a desktop, but not over ssh and not on a build machine.
    """
    if system in ("darwin", "win32"):
        built = environ.get("CI", "").lower() not in ("", "0", "false")
        away = built or any(environ.get(name) for name in _SSH)
        return "" if away else "the desktop"
    if environ.get("WAYLAND_DISPLAY"):
        return f"Wayland {environ['WAYLAND_DISPLAY']}"
    return f"X11 {environ['DISPLAY']}" if environ.get("DISPLAY") else ""


def _limits(ctx: moderngl.Context) -> dict[str, int]:
    info = ctx.info
    limits = {}
    for name, key in _LIMITS.items():
        value = info.get(key, 0)
        if isinstance(value, int) and value > 0:
            limits[name] = value
    limits["samples"] = ctx.max_samples
    return limits


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""
