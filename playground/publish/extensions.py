"""List what each kind of exported file holds, and in how many bits."""

from __future__ import annotations

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

MESHES: dict[str, int] = {".glb": 2049, ".obj": 1025}
"""Ending → vertices that the longer side of a mesh may have; OBJ is text, six times as long."""

DEFAULT_GRID = 513
"""Vertices of the longer side unless another number is given."""

ISF, SHADERTOY_TEXT, SHADERTOY_EXPORT, STANDALONE = SHADERS = (".fs", ".frag", ".json", ".glsl")
"""Shaders of other tools: ISF, one Shadertoy pass, a Shadertoy export, a fragment shader of its own."""

PAGES = (".html",)
"""A web page: one file in which the sketch runs."""

ENDINGS = (*VALUES, *MESHES, *SHADERS, *PAGES)

OTHERS = {
    f"a mesh is {' or '.join(MESHES)}": (
        ".3ds .3mf .abc .blend .c4d .dae .fbx .iges .lwo .ma .max .mb .off .ply .skp .step .stl .stp .usd"
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
