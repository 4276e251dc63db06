"""The formats of an export: what each kind of file holds, its options, and what no sketch could give."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from playground.engine.plan import Plan, view_height
from playground.errors import DataError, ParameterError, SketchError, nearest
from playground.files import open_regular, reason
from playground.paths import shown
from playground.publish.web.page import LANGUAGES

# ── kinds of files ─────────────────────────────────────────────────────────────


HEIGHT, COLOUR, NUMBERS = "height", "colour", "numbers"
KINDS = (HEIGHT, COLOUR, NUMBERS)
"""Metres above sea level; linear light, encoded as sRGB where a format expects that; numbers as they are."""

VALUES: dict[str, dict[str, tuple[int, ...]]] = {
    ".png": {HEIGHT: (16,), COLOUR: (8, 16), NUMBERS: (16, 8)},
    ".tif": {HEIGHT: (32, 16), COLOUR: (32,), NUMBERS: (32, 16)},
    ".tiff": {HEIGHT: (32, 16), COLOUR: (32,), NUMBERS: (32, 16)},
    ".exr": {HEIGHT: (32,), COLOUR: (32, 16), NUMBERS: (32, 16)},
    ".npy": {HEIGHT: (32,), COLOUR: (32,), NUMBERS: (32,)},
    ".r16": {HEIGHT: (16,), NUMBERS: (16,)},
    ".raw": {HEIGHT: (16,), NUMBERS: (16,)},
    ".r32": {HEIGHT: (32,), NUMBERS: (32,)},
    ".webp": {COLOUR: (8,)},
    ".jpg": {COLOUR: (8,)},
    ".jpeg": {COLOUR: (8,)},
}
"""Ending → kind → bits a number may have, the usual first. 8 and 16 are whole numbers, but
that 16 in an EXR, like 32 everywhere, are floats."""

RAW = (".r16", ".raw", ".r32")
"""Numbers and nothing else: a JSON file next to it says what they are."""

PICTURES = (".webp", ".jpg", ".jpeg")
"""Colours and nothing else."""

MESHES: dict[str, int] = {".glb": 2049, ".obj": 1025, ".stl": 2049}
"""Ending → vertices that the longer side of a mesh may have; OBJ is text, six times as long."""

TEXTURED = (".glb", ".obj")
"""Meshes with a texture; an STL is a shape and nothing else."""

_MESH_LIST = f"{', '.join(tuple(MESHES)[:-1])} or {tuple(MESHES)[-1]}"

DEFAULT_GRID = 513
"""Vertices of the longer side unless another number is given."""

ISF, SHADERTOY_TEXT, SHADERTOY_EXPORT, STANDALONE = SHADERS = (".fs", ".frag", ".json", ".glsl")
"""Shaders of other tools: ISF, one Shadertoy pass, a Shadertoy export, a fragment shader of its own."""

PAGES = (".html",)
"""A web page: one file in which the sketch runs."""

ENDINGS = (*VALUES, *MESHES, *SHADERS, *PAGES)

OTHERS = {
    f"a mesh is {_MESH_LIST}": (
        ".3ds .3mf .abc .blend .c4d .dae .fbx .iges .lwo .ma .max .mb .off .ply .skp .step .stp .usd"
        " .usda .usdc .usdz .vrm .wrl .x3d"
    ),
    "heights are .tif, .npy, .exr, .png, .r16 or .r32": (
        ".adf .asc .bil .csv .dem .flt .grd .h5 .hdf5 .hdr .hgt .img .las .laz .mat .nc .npz"
        " .pfm .ter .vrt .xyz"
    ),
    "a picture is .png, .webp or .jpg": (
        ".avif .bmp .dds .heic .ico .jp2 .jxl .ktx .ktx2 .pbm .pgm .ppm .psd .svg .tga"
    ),
    f"a shader is {', '.join(SHADERS[:-1])} or {SHADERS[-1]}": (
        ".cg .comp .fx .hlsl .metal .osl .shader .spv .vert .wgsl"
    ),
    "a sketch is packed by playground pack": ".toml",
    "a video is what playground render --video writes": ".apng .avi .gif .mkv .mov .mp4 .webm",
}
"""What each kind of file is exported as → endings of that kind that nothing is exported as."""

PIPED = tuple(ending for ending in ENDINGS if ending not in (*RAW, ".obj"))
"""What is one file, and so can go to standard output."""


def whole_numbers(ending: str, bits: int) -> bool:
    """Return whether numbers of so many bits are whole ones in a file of that ending."""
    return bits < 32 and ending != ".exr"


# ── what is exported and how ───────────────────────────────────────────────────


_MARK = b"terrain shader playground"
_LOOKED_AT = 4096  # bytes, within which an export says who made it


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportOptions:
    """What to export and how; where a field has its default, the usual is done."""

    texture: str = ""  # "pass[.inner…][:output]"; "": the heights that the picture shows
    kind: str = ""  # height, colour or numbers; "": as the texture's name tells
    bits: int = 0  # of a number; 0: the format's usual
    span: tuple[float, float] | None = None  # what 0 and the largest whole number mean
    grid: int = 0  # vertices of a mesh's longer side; 0: as many as the terrain has texels, up to 513
    exaggeration: float = 0.0  # times that a mesh is higher over height 0 than the terrain; 0: true metres
    light: bool = False  # multiply a mesh's texture by the light
    techniques: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # of a web page: what else may
    # fill a pass, by the pass; none listed: all that fits
    trace: bool = False  # a web page shows the values of a texel beside the code
    language: str = ""  # of a web page's interface: en or fr; "": English


_OF_TEXTURES = ((*VALUES, *TEXTURED, *SHADERS), "a file of values, a mesh with a texture or a shader")
_OF_MESHES = (MESHES, f"a mesh: {_MESH_LIST}")
_OF_TEXTURED = (TEXTURED, f"a mesh with a texture: {' or '.join(TEXTURED)}")
_OF_VALUES = (VALUES, "a file of values, as .png and .tif")
_OF_PAGES = (PAGES, f"a web page: {PAGES[0]}")
_OPTIONS: tuple[tuple[str, str, Collection[str], str], ...] = (
    ("texture", "one texture is", *_OF_TEXTURES),
    ("kind", "a kind of data is", *_OF_TEXTURES),
    ("grid", "a grid is", *_OF_MESHES),
    ("exaggeration", "an exaggeration is", *_OF_MESHES),
    ("light", "light baked in is", *_OF_TEXTURED),
    ("bits", "bits are", *_OF_VALUES),
    ("span", "a range is", *_OF_VALUES),
    ("techniques", "menus of techniques are", *_OF_PAGES),
    ("trace", "traced texts are", *_OF_PAGES),
    ("language", "a language is", *_OF_PAGES),
)
"""Field of ``ExportOptions`` → what it is in a message, and the endings that take it."""


def check(path: Path, options: ExportOptions) -> None:
    """Raise ``PlaygroundError`` for what is wrong with any sketch."""
    ending = path.suffix.lower()
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=path)
    if ending not in ENDINGS:
        raise DataError(_no_ending(ending), file=path)
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{shown(path.parent)}' to write into", file=path)
    if options.kind and options.kind not in KINDS:
        raise ParameterError(f"a texture is not '{options.kind}'; expected {', '.join(KINDS)}")
    if options.span is not None:
        low, high = options.span
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ParameterError(f"a range from {low:g} to {high:g}; expected two numbers, the lower first")
    if options.language and options.language not in LANGUAGES:
        raise ParameterError(f"no page is in '{options.language}'; expected {' or '.join(LANGUAGES)}")
    for name, what, endings, target in _OPTIONS:
        if getattr(options, name) and ending not in endings:
            raise DataError(f"{what} for {target}", file=path)
    if options.grid and not 2 <= options.grid <= MESHES[ending]:
        raise ParameterError(
            f"a grid of {options.grid} vertices a side: {ending} takes 2 to {MESHES[ending]}"
        )
    if ending in SHADERS and options.kind and not options.texture:
        raise DataError("the kind of data is an option of --texture; a picture is shown as it is", file=path)
    if ending in VALUES:
        _check_bits(path, options)
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


def _check_bits(path: Path, options: ExportOptions) -> None:
    ending = path.suffix.lower()
    kind = options.kind or ("" if options.texture else HEIGHT)
    if kind:
        bits_for(path, kind, options)
    elif options.bits and not any(options.bits in bits for bits in VALUES[ending].values()):
        raise _wrong_bits(path, options.bits, {b for bits in VALUES[ending].values() for b in bits})


def bits_for(path: Path, kind: str, options: ExportOptions) -> int:
    """Return the bits of a number in the file, or raise ``DataError`` for what the format has not."""
    ending = path.suffix.lower()
    bits = VALUES[ending].get(kind)
    if bits is None:
        able = [name for name in VALUES if kind in VALUES[name]]
        what = {HEIGHT: "heights", COLOUR: "colours", NUMBERS: "numbers"}[kind]
        hint = "; name a texture of colours, as 'colour'" if kind == HEIGHT and not options.texture else ""
        raise DataError(f"{ending} does not hold {what}; {', '.join(able)} do{hint}", file=path)
    if options.bits and options.bits not in bits:
        raise _wrong_bits(path, options.bits, set(bits))
    chosen = options.bits or bits[0]
    if options.span and not whole_numbers(ending, chosen):
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


def refuse_foreign_files(path: Path, sidecars: list[Path]) -> None:
    """Raise ``DataError`` where a file that goes with ``path`` would replace one that is no export."""
    for other in sidecars:
        try:
            if not other.exists():
                continue
            with open_regular(other) as handle:
                ours = _MARK in handle.read(_LOOKED_AT)
        except OSError as error:
            raise DataError(f"cannot be read: {reason(error)}", file=other) from error
        if not ours:
            raise DataError(
                f"{other.name} is there already, and no export wrote it; choose another name", file=path
            )


def one_word(name: str) -> str:
    """Return a name without spaces."""
    return "_".join(name.split()) or "land"


# ── textures and what they hold ────────────────────────────────────────────────


def height_of(plan: Plan) -> str:
    """Return the heights that the picture shows; raise ``SketchError`` where there are none."""
    height = view_height(plan)
    if not height:
        there = ", ".join(spec.name for spec in plan.sketch.graph.passes if spec.name != "view")
        hint = f"; its textures are {there}" if there else ""
        raise SketchError(f"sketch {plan.sketch.name} has no height to export{hint}")
    return height


def kind_of(plan: Plan, texture: str) -> str:
    """Return what a texture holds, by the name of the output and, if it is not named, of the pass."""
    for name in _names(plan, texture):
        if name == HEIGHT:
            return HEIGHT
        if name in (COLOUR, "light"):
            return COLOUR
    return NUMBERS


def is_light(plan: Plan, texture: str) -> bool:
    """Return whether a texture holds light, by the same names."""
    return next((name for name in _names(plan, texture) if name in (HEIGHT, COLOUR, "light")), "") == "light"


def _names(plan: Plan, texture: str) -> list[str]:
    path, _, output = texture.partition(":")
    last = path.rpartition(".")[2]
    outputs = plan.flat.outputs[path]
    return [output] if output else [last, last if last in outputs else next(iter(outputs))]
