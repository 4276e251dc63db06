"""OpenGL contexts without a window: what each can do, and which build of a renderer draws.

EGL on Linux (no display and no GPU needed), a hidden native context elsewhere. Versions
4.3, 4.1 and 3.3 are tried in this order; compute shaders exist from 4.3 on.

Of a software renderer, the processor is part of the build: reciprocal square
roots are estimated, and the estimates of Intel and AMD differ; with `fma` a product and a sum
are rounded once, not twice; with `f16c` half floats are rounded by the processor.
"""

from __future__ import annotations

import ctypes.util
import gc
import os
import platform
import re
import sys
import threading
import warnings
import weakref
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from playground.engine.driver_advice import advice
from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl


VERSIONS = (430, 410, 330)
_MAX_DEVICES = 15
_SOFTWARE = re.compile(r"llvmpipe|softpipe|swrast|software|SwiftShader|Microsoft Basic Render", re.IGNORECASE)
_OTHER_DEVICES = re.compile(r"requested device index -?\d+, but found ([1-9]\d*)")  # glcontext's words
_MESA_VENDOR = Path("/usr/share/glvnd/egl_vendor.d/50_mesa.json")
_MAX_UNCOLLECTED = 3  # contexts of a thread, from which on garbage is collected before one more is opened
_QUEUED = "context_gc"  # moderngl's mode in which dropped objects stay in ``Context.objects``
_opened: weakref.WeakKeyDictionary[moderngl.Context, tuple[weakref.finalize[..., Any], _Made]] = (
    weakref.WeakKeyDictionary()
)
_lock = threading.RLock()  # of ``_opened``: every thread may have contexts
_dropped: deque[_Made] = deque()  # contexts to destroy, each in its own thread


@dataclass(frozen=True, slots=True)
class ContextInfo:
    """What a context is."""

    version_code: int  # 450 is OpenGL 4.5
    renderer: str
    vendor: str
    version: str
    max_samples: int

    @property
    def opengl(self) -> str:
        """The version in words: "OpenGL 4.5"."""
        return f"OpenGL {self.version_code // 100}.{self.version_code % 100 // 10}"

    @property
    def compute(self) -> bool:
        """Whether there are compute shaders."""
        return self.version_code >= 430

    @property
    def software(self) -> bool:
        """Whether it is a software renderer, so that timer queries mean nothing."""
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
        int(ctx.max_samples),
    )


def open_context(*, software: bool = False, device: int | None = None) -> moderngl.Context:
    """Open a context with no window.

    ``software`` asks for the software renderer (Mesa llvmpipe); ``device`` picks the
    EGL device by its number. Raises ``ContextError`` with the known advice for the failure.
    """
    with _lock:
        uncollected = sum(made.is_ours for _, made in _opened.values())
    if uncollected >= _MAX_UNCOLLECTED:
        gc.collect()  # a dropped engine is a cycle, whose size in the driver Python does not know
    if software:
        return _open_software(device)
    return _open(device)


def _open(device: int | None = None, environment: Mapping[str, str] | None = None) -> moderngl.Context:
    """Open a context; ``environment`` is the user's own, where ours has been added to it."""
    import moderngl

    options: dict[str, Any] = {"standalone": True}
    if sys.platform.startswith("linux"):
        options["backend"] = "egl"
        if device is not None:
            options["device_index"] = device
        # The names with a version need no -dev package. To be found by another, each takes a process of
        # ldconfig, and without that nothing is found.
        names = {"libegl": "libEGL.so.1", "libgl": "libGL.so.1"}
        if all(map(is_loadable, names.values())) or not ctypes.util.find_library("EGL"):
            options |= names
    elif device is not None:
        raise ContextError("--device picks an EGL device, which only Linux has")
    cause = ""
    for version in VERSIONS:
        try:
            ctx = moderngl.create_context(require=version, **options)
        except Exception as error:  # moderngl and glcontext raise bare Exception, ValueError, RuntimeError
            cause = str(error)
            continue
        _destroy_when_dropped(ctx)
        return ctx
    there = _OTHER_DEVICES.search(cause)
    if device is not None and there:
        count = int(there.group(1))
        rest = "the only one is 0" if count == 1 else f"there are {count}, from 0"
        raise ContextError(f"--device {device}: there is no such EGL device; {rest}")
    theirs = os.environ if environment is None else environment
    raise ContextError(f"{advice(cause, sys.platform, theirs)} ({cause})")


