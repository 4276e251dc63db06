"""Fill a pass of a sketch with another technique, or a shader with another text.

``with_texts`` puts texts in place of shaders' files: kernels are parsed again from them. ``with_technique``
fills a pass with another technique. One fits if its outputs have the names of those that it replaces, and
if each of its inputs can be wired. Whether the terrain's size suits it, only drawing tells.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

from playground.allowed_files import TECHNIQUES, looking_once
from playground.errors import DataError, ParameterError, PlaygroundError, SketchError, nearest
from playground.paths import GLSL
from playground.shader.dialect import dialects
from playground.shader.header import parse_kernel
from playground.shader.kernel import with_inner
from playground.shader.parameter import coerce
from playground.shader.source import read_source
from playground.sketch.assign import find_targets, resolve
from playground.sketch.find import is_part, shipped_names
from playground.sketch.flatten import flatten
from playground.sketch.model import ComputeVariant, Graph, Kernel, PassSpec, Sketch, Technique, Value
from playground.sketch.techniques import Techniques
from playground.sketch.wiring import output_names, outputs_with_formats, takes_input


def with_texts(sketch: Sketch, texts: Mapping[str, str]) -> Sketch:
    """Return the sketch with texts, by absolute path, in place of those of its shaders' files.

    Texts of files that the sketch does not use change nothing. Where a text says something else
    than its file, the fast variants of what is made of it no longer agree, and do not run. A main
    parameter that a text no longer declares is one no more.

    Raises ``DataError`` where a text leaves no kernel of its file, and ``ShaderError`` where
    a text's declarations or includes are wrong.
    """
    if not texts:
        return sketch
    techniques: dict[int, Any] = {}  # one technique may be in several passes

    def reread(technique: Technique) -> Technique:
        """Return the technique itself where none of the texts is in it."""
        if not any(file in texts for file in technique.files):
            return technique
        if id(technique) not in techniques:
            again = [(v, reread(v.technique)) for v in technique.variants]
            variants = tuple(
                replace(v, technique=t) for v, t in again if isinstance(t, ComputeVariant | Graph)
            )
            if isinstance(technique, Graph) and technique.dialect:
                techniques[id(technique)] = _read_again(technique, texts, Path(sketch.folder))
                if technique is sketch.graph:  # of a sketch all are at view
                    techniques[id(technique)] = replace(techniques[id(technique)], inputs=(), parameters=())
            elif isinstance(technique, Graph):
                techniques[id(technique)] = replace(with_inner(technique, reread), variants=variants)
            else:
                kernel = _parsed_again(technique, texts, Path(sketch.folder))
                techniques[id(technique)] = replace(kernel, variants=variants)
        return cast(Technique, techniques[id(technique)])

    graph = cast(Graph, reread(sketch.graph))
    return replace(sketch, graph=graph, main=tuple(path for path in sketch.main if find_targets(graph, path)))


def _read_again(graph: Graph, texts: Mapping[str, str], folder: Path) -> Graph:
    """Return another tool's shader by its texts."""
    path = Path(graph.path)
    root = GLSL if path.is_relative_to(GLSL) else folder
    technique = dialects().read(path, graph.name, root, Techniques().read, graph.dialect, instead=texts)
    if technique is None:
        raise DataError("no shader is left of this text", file=path)
    return technique


def _parsed_again(kernel: Kernel, texts: Mapping[str, str], folder: Path) -> Kernel:
    path = Path(kernel.path)
    root = folder if not path.is_relative_to(GLSL) else GLSL
    result = parse_kernel(kernel.name, read_source(path, (root,), texts))
    if result is None or isinstance(result, ComputeVariant) != isinstance(kernel, ComputeVariant):
        raise DataError("no kernel is left of this text", file=path)
    if isinstance(result, ComputeVariant):  # a compute variant has these of its technique
        return replace(result, outputs=kernel.outputs, accepts=kernel.accepts)
    return result


@looking_once()
def choices(sketch: Sketch, pass_name: str) -> list[str]:
    """List what may fill a pass, as ``use`` names it: the shipped, then the sketch's own (``./x``).

    What fills it now is always among them; a technique whose files are wrong is not.
    Raises ``SketchError`` if there is no such pass.
    """
    spec = _pass(sketch, pass_name)
    outputs = set(output_names(spec.technique))
    whole = [name for name in shipped_names() if not is_part(name)]
    own = own_names(sketch)
    read = reader_of(sketch)
    uses = dict.fromkeys([*whole, *own, spec.use])
    return [use for use in uses if use == spec.use or _fits(sketch, spec, use, outputs, read)]


