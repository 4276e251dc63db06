"""Export heights, textures and the terrain as a mesh: choose what is written, and in what form.

The ending and the texture determine what a file holds: heights become metres above sea level,
colours and light are encoded as sRGB where a format expects it, other numbers stay as they
are; the terrain itself becomes a mesh with its texture, the picture a shader's text. Whatever can
be refused is refused before a texel is computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.data.grid import fitted
from playground.data.image_files import encode_samples, naming
from playground.data.place import Georeference
from playground.engine.engine import Engine
from playground.engine.plan import Plan, view_input
from playground.errors import DataError, SketchError
from playground.files import replacing
from playground.publish.export_formats import (
    COLOUR,
    DEFAULT_GRID,
    HEIGHT,
    MESHES,
    NUMBERS,
    PAGES,
    PICTURES,
    RAW,
    SHADERS,
    TEXTURED,
    ExportOptions,
    bits_for,
    check,
    height_of,
    is_light,
    kind_of,
    sidecar_paths,
    whole_numbers,
)
from playground.publish.mesh import encode_glb, encode_mtl, encode_obj, encode_stl, sampled, terrain_mesh
from playground.publish.shader_export.export import ShaderFiles, check_es, shader_files
from playground.publish.texture_encoding import (
    SOFTWARE,
    Encoded,
    Layer,
    colour_samples,
    encode,
    encode_picture,
    light_span,
)
from playground.publish.web_page import WebPage, page_bytes, prepare_page
from playground.sketch.load import opened
from playground.sketch.model import DEFAULT_PICTURE, Sketch

_NO_TEXTURE = "no texture: the view shows no colour; name one with --texture"


@dataclass(frozen=True)
class Exported:
    """What was written."""

    path: Path
    summary: str  # one line on what the file holds
    sidecars: tuple[Path, ...] = ()  # further files that belong to it
    warnings: tuple[str, ...] = ()  # what was lost


@dataclass(frozen=True, kw_only=True)
class ExportJob:
    """An export that is valid, as far as can be checked before a texel is made."""

    sketch: Sketch
    path: Path
    options: ExportOptions
    plan: Plan
    texture: str  # of the values, or draped over the mesh; "" for a mesh without one
    kind: str
    height: str = ""  # of a mesh
    light: str = ""  # to bake in
    shader: ShaderFiles | None = None  # its text, where it is a shader
    page: WebPage | None = None  # its data, where it is a web page

    @property
    def ending(self) -> str:
        """Return the ending of the file, in small letters."""
        return self.path.suffix.lower()


def export(
    sketch: Sketch | str | Path,
    path: str | Path,
    *,
    texture: str = "",
    kind: str = "",
    bits: int = 0,
    span: tuple[float, float] | None = None,
    grid: int = 0,
    light: bool = False,
    techniques: Mapping[str, tuple[str, ...]] | None = None,
    trace: bool = False,
    language: str = "",
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    engine: Engine | None = None,
) -> Exported:
    """Write a sketch's heights, one of its textures, or its terrain as a mesh, by the path's ending.

    ``.png``, ``.r16``, ``.r32``, ``.tif``, ``.exr`` and ``.npy`` hold the heights, in metres, or
    the ``texture`` named; ``.webp`` and ``.jpg`` colours; ``.glb`` and ``.obj`` the terrain with its
    texture, ``.stl`` without; ``.fs``, ``.frag``, ``.json`` and ``.glsl`` the picture, or a texture, as a
    shader; ``.html`` is a web page in which the whole sketch runs. Rows come from the north. The other
    arguments are those of ``ExportOptions``; ``time``, in seconds, and ``steps`` are as in
    ``Engine.render``. A file of that name is replaced, whole or not at all. Without an ``engine`` one is
    opened.

    Those of ``ExportOptions``: ``kind`` of the numbers, ``bits`` a number, ``span`` of a PNG's black and
    white, ``grid`` of a mesh, its ``light``, ``techniques``, ``trace`` and ``language`` of a page. ``sketch``
    is a loaded one, or what ``load`` takes. Returns the path with a summary.

        exported = playground.export("l_dot_n", "land.tif")
        print(exported.path, exported.summary)

    Raises ``PlaygroundError`` for any mistake in the arguments, or a file that cannot be written.
    """
    options = ExportOptions(
        texture=texture,
        kind=kind,
        bits=bits,
        span=span,
        grid=grid,
        light=light,
        techniques=techniques or {},
        trace=trace,
        language=language,
    )
    opened_sketch = opened(sketch)
    check(Path(path), options)
    with nullcontext(engine) if engine is not None else headless() as used:
        return run(used, prepare(used, opened_sketch, Path(path), options, time=time, steps=steps))


def prepare(
    engine: Engine,
    sketch: Sketch,
    path: Path,
    options: ExportOptions,
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    frame: tuple[int, int] | None = None,
) -> ExportJob:
    """Resolve the textures that an export needs; raise ``PlaygroundError`` where there are none.

    ``frame`` is the size in pixels that a web page begins with, where it is not the usual one.
    """
    check(path, options)
    if path.suffix.lower() in PAGES:
        plan = engine.plan(sketch, frame or DEFAULT_PICTURE, time, steps)
        at: dict[str, Any] = {"frame": frame, "time": time, "steps": steps, "traces": options.trace}
        page = prepare_page(engine, sketch, path, options.techniques, **at)
        return ExportJob(sketch=sketch, path=path, options=options, plan=plan, texture="", kind="", page=page)
    if path.suffix.lower() in SHADERS:
        return _prepare_shader(engine, sketch, path, options, time, steps)
    plan = engine.plan(sketch, DEFAULT_PICTURE, time, steps)
    if path.suffix.lower() in MESHES:
        return _prepare_mesh(sketch, path, options, plan)
    texture, kind = options.texture, options.kind
    if texture:
        plan.flat.ref(texture, sketch.name)
        kind = kind or kind_of(plan, texture)
    else:
        texture, kind = height_of(plan), kind or HEIGHT
    return ExportJob(
        sketch=sketch,
        path=path,
        options=replace(options, bits=bits_for(path, kind, options)),
        plan=plan,
        texture=texture,
        kind=kind,
    )


def _prepare_shader(
    engine: Engine,
    sketch: Sketch,
    path: Path,
    options: ExportOptions,
    time: float,
    steps: Mapping[str, int] | None,
) -> ExportJob:
    if steps:
        raise DataError("a shader's text has all steps of a repeat; leave --steps out", file=path)
    made = shader_files(sketch, path, texture=options.texture, kind=options.kind, time=time)
    check_es(engine.ctx, path, made.files[path].decode())
    return ExportJob(
        sketch=sketch,
        path=path,
        options=options,
        plan=made.plan,
        texture=options.texture,
        kind=options.kind,
        shader=made,
    )


def _prepare_mesh(sketch: Sketch, path: Path, options: ExportOptions, plan: Plan) -> ExportJob:
    height, texture, kind = height_of(plan), options.texture, options.kind or COLOUR
    if path.suffix.lower() not in TEXTURED:
        texture = ""
    elif texture:
        plan.flat.ref(texture, sketch.name)
        kind = options.kind or kind_of(plan, texture)
        kind = NUMBERS if kind == HEIGHT else kind  # 0 to 1 may be seen; metres would be all white
    else:
        texture = view_input(plan, "colour")
    light = view_input(plan, "light") if options.light else ""
    if options.light and not light:
        raise SketchError(f"sketch {sketch.name} has no light to bake in")
    return ExportJob(
        sketch=sketch,
        path=path,
        options=options,
        plan=plan,
        texture=texture,
        kind=kind,
        height=height,
        light=light,
    )


def run(engine: Engine, job: ExportJob) -> Exported:
    """Make the textures that a job needs and write its files, all of them or none."""
    if job.shader is not None:
        write_together(job.shader.files)
        sidecars = tuple(path for path in job.shader.files if path != job.path)
        return Exported(job.path, job.shader.summary, sidecars, job.shader.warnings)
    if job.page is not None:
        html, summary = page_bytes(engine, job.sketch, job.page, job.options.language or "en")
        write_together({job.path: html})
        return Exported(job.path, summary, (), job.page.warnings)
    return _write_mesh(engine, job) if job.ending in MESHES else _write_values(engine, job)


def _read(engine: Engine, job: ExportJob, texture: str, kind: str) -> NDArray[np.float32]:
    """Return a texture with its north row first, heights in metres, colours without their alpha."""
    values = engine.read(job.sketch, texture, time=job.plan.time, steps=job.plan.steps)[::-1]
    channels = 1 if values.ndim == 2 else values.shape[2]
    if kind == HEIGHT:
        if channels != 1:
            raise SketchError(f"texture '{texture}' has {channels} channels; heights have one")
        return job.plan.terrain.metres(values)
    if kind == COLOUR:
        if channels == 2:
            raise SketchError(f"texture '{texture}' has 2 channels; colours have one or three")
        return values[..., :3] if channels > 3 else values
    return values


def _write_values(engine: Engine, job: ExportJob) -> Exported:
    values = _read(engine, job, job.texture, job.kind)
    channels = 1 if values.ndim == 2 else values.shape[2]
    if job.ending in RAW and channels != 1:
        raise DataError(f"a raw file holds one number a texel; '{job.texture}' has {channels}", file=job.path)
    if job.ending == ".png" and channels == 2:
        raise DataError(
            f"a PNG holds 1, 3 or 4 channels; '{job.texture}' has 2, as .tif, .exr and .npy can",
            file=job.path,
        )
    rows, cols = values.shape[:2]
    spacing = _spacing(job, (cols, rows))
    with naming(job.path):
        span = job.options.span
        if span is None and job.kind == COLOUR and is_light(job.plan, job.texture):
            span = light_span(values) if whole_numbers(job.ending, job.options.bits) else None
        if job.ending in PICTURES:
            made = encode_picture(values, job.ending, span or (0.0, 1.0))
        else:
            layer = Layer(values, job.kind, spacing, job.options.bits, span, _place(job))
            made = encode(layer, job.ending)
    files = {job.path: made.data}
    sidecars = tuple(sidecar_paths(job.path)) if made.sidecar else ()
    files |= dict.fromkeys(sidecars, made.sidecar)
    write_together(files)
    parts = [f"{cols} x {rows}", *made.details, f"{spacing[0]:.5g} x {spacing[1]:.5g} m a texel"]
    georeference = _place(job)
    if georeference is not None and georeference.crs.facts.kind and job.ending in (".tif", ".tiff"):
        parts.append(f"in its place, in {georeference.crs.name or 'the reference system of its file'}")
    return Exported(job.path, "; ".join(parts), sidecars, (made.warning,) if made.warning else ())


def _spacing(job: ExportJob, size: tuple[int, int]) -> tuple[float, float]:
    extent = job.plan.terrain.extent
    assert extent is not None  # a plan's terrain is known
    return extent[0] / max(size[0] - 1, 1), extent[1] / max(size[1] - 1, 1)


def _place(job: ExportJob) -> Georeference | None:
    """Return where a texture lies on the Earth; None for the picture, and where nothing says it."""
    return None if job.texture.partition(":")[0].partition(".")[0] == "view" else job.plan.terrain.place


def _write_mesh(engine: Engine, job: ExportJob) -> Exported:
    heights = _read(engine, job, job.height, HEIGHT)
    grid = job.options.grid or min(DEFAULT_GRID, MESHES[job.ending])
    size = fitted((heights.shape[1], heights.shape[0]), grid)
    baked, texels, warning = _texture(engine, job)
    extent = job.plan.terrain.extent
    assert extent is not None  # a plan's terrain is known
    with naming(job.path):
        mesh = terrain_mesh(_exaggerated(job, sampled(heights, size)), extent, texels or (2, 2))
    name = job.sketch.name
    sidecars: list[Path] = []
    if job.ending == ".glb":
        glb = encode_glb(mesh, name, texture=baked, unlit=bool(job.light), software=SOFTWARE)
        files = {job.path: glb}
    elif job.ending == ".stl":
        files = {job.path: encode_stl(mesh, SOFTWARE)}
    else:
        library, picture = sidecar_paths(job.path)
        sidecars = [library, picture] if baked else [library]
        named = picture.name if baked else ""
        files = {path: baked for path in sidecars[1:]}
        files[library] = encode_mtl(texture=named, unlit=bool(job.light), software=SOFTWARE)
        files[job.path] = encode_obj(mesh, name, library=library.name, software=SOFTWARE)
    write_together(files)
    low, high = float(mesh.positions[:, 1].min()), float(mesh.positions[:, 1].max())
    parts = [
        f"{size[0]} x {size[1]} vertices, {len(mesh.triangles)} triangles",
        f"{extent[0]:.7g} x {extent[1]:.7g} m, {low:.5g} to {high:.5g} m high",
        f"texture {texels[0]} x {texels[1]}" if texels else _NO_TEXTURE if job.ending in TEXTURED else "",
        f"{job.options.exaggeration:g} times as high as it is" if job.options.exaggeration else "",
    ]
    notes = [warning]
    if job.options.grid > max(size):
        notes.append(
            f"the terrain has {max(size)} texels on its longer side, so the mesh has no more vertices"
        )
    summary = "; ".join(filter(None, parts))
    return Exported(job.path, summary, tuple(sidecars), tuple(filter(None, notes)))


def _exaggerated(job: ExportJob, heights: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return heights [m] as they are asked for: what is at height 0 of the terrain stays where it is."""
    base, factor = job.plan.terrain.base_elevation, job.options.exaggeration or 1.0
    assert base is not None  # a plan's terrain is known
    return heights if factor == 1.0 else ((heights - base) * factor + base).astype(np.float32)