def is_loadable(library: str) -> bool:
    """Return whether a library can be loaded; it stays so, for what opens a context loads it next."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _open_software(device: int | None) -> moderngl.Context:
    """Open a context on the software renderer, wherever among the devices it is.

    Mesa does not let its software switch override a device that was chosen by number, and
    where there is a GPU the default device is that; its own software device comes last.
    """
    environment = dict(os.environ)  # what the user set: advice must not speak of what is set below
    prefer_software()
    first = _open(device, environment)
    if device is not None or context_info(first).software:
        return _software_or_refuse(first)
    renderer = context_info(first).renderer
    release_context(first)
    for index in range(_MAX_DEVICES, -1, -1):
        try:
            ctx = _open(index)
        except ContextError:
            continue
        if context_info(ctx).software:
            return ctx
        release_context(ctx)
    raise ContextError(
        f"--software was given, but OpenGL gives {renderer} only; is Mesa's llvmpipe installed?"
    )


def _software_or_refuse(ctx: moderngl.Context) -> moderngl.Context:
    info = context_info(ctx)
    if info.software:
        return ctx
    release_context(ctx)
    raise ContextError(f"--software was given, but this device is {info.renderer}")


def adopt_context(address_of: Callable[[str], int | None] | None = None) -> moderngl.Context:
    """Return the context that a window has made current, at the version that it has.

    ``address_of`` finds an OpenGL function by name, as ``glfw.get_proc_address`` does; without
    it, functions come from the platform's usual library, which does not know Wayland's contexts.
    """
    import moderngl

    options: dict[str, Any] = {} if address_of is None else {"context": _Functions(address_of)}
    ctx = moderngl.create_context(require=330, **options)
    ctx.gc_mode = _QUEUED
    return ctx


def make_current(ctx: moderngl.Context) -> None:
    """Make a context current, and delete what was dropped since: its objects, and contexts of this thread."""
    import moderngl

    _destroy_dropped()
    context: Any = ctx  # not as a ``with`` block: glcontext's way back leaves no context current
    context.__enter__()
    while ctx.objects:  # ``Context.gc`` fails at one that was released before it was dropped
        dropped = ctx.objects.popleft()
        if not isinstance(dropped, moderngl.InvalidObject):
            dropped.release()


def _destroy_when_dropped(ctx: moderngl.Context) -> None:
    """Destroy a context, with its objects, once nothing refers to it.

    An object's number means another object in another context, so whichever context is current when one
    is collected must not delete it: dropped objects wait for ``make_current``.
    """
    import moderngl

    ctx.gc_mode = _QUEUED
    with suppress(AttributeError):  # moderngl's own, which would hold the newest for ever
        moderngl._store.default_context = None  # type: ignore[attr-defined]
    made = _Made(threading.current_thread(), ctx.mglo, _current_handle())
    finalizer = weakref.finalize(ctx, _drop, made)
    finalizer.atexit = False
    with _lock:
        _opened[ctx] = finalizer, made


def open_contexts() -> set[moderngl.Context]:
    """Return the contexts of ``open_context`` that were neither released nor collected."""
    with _lock:
        return set(_opened)


def release_context(ctx: moderngl.Context) -> None:
    """Destroy a context; one of ``open_context`` that is only released still counts as dropped."""
    with _lock:
        opened = _opened.pop(ctx, None)
    if opened is not None:
        finalizer, made = opened
        finalizer.detach()
        made.unbind()
    ctx.release()


@dataclass(frozen=True, slots=True)
class _Made:
    """A context that was opened here, as it is to be destroyed."""

    thread: threading.Thread
    context: Any  # moderngl's own object; that of its users has been collected
    handle: int | None  # EGL's; None on other platforms

    @property
    def is_ours(self) -> bool:
        """Whether it is this thread's, or that of one that has ended."""
        return self.thread is threading.current_thread() or not self.thread.is_alive()

    def unbind(self) -> None:
        """Make it no longer current: EGL keeps what is, and a thread that ends may leave it so for ever."""
        if self.handle is not None and self.handle == _current_handle():
            self.context.__exit__(None, None, None)


def _current_handle() -> int | None:
    """Return EGL's handle of this thread's current context."""
    if not sys.platform.startswith("linux"):
        return None
    try:
        current = ctypes.CDLL("libEGL.so.1").eglGetCurrentContext
    except (OSError, AttributeError):
        return None
    current.restype = ctypes.c_void_p
    handle: int | None = current()
    return handle