@looking_once()
def fits(sketch: Sketch, pass_name: str, use: str) -> bool:
    """Return whether a technique is one of ``choices``; most are found out without reading the others.

    Raises ``SketchError`` if there is no such pass.
    """
    spec = _pass(sketch, pass_name)
    if use == spec.use:
        return True
    named = use in own_names(sketch) or (use in shipped_names() and not is_part(use))
    return named and _fits(sketch, spec, use, set(output_names(spec.technique)), reader_of(sketch))


@looking_once()
def nearest_fitting(sketch: Sketch, pass_name: str, use: str) -> str:
    """Suggest the one of ``choices`` that was probably meant, as ``errors.nearest`` does."""
    names = sorted({*own_names(sketch), *(name for name in shipped_names() if not is_part(name))})
    for close in get_close_matches(use, names, n=len(names), cutoff=0.55):
        if fits(sketch, pass_name, close):
            return nearest(use, [close])
    return nearest(use, choices(sketch, pass_name))


def with_technique(sketch: Sketch, pass_name: str, use: str) -> Sketch:
    """Return the sketch with a pass filled by ``use``, as ``choices`` names it.

    Wires to inputs that remain stay, and so do values whose parameters still exist and
    take them. Raises ``SketchError`` when the technique is missing, wrong, or cannot be wired.
    """
    spec = _pass(sketch, pass_name)
    if use == spec.use:
        return sketch
    return _refilled(sketch, spec, use, reader_of(sketch)(use))


def _pass(sketch: Sketch, name: str) -> PassSpec:
    spec = sketch.graph.find(name)
    if spec is None:
        raise SketchError(
            f"no pass '{name}' in sketch {sketch.name}{nearest(name, [p.name for p in sketch.graph.passes])}"
        )
    return spec


def reader_of(sketch: Sketch) -> Callable[[str], Technique]:
    """Return what reads what ``use`` names in a sketch's folder, each technique once."""
    folder, techniques = Path(sketch.folder), Techniques()
    return lambda use: techniques.read(use, folder, folder)


def own_names(sketch: Sketch) -> list[str]:
    """Name the files in the sketch's folder that could be techniques; library files and sketches as well."""
    files = [p for p in Path(sketch.folder).glob("*.*") if p.suffix in TECHNIQUES and str(p) != sketch.file]
    return sorted({f"./{p.stem}" for p in files if p.is_file()})


def _fits(
    sketch: Sketch, spec: PassSpec, use: str, outputs: set[str], read: Callable[[str], Technique]
) -> bool:
    try:
        technique = read(use)
        if set(output_names(technique)) != outputs:
            return False
        if spec.name == "view" and _formats(technique) != _formats(spec.technique):
            return False  # a picture of linear light is a step on the way to the one that is shown
        _refilled(sketch, spec, use, technique)
    except PlaygroundError:
        return False
    return True


def _formats(technique: Technique) -> list[str]:
    """Return the formats of a technique's outputs."""
    outputs = technique.outputs if isinstance(technique, Kernel) else outputs_with_formats(technique)
    return [output.format for output in outputs]


def _refilled(sketch: Sketch, spec: PassSpec, use: str, technique: Technique) -> Sketch:
    outputs = output_names(technique)
    feedback = tuple((i, o) for i, o in spec.feedback if takes_input(technique, i) and o in outputs)
    filled = replace(
        spec,
        use=use,
        technique=technique,
        inputs=tuple((name, source) for name, source in spec.inputs if takes_input(technique, name)),
        values=_values_taken(technique, spec.values),
        feedback=feedback,
        repeat=spec.repeat if feedback or not spec.feedback else "",
    )
    passes = tuple(filled if other is spec else other for other in sketch.graph.passes)
    prefix = f"{spec.name}."
    own = [(path.removeprefix(prefix), value) for path, value in sketch.overrides if path.startswith(prefix)]
    overrides = [pair for pair in sketch.overrides if not pair[0].startswith(prefix)]
    overrides += [(prefix + path, value) for path, value in _values_taken(technique, own)]
    graph = replace(sketch.graph, passes=passes)
    main = tuple(path for path in sketch.main if find_targets(graph, path))
    result = replace(sketch, graph=graph, main=main, overrides=tuple(overrides))
    flatten(result)
    return result


def _values_taken(technique: Technique, values: Iterable[tuple[str, Value]]) -> tuple[tuple[str, Value], ...]:
    values_kept = []
    for path, value in values:
        with suppress(ParameterError):
            coerced = coerce(resolve(technique, path)[0].parameter, value, path)
            values_kept.append((path, coerced))
    return tuple(values_kept)
