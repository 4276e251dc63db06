"""Export a sketch's terrain for other programs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any

import typer

from playground.commands import options
from playground.commands.arguments import (
    Moment,
    Renderer,
    either,
    help_text,
    moment_of,
    read_option,
    read_steps,
    read_values,
    within,
)
from playground.commands.options import flag, value
from playground.commands.standard_input import kept
from playground.commands.standard_output import NAME, check_standard_output, write_file
from playground.errors import (
    DataError,
    Diagnostic,
    ParameterError,
    PlaygroundError,
    ShaderError,
    SketchError,
)
from playground.publish.export_formats import DEFAULT_GRID, ENDINGS, KINDS, PIPED
from playground.terminal import busy, complain, note

if TYPE_CHECKING:
    from playground.publish.export_formats import ExportOptions


HELP = help_text(
    "Export a sketch's terrain, its shader, or all of it as a web page, and print the paths of the files.\n\n"
    "Without --texture, .png, .tif, .r16, .raw, .r32, .exr and .npy hold the heights: metres above sea"
    " level as floats, or 16-bit numbers from the lowest to the highest, and a note says which heights those"
    " are. With it, they hold that texture; .png, .webp and .jpg encode colours as sRGB. The first row is"
    " the north's. A .tif lies where the elevation file of the terrain does, in its reference system.\n\n"
    ".glb (glTF) and .obj hold the terrain as a mesh with its texture, in metres: x east, y up, z south,"
    " the terrain's middle at x = z = 0, sea level at y = 0. .stl holds its shape alone, in metres: x east, y"
    " north, z up.\n\n"
    ".fs (ISF), .frag (a Shadertoy text of one pass), .json (a Shadertoy export: up to four buffers, an Image"
    " and what they share) and .glsl (a fragment shader of its own) hold the picture as a shader, or with"
    " --texture one texture. What cannot leave is named, and no shader is written.\n\n"
    ".html is a web page: one file that anybody can open, without a network, in which the sketch runs, can"
    " be turned, set and edited. With --technique the page has menus of techniques, with --trace it shows,"
    " for any texel, the values of every line of its shaders.\n\n"
    "With --to -, one file goes to standard output, in the form that --format names. As SKETCH, - is a"
    " shader's text from standard input, which is kept as a new file in this folder.",
    "playground export jacksboro",
    "playground export jacksboro --to terrain.png --to terrain.tif",
    "playground export dem.tif --set height.longest=16384 --to in-its-place.tif",
    "playground export diamond_square --set size=1025 --to terrain.r16",
    "playground export jacksboro --texture colour --to ground.webp",
    "playground export jacksboro --to terrain.glb --light --grid 257",
    "playground export jacksboro --to model.stl",
    "playground export jacksboro --preset evening --light --to terrain.obj",
    "playground export fbm --texture height --to hills.json",
    "playground export deterministic_fractal --to fractal.fs",
    "playground export jacksboro --to page.html",
    "playground export jacksboro --to - --format tif > terrain.tif",
    "playground export fbm --technique height=generation/fbm,generation/mixed --to noise.html",
    "playground export diamond_square --trace --to steps.html",
)


def _complete_language(incomplete: str) -> list[str]:
    """Return the codes of a page's languages that complete a word."""
    from playground.publish.web.page import LANGUAGES

    return [code for code in LANGUAGES if code.startswith(incomplete)]


