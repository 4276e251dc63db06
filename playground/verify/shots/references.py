"""Store reference pictures: where they live, what they say of themselves, which of them nothing uses.

``screenshots/<sketch>/<renderer>/<shot>.png``, in the checkout for the sketches that ship,
in the sketch's folder for a user's own. ``<shot>.2.png``, ``<shot>.3.png`` … are further pictures
that may match (another build of the same renderer, say).

A reference carries texts: which shot of which sketch it shows, and its fingerprint: what it comes from. A
picture just drawn has one too. Comparing the two explains a failure, and chooses how strictly the pictures
are compared. What each part means for that:

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

Whose references replace which renderer's, where that has none of its own, is a table:

    [tool.pytest.ini_options]
    shots_fallbacks = [
        "apple-* = llvmpipe",                 # by structure: real defects show, roundings do not
        "nvidia-a100 = nvidia-h200, pixels",  # as strictly as another build of the same renderer
    ]

Each line names renderers, as the folders of references are named (``*`` and ``?`` stand for any
letters), then the renderer whose references are taken, then how strictly: ``structure`` unless it
says ``pixels``. Of several lines for a renderer the first counts whose references are there.
A renderer that the table names may draw shots in place of the expected one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground import paths
from playground._version import __version__
from playground.data.image_files import read_png, write_png
from playground.engine.context import ContextInfo, processor
from playground.files import make_folder
from playground.paths import SCREENSHOTS
from playground.sketch.find import home_of
from playground.sketch.model import Sketch

# ── what a picture comes from ────────────────────────────────────────────────


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


# ── where references are ─────────────────────────────────────────────────────


FOLDER = SCREENSHOTS

_NUMBERED = re.compile(r"(?P<shot>[^.]+)(?:\.(?P<number>[2-9]|[1-9][0-9]+))?\.png")


@dataclass(frozen=True, eq=False)
class Reference:
    """A picture that a shot may match."""

    path: Path
    pixels: NDArray[np.uint8]  # (height, width, 4), top row first, sRGB and alpha
    text: dict[str, str]  # what the file says of itself: its fingerprint's parts, sketch, shot

    @property
    def fingerprint(self) -> Fingerprint:
        """What it comes from, as far as the file says."""
        return read_fingerprint(self.text)


def reference_path(sketch: Sketch, shot: str, renderer: str) -> Path:
    """Return where a shot's first reference is, or would be; ``renderer`` is a slug such as "llvmpipe"."""
    return home_of(sketch) / sketch.name / renderer / f"{shot}.png"


def accepted(sketch: Sketch, shot: str, renderer: str) -> list[Path]:
    """List the reference files that are there for a shot, ``<shot>.png`` first; none if it is missing."""
    return accepted_in(reference_path(sketch, shot, renderer).parent, shot)


def accepted_in(folder: Path, shot: str) -> list[Path]:
    """List the reference files for a shot that are in a folder, ``<shot>.png`` first."""
    result: list[tuple[int, Path]] = []
    for path in folder.glob("*.png"):
        name = _NUMBERED.fullmatch(path.name)
        if name and name["shot"] == shot:
            result.append((int(name["number"] or 1), path))
    return [path for _, path in sorted(result)]


def read_reference(path: Path) -> Reference:
    """Read a reference; raise ``DataError`` if it is missing, damaged or no PNG."""
    pixels, text = read_png(path)
    return Reference(path, pixels, text)


def write_reference(
    sketch: Sketch,
    shot: str,
    renderer: ContextInfo,
    pixels: NDArray[np.uint8],
    drawn: str = "",
    fonts: str = "",
) -> tuple[Path, list[Path]]:
    """Write a shot's first reference for its renderer, and remove the further ones that were accepted.

    ``drawn`` is the hash of what was drawn, ``fonts`` its fonts, "" if that is not known. Otherwise as
    `write_reference_in`.
    """
    folder = reference_path(sketch, shot, renderer.slug).parent
    fingerprint = fingerprint_of(renderer, (pixels.shape[1], pixels.shape[0]), drawn, fonts)
    return write_reference_in(folder, shot, fingerprint, pixels, sketch.name)


