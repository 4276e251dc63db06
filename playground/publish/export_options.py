"""Define what is exported and how, and refuse what no sketch could give."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import DataError, ParameterError, nearest
from playground.paths import shown
from playground.publish.atomic_group import refuse_foreign_files
from playground.publish.extensions import (
    COLOUR,
    ENDINGS,
    HEIGHT,
    KINDS,
    MESHES,
    NUMBERS,
    OTHERS,
    PAGES,
    RAW,
    SHADERS,
    VALUES,
    whole_numbers,
)
from playground.publish.web.page import LANGUAGES


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """What to export and how; where a field has its default, the usual is done."""

    texture: str = ""  # "pass[.inner…][:output]"; "": the heights that the picture shows
    kind: str = ""  # height, colour or numbers; "": as the texture's name tells
    bits: int = 0  # of a number; 0: the format's usual
    span: tuple[float, float] | None = None  # what 0 and the largest whole number mean
    grid: int = 0  # vertices of a mesh's longer side; 0: as many as the terrain has texels, up to 513
    light: bool = False  # multiply a mesh's texture by the light
    techniques: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # of a web page: what else may
    # fill a pass, by the pass; none listed: all that fits
    language: str = ""  # of a web page's interface: en or fr; "": English


def check(path: Path, form: Form) -> None:
    """Raise ``PlaygroundError`` for what is wrong with any sketch."""
    ending = path.suffix.lower()
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=path)
    if ending not in ENDINGS:
        raise DataError(_no_ending(ending), file=path)
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{shown(path.parent)}' to write into", file=path)
    if form.kind and form.kind not in KINDS:
        raise ParameterError(f"a texture is not '{form.kind}'; expected {', '.join(KINDS)}")
    if form.span is not None:
        low, high = form.span
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ParameterError(f"a range from {low:g} to {high:g}; expected two numbers, the lower first")
    if form.techniques and ending not in PAGES:
        raise DataError("menus of techniques are for a web page: .html", file=path)
    if form.language and form.language not in LANGUAGES:
        raise ParameterError(f"no page is in '{form.language}'; expected {' or '.join(LANGUAGES)}")
    if form.language and ending not in PAGES:
        raise DataError("a language is for a web page: .html", file=path)
    if ending in PAGES:
        _check_page(path, form)
    elif ending in SHADERS:
        _check_shader(path, form)
    elif ending in MESHES:
        _check_mesh(path, form)
    else:
        _check_values(path, form)
    refuse_foreign_files(path, sidecar_paths(path))


def _no_ending(ending: str) -> str:
    listed = f"; expected one of {', '.join(ENDINGS)}"
    if not ending:
        return f"the name has no ending{listed}"
    usual = {
        ".gltf": ".glb",
        ".isf": ".fs",
        ".shadertoy": ".json",
        ".fragment": ".frag",
        ".htm": ".html",
    }.get(ending)
    what = next((kind for kind, others in OTHERS.items() if ending in others.split()), "")
    if usual:
        listed = f"; did you mean '{usual}'?"
    elif what:
        listed = f"; {what}"
    elif "did you mean" in (near := nearest(ending, ENDINGS, cutoff=0.75)):
        listed = near
    return f"nothing is exported as '{ending}'{listed}"


def _check_mesh(path: Path, form: Form) -> None:
    ending = path.suffix.lower()
    most = MESHES[ending]
    if form.grid and not 2 <= form.grid <= most:
        raise ParameterError(f"a grid of {form.grid} vertices a side: {ending} takes 2 to {most}")
    if form.bits or form.span:
        raise DataError("a mesh has no bits and no range to choose; its heights are floats", file=path)


def _check_page(path: Path, form: Form) -> None:
    for name, value in (
        ("one texture", form.texture or form.kind),
        ("a grid", form.grid),
        ("light baked in", form.light),
        ("bits", form.bits),
        ("a range", form.span),
    ):
        if value:
            raise DataError(
                f"a web page has the whole sketch; {name} is nothing it could be given", file=path
            )


def _check_shader(path: Path, form: Form) -> None:
    if form.grid or form.light or form.bits or form.span:
        options = {"a grid": form.grid, "light baked in": form.light, "bits": form.bits, "a range": form.span}
        what = next(name for name, value in options.items() if value)
        raise DataError(f"{what} is nothing that a shader's text has", file=path)
    if form.kind and not form.texture:
        raise DataError("the kind of data is an option of --texture; a picture is shown as it is", file=path)


def _check_values(path: Path, form: Form) -> None:
    ending = path.suffix.lower()
    if form.grid or form.light:
        what = "a grid" if form.grid else "light baked in"
        raise DataError(f"{what} is for a mesh: {' or '.join(MESHES)}", file=path)
    kind = form.kind or ("" if form.texture else HEIGHT)
    if kind:
        bits_for(path, kind, form)
    elif form.bits and not any(form.bits in bits for bits in VALUES[ending].values()):
        raise _wrong_bits(path, form.bits, {b for bits in VALUES[ending].values() for b in bits})


def bits_for(path: Path, kind: str, form: Form) -> int:
    """Return the bits of a number in the file, or raise ``DataError`` for what the format has not."""
    ending = path.suffix.lower()
    bits = VALUES[ending].get(kind)
    if bits is None:
        able = [name for name in VALUES if kind in VALUES[name]]
        what = {HEIGHT: "heights", COLOUR: "colours", NUMBERS: "numbers"}[kind]
        hint = "; name a texture of colours, as 'colour'" if kind == HEIGHT and not form.texture else ""
        raise DataError(f"{ending} does not hold {what}; {', '.join(able)} do{hint}", file=path)
    if form.bits and form.bits not in bits:
        raise _wrong_bits(path, form.bits, set(bits))
    chosen = form.bits or bits[0]
    if form.span and not whole_numbers(ending, chosen):
        raise DataError("a range is for whole numbers; floats hold any value", file=path)
    return chosen


def _wrong_bits(path: Path, bits: int, able: set[int]) -> DataError:
    listed = " or ".join(str(b) for b in sorted(able))
    return DataError(f"{path.suffix.lower()} has {listed} bits for these, not {bits}", file=path)


def sidecar_paths(path: Path) -> list[Path]:
    """Return the further files that an export writes: a raw file's JSON; an OBJ's MTL, and its texture.

    What an OBJ names has no spaces, since some programs end a name at the first.
    """
    ending = path.suffix.lower()
    if ending in RAW:
        return [path.with_name(f"{path.name}.json")]
    if ending == ".obj":
        stem = one_word(path.stem)
        return [path.with_name(f"{stem}.mtl"), path.with_name(f"{stem}-texture.png")]
    return []


def one_word(name: str) -> str:
    """Return a name without spaces."""
    return "_".join(name.split()) or "land"