def export(
    ctx: typer.Context,
    sketch: options.Sketch = "",
    to: Annotated[
        list[str] | None,
        value(
            "-o --to FILE",
            f"A file to write, ending in {either(ENDINGS)}, or - for standard output. May be repeated."
            " Without it, a .glb of a new name in this folder.",
        ),
    ] = None,
    form_named: Annotated[
        str,
        value(
            "--format FORM",
            f"What --to - writes: {either([e[1:] for e in PIPED])}; glb without it.",
        ),
    ] = "",
    texture: Annotated[
        str,
        value(
            "--texture PASS",
            "Write this pass's texture instead of the heights, or drape it over the mesh.",
        ),
    ] = "",
    kind: Annotated[
        str,
        value(
            "--as KIND",
            f"What the texture holds: {either(KINDS)}. Without it, by its name:"
            " height; colour and light; anything else.",
        ),
    ] = "",
    bits: Annotated[
        str, value("--bits N", "Bits of a number, 8, 16 or 32, where the format has a choice.")
    ] = "",
    span: Annotated[
        str,
        value(
            "--range LOW,HIGH",
            "What 0 and the largest whole number mean: in metres for heights, black and white for colours.",
        ),
    ] = "",
    grid: Annotated[
        str,
        value(
            "--grid N",
            f"Vertices of a mesh's longer side. Without it, one for each texel, up to {DEFAULT_GRID}.",
        ),
    ] = "",
    light: Annotated[
        bool, flag("--light", "Bake the light into a mesh's texture, and ask for no other light.")
    ] = False,
    technique: Annotated[
        list[str] | None,
        value(
            "--technique PASS[=NAME,…]",
            "In a web page, a menu of techniques for this pass: those named, or all that fit."
            " May be repeated.",
        ),
    ] = None,
    trace: Annotated[
        bool,
        flag(
            "--trace",
            "In a web page, show the values of every line beside the code, for a texel that one clicks on.",
        ),
    ] = False,
    lang: Annotated[
        str,
        value(
            "--lang CODE",
            "Language of a web page's interface: en or fr; English without it. Names and explanations of"
            " parameters, and notes, stay in English.",
            _complete_language,
        ),
    ] = "",
    settings: options.Set = None,
    shot: Annotated[str, value("--shot NAME", "Export the terrain of a shot of the sketch.")] = "",
    preset: options.Preset = "",
    steps: options.Steps = None,
    time: options.Time = None,
    driver: options.Driver = "auto",
    plain: options.Plain = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Write the terrain or a texture to files, and print the files' paths."""
    from playground.publish.export_formats import ExportOptions
    from playground.sketch.load import load

    export_options = ExportOptions(
        texture=texture,
        kind=kind,
        bits=_read_whole("--bits", bits),
        span=_read_span(span),
        grid=_read_whole("--grid", grid),
        light=light,
        techniques=_read_techniques(technique or []),
        trace=trace,
        language=lang,
    )
    values, stops = read_values(settings), read_steps(steps)
    moment = moment_of(
        load(kept(sketch, "export")).plainly(plain),
        shot=shot,
        preset=preset,
        values=values,
        steps=stops,
        time=time,
    )
    names, renderer = to or [], ctx.obj.or_else(software, device)
    if NAME in names:
        _write_piped(moment, names, _read_format(form_named), export_options, driver, renderer)
    elif form_named:
        raise ParameterError("--format is for --to -; the name of a file says what it holds")
    else:
        _write(moment, names, export_options, driver, renderer)


def _write_piped(
    moment: Moment,
    names: list[str],
    ending: str,
    export_options: ExportOptions,
    driver: str,
    renderer: Renderer,
) -> None:
    """Write one file to standard output, by way of a folder that is removed."""
    from playground.publish.export import prepare, run
    from playground.publish.export_formats import check

    if len(names) > 1:
        raise ParameterError("--to - writes one file to standard output; leave the other --to out")
    check_standard_output("--to", f"a {ending} file")
    sketch = moment.sketch
    with TemporaryDirectory(prefix="playground-") as folder:
        path = Path(folder) / f"{sketch.name}{ending}"
        check(path, export_options)
        with busy(f"exporting {sketch.name}") as show, renderer.open_engine(driver=driver) as engine:
            engine.runner.works.on_progress = show
            at: dict[str, Any] = {"time": moment.time, "steps": moment.steps, "frame": moment.size}
            done = run(engine, prepare(engine, sketch, path, export_options, **at))
        if done.sidecars:
            raise DataError(f"{', '.join(p.name for p in done.sidecars)} belong to it; name a file with --to")
        note(f"standard output: {done.summary}")
        for warning in done.warnings:
            complain(f"standard output: {warning}", "warning")
        write_file(done.path)


def _write(
    moment: Moment, names: list[str], export_options: ExportOptions, driver: str, renderer: Renderer
) -> None:
    from playground.files import new_name
    from playground.publish.export import ExportJob, prepare, run
    from playground.publish.export_formats import check

    sketch = moment.sketch
    with ExitStack() as stack:
        paths = [Path(name).expanduser() for name in names]
        _refuse_twins(paths)
        if not paths:
            check(Path(f"{sketch.name}.glb"), export_options)
            paths = [stack.enter_context(new_name(f"{sketch.name}.glb"))]
        errors, checked, jobs, count = dict[Diagnostic, None](), list[Path](), list[ExportJob](), 0
        for path in paths:
            with _collecting(errors):
                check(path, export_options)
                checked.append(path)
        if checked:
            show = stack.enter_context(busy(f"exporting {sketch.name}"))
            engine = stack.enter_context(renderer.open_engine(driver=driver))
            engine.runner.works.on_progress = show
        at: dict[str, Any] = {"time": moment.time, "steps": moment.steps, "frame": moment.size}
        # Every file is prepared before the first is written.
        for path in checked:
            with _collecting(errors):
                jobs.append(prepare(engine, sketch, path, export_options, **at))
        for job in jobs:
            with _collecting(errors):
                done = run(engine, job)
                count += 1
                note(f"{done.path.name}: {done.summary}")
                for warning in done.warnings:
                    complain(f"{done.path.name}: {warning}", "warning")
                for path in (done.path, *done.sidecars):
                    print(path)
        if errors:
            if len(paths) > 1:
                note(f"{count} of {len(paths)} files are written")
            raise PlaygroundError(diagnostics=errors)


@contextmanager
def _collecting(errors: dict[Diagnostic, None]) -> Iterator[None]:
    """Collect the mistakes of one file, each once; the others are written all the same."""
    try:
        yield
    except (SketchError, ShaderError, DataError) as error:
        errors |= dict.fromkeys(error.diagnostics)


def _read_format(text: str) -> str:
    """Return the ending of ``--format``; raise ``ParameterError``."""
    ending = f".{text.lower().removeprefix('.')}" if text else ".glb"
    if ending not in PIPED:
        more = "; it is more than one file" if ending in ENDINGS else ""
        expected = either([e[1:] for e in PIPED])
        raise ParameterError(f"--format {text} cannot go to standard output{more}; expected {expected}")
    return ending


def _refuse_twins(paths: list[Path]) -> None:
    from playground.publish.export_formats import sidecar_paths

    taken: set[Path] = set()
    for path in paths:
        files = {file.resolve(): file for file in (path, *sidecar_paths(path))}
        twins = [named for file, named in files.items() if file in taken]
        if twins:
            raise ParameterError(f"--to {path}: {min(twins)} would be written twice; choose another name")
        taken |= files.keys()


def _read_whole(name: str, text: str) -> int:
    return read_option(name, text, within(1, 10**6 - 1), "a whole number above 0") or 0


def _read_techniques(texts: list[str]) -> dict[str, tuple[str, ...]]:
    """Return techniques by pass; none for a pass: all that fit."""
    techniques: dict[str, tuple[str, ...]] = {}
    for text in texts:
        name, equals, listed = text.partition("=")
        uses = tuple(use.strip() for use in listed.split(",") if use.strip())
        if not name.strip() or (equals and not uses):
            message = f"--technique {text}: expected a pass, as height, or with techniques,"
            raise ParameterError(f"{message} as height=FOLDER/FIRST,FOLDER/SECOND")
        if name.strip() in techniques:
            raise ParameterError(
                f"--technique {name.strip()} is given twice; list its techniques with commas"
            )
        techniques[name.strip()] = uses
    return techniques


def _read_span(text: str) -> tuple[float, float] | None:
    def read(text: str) -> tuple[float, float]:
        low, high = (float(part) for part in text.split(","))
        return low, high

    return read_option("--range", text, read, "two numbers, as 0,2500")