def write_reference_in(
    folder: Path, shot: str, fingerprint: Fingerprint, pixels: NDArray[np.uint8], sketch: str = ""
) -> tuple[Path, list[Path]]:
    """Write ``<shot>.png`` into a folder, whole or not at all, and remove ``<shot>.2.png`` and so on.

    Those would otherwise let the old picture pass for ever. Returns what was written and
    what was removed. Raises ``DataError`` where the folder cannot be written to.
    """
    path = make_folder(folder) / f"{shot}.png"
    write_png(path, pixels, text=reference_texts(fingerprint, sketch, shot))
    further = [other for other in accepted_in(folder, shot) if other != path]
    for other in further:
        other.unlink()
    return path, further


def reference_texts(fingerprint: Fingerprint, sketch: str, shot: str) -> dict[str, str]:
    """Return what a reference says of itself."""
    return {**fingerprint.texts(), **({"sketch": sketch} if sketch else {}), "shot": shot}


def stale_references(sketches: Iterable[Sketch]) -> list[Path]:
    """List the reference files, of all renderers, that no shot uses.

    Give every sketch whose references are to be judged, with shots or without. Pictures of
    a sketch that is not given count only if there is no such sketch any more.
    """
    shots: dict[Path, dict[str, set[str]]] = {}
    for sketch in sketches:
        of_home = shots.setdefault(home_of(sketch), {})
        of_home.setdefault(sketch.name, set()).update(shot.name for shot in sketch.shots)
    stale: list[Path] = []
    for home, shot_names in shots.items():
        others = _sketches_of(home) - shot_names.keys()
        for path in home.rglob("*.png"):
            folders = path.relative_to(home).parts[:-1]  # sketch and renderer, if it is where it should be
            if folders and folders[0] in others:
                continue
            name = _NUMBERED.fullmatch(path.name)
            if len(folders) != 2 or name is None or name["shot"] not in shot_names.get(folders[0], ()):
                stale.append(path)
    return sorted(stale)


def _sketches_of(home: Path) -> set[str]:
    """Return the names of the sketches whose references are in ``home``."""
    folder = paths.SKETCHES if paths.CHECKOUT and home == paths.CHECKOUT / FOLDER else home.parent
    names = {path.stem for path in folder.glob("*.toml")}
    return names | {folder.name} if "sketch" in names else names


# ── whose references replace whose ───────────────────────────────────────────


STRUCTURE, PIXELS = "structure", "pixels"


@dataclass(frozen=True, slots=True)
class Fallback:
    """One line of the table."""

    renderers: str  # a slug, or a pattern of slugs
    references: str  # slug of the renderer whose references stand in
    strictness: str  # `STRUCTURE` or `PIXELS`

    def __str__(self) -> str:
        return f"{self.renderers} = {self.references}, {self.strictness}"


def read_fallbacks(lines: Iterable[str]) -> tuple[Fallback, ...]:
    """Read the table; raise ``ValueError``, with a message, for a line that is not one of it."""
    fallbacks = []
    for line in lines:
        renderers, equals, rest = (part.strip() for part in line.partition("="))
        references, comma, strictness = (part.strip() for part in rest.partition(","))
        strictness = strictness if comma else STRUCTURE
        if not (equals and renderers and references):
            raise ValueError(f"{line!r}: expected 'RENDERER = RENDERER', as in 'apple-m1 = llvmpipe'")
        if strictness not in (STRUCTURE, PIXELS):
            raise ValueError(f"{line!r}: how strictly is {STRUCTURE} or {PIXELS}, not {strictness!r}")
        if any(letter in "*?[" for letter in references):
            raise ValueError(f"{line!r}: one renderer's references stand in; {references!r} is a pattern")
        if fnmatchcase(references, renderers):
            raise ValueError(f"{line!r}: a renderer's references do not stand in for its own")
        fallbacks.append(Fallback(renderers, references, strictness))
    return tuple(fallbacks)


def fallbacks_of(table: Iterable[Fallback], renderer: str) -> list[Fallback]:
    """Return the lines of the table for a renderer, a slug, in their order."""
    return [fallback for fallback in table if fnmatchcase(renderer, fallback.renderers)]


def fallback_for(
    table: Iterable[Fallback], renderer: str, has_references: Callable[[str], bool]
) -> Fallback | None:
    """Return the line that a renderer without references of its own is compared by.

    ``has_references`` says whether there are a renderer's. The first line where there are any; the
    first of all where there are none; None where the table does not name the renderer.
    """
    lines = fallbacks_of(table, renderer)
    return next((line for line in lines if has_references(line.references)), next(iter(lines), None))