def _texture(engine: Engine, job: ExportJob) -> tuple[bytes, tuple[int, int] | None, str]:
    """Return the PNG that is draped over the mesh, its size, and a message on what was clamped."""
    layers = []
    if job.texture:
        layers.append(_three(_read(engine, job, job.texture, job.kind)))
    if job.light:
        layers.append(_three(_read(engine, job, job.light, COLOUR)))
    if not layers:
        return b"", None, ""
    size = max(v.shape[1] for v in layers), max(v.shape[0] for v in layers)
    colours = sampled(layers[0], size)
    for other in layers[1:]:
        colours = colours * sampled(other, size)
    with naming(job.path):
        if job.kind != COLOUR and not job.light:
            made: Encoded = encode(Layer(colours, NUMBERS, (1.0, 1.0), 8), ".png")
            return made.data, size, made.warning
        samples, warning = colour_samples(colours)
    return encode_samples(samples, {"Software": SOFTWARE}), size, warning


def _three(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return three channels: grey is repeated, a missing blue is 0, alpha is left out."""
    if values.ndim == 2:
        return np.repeat(values[..., None], 3, axis=2)
    if values.shape[2] == 2:
        return np.concatenate([values, np.zeros_like(values[..., :1])], axis=2)
    return values[..., :3]


def write_together(files: Mapping[Path, bytes]) -> None:
    """Write files that belong together; when one fails, none of them takes its name.

    Raises:
        DataError: a missing folder, no permission, a full disk.
    """
    with ExitStack() as stack:
        handles = [(stack.enter_context(replacing(path)), data) for path, data in files.items()]
        for handle, data in handles:
            handle.write(data)
            handle.flush()  # a full disk shows here, before any file has its name
