"""Find a sketch by name or path, and list what ships."""

from __future__ import annotations

from pathlib import Path

from playground.errors import SketchError, nearest
from playground.paths import GLSL, SKETCHES
from playground.regular_file import irregularity
from playground.sketch.allowed_files import (
    ELEVATIONS,
    SHADERS,
    TECHNIQUES,
    TEXTS,
    is_elevation,
    is_file,
    is_inside,
    is_variant,
)
from playground.sketch.dialects import EXPORT, is_export
from playground.sketch.unpack import is_pack, unpacked


def find(name: str | Path) -> Path:
    """Return the file of a sketch's name or path; raise ``SketchError`` if there is none.

    A zip is unpacked into the cache first: ``DataError`` says why one cannot be.
    """
    path = Path(name)
    try:
        path = path.expanduser()
        is_folder = path.is_dir()
    except (OSError, RuntimeError, ValueError):
        is_folder = False
    if is_folder and is_file(path / "sketch.toml"):
        return path / "sketch.toml"
    if is_folder:
        from playground.sketch.dialects.shadertoy_folder import image_of

        if (image := image_of(path)) is not None:
            return image
    if is_file(path):
        if is_pack(path):
            return unpacked(path)
        if path.suffix not in TEXTS and not is_elevation(path):
            if is_export(path):
                return path
            if path.suffix == EXPORT:
                message = "a sketch is a .toml, and a .json a Shadertoy export; this holds no renderpass"
                raise SketchError(message, file=path)
            message = f"a sketch is a .toml, a shader ends in {', '.join(SHADERS)}"
            raise SketchError(f"{message}, an elevation file in {', '.join(ELEVATIONS)}", file=path)
        return path
    text = str(name)
    places = [SKETCHES / f"{text}.toml"] if "/" not in text and "\\" not in text else []
    places += [GLSL / f"{text}{suffix}" for suffix in ("", *TECHNIQUES)]
    for candidate in places:
        if candidate.suffix in TEXTS and is_file(candidate) and is_inside(candidate, (GLSL,)):
            return candidate
    wanted = path / "sketch.toml" if is_folder else path
    if what := irregularity(wanted):
        raise SketchError(what, file=wanted)
    if is_folder:
        raise SketchError("this folder holds no sketch.toml, and no Image of Shadertoy of its own", file=path)
    names = [*shipped_sketches(), *(shipped_names() if "/" in text else [])]
    raise SketchError(f"there is no file and no shipped sketch '{text}'{nearest(text, names)}")


def shipped_sketches() -> list[str]:
    """List the names of the sketches that ship.

    For example:

        assert "l_dot_n" in playground.shipped_sketches()
    """
    return sorted(path.stem for path in SKETCHES.glob("*.toml"))


def shipped_names() -> list[str]:
    """List every name that ``use`` may take in ``glsl/``, library files too, without reading the files."""
    found = [
        p
        for p in GLSL.rglob("*")
        if p.suffix in TECHNIQUES and not is_variant(p) and not p.is_relative_to(SKETCHES)
    ]
    return sorted({p.relative_to(GLSL).with_suffix("").as_posix() for p in found})


def is_part(name: str) -> bool:
    """Return whether a name in ``glsl/`` is a part of a technique: it lies in a folder named after one."""
    return any(is_file(GLSL / folder.with_suffix(".toml")) for folder in Path(name).parents if folder.name)