def _drop(made: _Made) -> None:
    """Destroy a context that was dropped, or leave it to its thread."""
    _dropped.append(made)
    if made.thread is not threading.current_thread():
        until = (
            "until that thread uses an engine again"
            if made.thread.is_alive()
            else "for that thread has ended"
        )
        warnings.warn(
            f"an engine of thread '{made.thread.name}' was dropped in '{threading.current_thread().name}' "
            f"without release(): its context stays, {until}",
            ResourceWarning,
            stacklevel=2,
        )
    if made.is_ours and sys.platform.startswith("linux"):  # elsewhere glcontext leaves no context current
        _destroy_dropped()


def _destroy_dropped() -> None:
    """Destroy the contexts that were dropped, of this thread and of those that have ended."""
    for _ in range(len(_dropped)):
        try:
            made = _dropped.popleft()
        except IndexError:  # a collection during this one was faster
            return
        if made.is_ours:
            made.unbind()
            made.context.release()
        else:
            _dropped.append(made)


def report_leak(ctx: moderngl.Context) -> None:
    """Warn that an engine was dropped on its user's context, and keep its objects from other contexts."""
    import moderngl

    if isinstance(ctx.mglo, moderngl.InvalidObject):
        return
    if ctx.gc_mode == "auto":  # in whichever context is current
        ctx.gc_mode = _QUEUED
    warnings.warn(
        "an engine on a context of your own was dropped without release(): its textures and programs stay "
        f"until {'another engine draws there, or until ' if ctx.gc_mode else ''}ctx.release()",
        ResourceWarning,
        stacklevel=2,
    )


def abandon(ctx: moderngl.Context) -> None:
    """Release a lost context."""
    with suppress(Exception):  # it may no longer respond
        release_context(ctx)


class _Functions:
    """The interface that moderngl needs from the owner of a context: its functions."""

    def __init__(self, address_of: Callable[[str], int | None]) -> None:
        self._address_of = address_of

    def load_opengl_function(self, name: str) -> int:
        """Return a function's address; 0 if there is none."""
        return self._address_of(name) or 0

    def __enter__(self) -> None:
        """Stay current: the window keeps it so."""

    def __exit__(self, *_: object) -> None:
        """Stay current."""

    def release(self) -> None:
        """Leave the context to the window."""


def prefer_software() -> None:
    """Ask Mesa for the software renderer, for contexts opened from now on here and in child processes."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    os.environ.setdefault("GALLIUM_DRIVER", "llvmpipe")
    if _MESA_VENDOR.is_file():
        os.environ["__EGL_VENDOR_LIBRARY_FILENAMES"] = str(_MESA_VENDOR)


_SIMD = ("avx", "fma", "f16c")  # that change what llvmpipe's code computes, not only how fast
_ARM = {"0x41": "ARM", "0x46": "Fujitsu", "0x48": "HiSilicon", "0x4e": "NVIDIA", "0x51": "Qualcomm"}
_ARM |= {"0x61": "Apple", "0xc0": "Ampere"}


def build_of(renderer: ContextInfo) -> tuple[str, ...]:
    """Return what a context's build is: its own strings, its OpenGL, the processor where that draws."""
    own = (renderer.renderer, renderer.vendor, renderer.version, renderer.opengl)
    return (*own, *(processor() if renderer.software else ()))


@cache
def processor() -> tuple[str, str]:
    """Return who made this machine's processor, and which instructions it has that change a picture."""
    if sys.platform.startswith("linux"):
        try:
            return processor_in(Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace"))
        except OSError:
            return "", ""
    if sys.platform == "win32":
        return os.environ.get("PROCESSOR_IDENTIFIER", "").rpartition(", ")[2], ""
    return ("Apple" if platform.machine() == "arm64" else "GenuineIntel"), ""


def processor_in(cpuinfo: str) -> tuple[str, str]:
    """Return the same from the text of Linux's ``/proc/cpuinfo``."""
    fields: dict[str, str] = {}
    for line in cpuinfo.splitlines():
        name, colon, text = line.partition(":")
        if colon:
            fields.setdefault(name.strip(), text.strip())
    if "CPU implementer" in fields:
        code = fields["CPU implementer"]
        return _ARM.get(code, f"ARM implementer {code}"), ""
    if "flags" not in fields:
        return fields.get("vendor_id", ""), ""
    there = set(fields["flags"].split())
    return fields.get("vendor_id", ""), " ".join(name for name in _SIMD if name in there) or "none"
