"""Return which build of a renderer draws: two that agree in all of it make the same bits of the same texts.

Of a software renderer, the processor is part of the build: reciprocal square
roots are estimated, and the estimates of Intel and AMD differ; with `fma` a product and a sum
are rounded once, not twice; with `f16c` half floats are rounded by the processor.
"""

from __future__ import annotations

import os
import platform
import sys
from functools import lru_cache
from pathlib import Path

from playground.gpu.context import ContextInfo

_SIMD = ("avx", "fma", "f16c")  # that change what llvmpipe's code computes, not only how fast
_ARM = {"0x41": "ARM", "0x46": "Fujitsu", "0x48": "HiSilicon", "0x4e": "NVIDIA", "0x51": "Qualcomm"}
_ARM |= {"0x61": "Apple", "0xc0": "Ampere"}


def build_of(renderer: ContextInfo) -> tuple[str, ...]:
    """Return what a context's build is: its own strings, its OpenGL, the processor where that draws."""
    own = (renderer.renderer, renderer.vendor, renderer.version, renderer.opengl)
    return (*own, *(processor() if renderer.software else ()))


@lru_cache(maxsize=1)
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
