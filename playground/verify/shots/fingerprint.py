"""Identify what a picture comes from: which build of which renderer, on what processor, drew what.

A reference carries this in its PNG's texts, and a picture just drawn has one too. Comparing
the two explains a failure, and chooses how strictly the pictures are compared. What each part
means for that:

    renderer, version     the build: driver, its version, and for Mesa its LLVM and the width of
                          the vectors it compiles for. Another build may round the other way.
    vendor                GL's word for who wrote the driver. Shown, but no part of a build: between two
                          versions Mesa changed it from "Mesa/X.org" to "Mesa".
    mesa, llvm            read out of the two strings, for people; they decide nothing twice.
    cpu, simd             of a renderer that draws on the processor, part of the build: `engine.context`
                          says why. Where a graphics card draws, they say nothing, and are left out of the
                          comparison.
    drawn                 hash of what was drawn: sketch, shot, kernels, values, sizes, wiring,
                          files (see ``PictureHasher``). It never makes a comparison less strict:
                          that an edit changed the picture is what the test has to report.
    fonts                 the files of the fonts in a figure. They decide nothing either, and explain much.
    size                  the picture's. Pictures of two sizes are never compared.
    tool                  the playground's version. It never makes a comparison less strict either:
                          a bug of the playground must not excuse itself.

What a reference does not say, as one of an older tool, counts as equal: silence is no excuse.
There is no date in it, so that the same picture again gives the same file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from playground._version import __version__
from playground.engine.context import ContextInfo, processor

_MESA = re.compile(r"\bMesa (\d\S*(?: \(git-\w+\))?)")
_LLVM = re.compile(r"\bLLVM (\d[\w.]*)")

BUILD = ("renderer", "version", "cpu", "simd")
"""The parts that are the renderer's build."""

_WORDS = {
    "renderer": "renderer",
    "version": "OpenGL version",
    "vendor": "OpenGL vendor",
    "mesa": "Mesa",
    "llvm": "LLVM",
    "cpu": "processor",
    "simd": "processor's instructions",
    "fonts": "fonts",
    "size": "size",
    "tool": "tool",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Fingerprint:
    """What a picture comes from; "" for what is not known."""

    renderer: str = ""  # GL_RENDERER
    version: str = ""  # GL_VERSION
    vendor: str = ""  # GL_VENDOR
    mesa: str = ""  # "22.3.6"; "" where the driver is not Mesa's
    llvm: str = ""  # "15.0.6"
    cpu: str = ""  # who made the processor: "GenuineIntel", "AuthenticAMD", "Apple"
    simd: str = ""  # "avx fma f16c", what of them it has; "none"
    drawn: str = ""  # hash of what was drawn
    fonts: str = ""  # "DejaVuSans.ttf, cmr10.ttf"
    size: str = ""  # [pixels] "640x360"
    tool: str = ""  # "terrain-shader-playground 0.1.0"

    @property
    def software(self) -> bool:
        """Whether the processor drew it."""
        return ContextInfo(0, self.renderer, "", "", 0).software

    def texts(self) -> dict[str, str]:
        """Return it as the texts of a PNG: what is known, by the names of the fields."""
        return {name: text for name, text in asdict(self).items() if text}

    def differs_in(self, other: Fingerprint) -> tuple[str, ...]:
        """Name the fields that both state and that differ; the processor's only where it drew both."""
        hardware = not (self.software and other.software)
        names = []
        for name in (field.name for field in fields(self)):
            ours, theirs = getattr(self, name), getattr(other, name)
            if ours and theirs and ours != theirs and not (hardware and name in ("cpu", "simd")):
                names.append(name)
        return tuple(names)

    def same_build(self, other: Fingerprint) -> bool:
        """Return whether the same build of a renderer drew both, as far as both say."""
        return not set(BUILD) & set(self.differs_in(other))

    def differences(self, reference: Fingerprint) -> tuple[str, ...]:
        """Return, a message each, how this picture's origin differs from a reference's."""
        names = self.differs_in(reference)
        messages = []
        for name in names:
            ours, theirs = getattr(self, name), getattr(reference, name)
            if name == "drawn":
                messages.append(
                    "the drawn content has changed: the sketch, its shot, a kernel, a value or a file"
                )
            elif name not in ("mesa", "llvm"):  # the version and the renderer say the same, and more
                messages.append(f"{_WORDS[name]}: {ours}; the reference's: {theirs}")
        unknown = [_WORDS[name] for name in BUILD if getattr(self, name) and not getattr(reference, name)]
        if unknown:
            messages.append(f"the reference does not say its {', '.join(unknown)}")
        return tuple(messages)


def fingerprint_of(
    renderer: ContextInfo, size: tuple[int, int], drawn: str = "", fonts: str = ""
) -> Fingerprint:
    """Return the fingerprint of a picture drawn on this machine; ``drawn`` as `Engine.drawn` gives it."""
    mesa, llvm = _MESA.search(renderer.version), _LLVM.search(renderer.renderer)
    cpu, simd = processor() if renderer.software else ("", "")
    return Fingerprint(
        renderer=renderer.renderer,
        version=renderer.version,
        vendor=renderer.vendor,
        mesa=mesa[1] if mesa else "",
        llvm=llvm[1] if llvm else "",
        cpu=cpu,
        simd=simd,
        drawn=drawn,
        fonts=fonts,
        size=f"{size[0]}x{size[1]}",
        tool=f"terrain-shader-playground {__version__}",
    )


def read_fingerprint(texts: Mapping[str, str]) -> Fingerprint:
    """Return the fingerprint that a PNG's texts hold; what they do not say is ""."""
    return Fingerprint(**{field.name: texts.get(field.name, "") for field in fields(Fingerprint)})
