"""Load a sketch from a TOML, a folder, a shader or an elevation file.

A sketch is data: nothing in it is run, and the files it names lie in its own folder or in ``glsl/``.

Around an elevation file a sketch is made as a text, so that it can be saved as it is and edited. Extent,
relief and base elevation are not in that text: they come from the file.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from playground.allowed_files import (
    SHADERS,
    is_absolute,
    is_elevation,
    is_file,
    is_variant,
    looking_once,
    named_root,
    root_of,
)
from playground.errors import SketchError
from playground.paths import DEFAULT_SKETCH, GLSL, PLAIN_SKETCH, SKETCHES, shown
from playground.shader.dialect import check_name, dialects
from playground.sketch.assign import effective_values, shown_parameters
from playground.sketch.find import find
from playground.sketch.flatten import flatten
from playground.sketch.model import (
    ComputeVariant,
    Graph,
    Kernel,
    PassSpec,
    PictureSettings,
    PlainShader,
    Sketch,
    Technique,
    Value,
)
from playground.sketch.techniques import (
    Techniques,
    check_kernel_count,
    lonely_variant,
    nothing_to_run,
    read_technique,
    technique_beside,
)
from playground.sketch.toml_sketch import SKETCH_KEYS, TECHNIQUE_KEYS, read_sketch
from playground.sketch.toml_table import TomlFile
from playground.sketch.toml_text import text_of
from playground.sketch.wiring import output_names

_TEXT = Path(__file__).with_name("elevation_sketch.toml")


def elevation_text(path: Path, file: str) -> str:
    """Return the TOML of a sketch around an elevation file, which it names ``file``."""
    name = re.sub(r"[^ -~]|`", "_", path.name)
    words = {
        "@TITLE@": name,
        "@NAME@": name,
        '"@TITLE_TEXT@"': text_of(path.stem),
        '"@FILE@"': text_of(file),
    }
    return re.sub("|".join(words), lambda match: words[match[0]], _TEXT.read_text(encoding="utf-8"))


def elevation_sketch(path: Path, techniques: Techniques) -> Sketch:
    """Return the sketch around an elevation file; the file itself is not read yet."""
    sketch = read_sketch(TomlFile(path, path.parent, elevation_text(path, path.name)), techniques.read)
    # No line of the file itself says any of it.
    passes = tuple(replace(spec, line=0) for spec in sketch.graph.passes)
    return replace(sketch, graph=replace(sketch.graph, passes=passes))


def load(name: str | Path = "", *, dialect: str = "") -> Sketch:
    """Load a sketch by the name of a shipped one, or by path; with no name, the shipped default.

    A path is a TOML, a folder that holds ``sketch.toml``, a shader, or an elevation file, around which a
    sketch is made. A technique alone, a kernel or a TOML of several passes, takes the place of the pass
    with its outputs in the sketch ``jacksboro``; a plain shader is the whole picture, and so is another
    tool's shader, whose ``dialect`` its text decides unless it is named.

        sketch = playground.load("l_dot_n")
        print(sketch.title, sketch.terrain.size)

    Raises ``SketchError`` or ``ShaderError`` naming file, line, what was found and expected.
    """
    return load_with(Techniques(check_name(dialect)), name)


def opened(sketch: Sketch | str | Path) -> Sketch:
    """Return the sketch itself, or the one of that name or path."""
    return sketch if isinstance(sketch, Sketch) else load(sketch)


@looking_once()
def load_with(techniques: Techniques, name: str | Path = "", text: str | None = None) -> Sketch:
    """Load a sketch as ``load`` does, but read again no technique that these techniques have read.

    ``text`` is what a TOML file would hold, and is read in place of it.
    """
    if not isinstance(name, str | Path):
        raise SketchError(f"a sketch is loaded by its name or its path, not by {name!r}")
    path = find(name or DEFAULT_SKETCH).resolve()
    path = technique_beside(path) or path
    try:
        if path.suffix in SHADERS or (path.suffix != ".toml" and path.suffix in dialects().endings):
            return _shader_alone(path, techniques)
        if techniques.dialect:
            raise SketchError("--dialect is for a shader file", file=path)
        if is_elevation(path):
            return elevation_sketch(path, techniques)
        file = TomlFile(path, named_root(path) or path.parent, text)
        if is_variant(path):
            raise lonely_variant(path)
        if _holds_technique(file):
            return _in_plain_sketch(path, techniques.graph(path, f"./{path.stem}", root_of(path)))
        sketch = read_sketch(file, techniques.read)
        check_kernel_count(sketch.graph)
        return sketch
    except RecursionError:
        raise SketchError("its tables or techniques nest too deeply", file=path) from None


def is_technique(path: Path) -> bool:
    """Return whether a TOML file is a technique of several passes, not a sketch."""
    try:
        return _holds_technique(TomlFile(path, path.parent))
    except SketchError:
        return False


def _holds_technique(file: TomlFile) -> bool:
    if file.path.is_relative_to(GLSL):
        return not file.path.is_relative_to(SKETCHES)
    keys = file.table.keys()
    if file.path.name == "sketch.toml" or keys & SKETCH_KEYS:
        return False
    return bool(keys & set(TECHNIQUE_KEYS))


def _shader_alone(path: Path, techniques: Techniques) -> Sketch:
    """Return a sketch that shows one shader file."""
    shader = techniques.shader(path, root_of(path), techniques.dialect)
    if shader is None:
        raise nothing_to_run(path)
    if isinstance(shader, ComputeVariant):
        raise lonely_variant(path)
    if isinstance(shader, Kernel) and not isinstance(shader, PlainShader):
        return _in_plain_sketch(path, shader)
    return plain_sketch(path, shader, _folder_of(path))


def plain_sketch(path: Path, technique: Technique, folder: Path) -> Sketch:
    """Return the sketch of a shader that is the whole picture; its files stay in ``folder``."""
    title = technique.title
    if isinstance(technique, Graph):
        title = f"{title or path.stem} ({technique.dialect})"
        graph = replace(technique, inputs=(), parameters=())  # of a sketch all are at view
    else:
        view = PassSpec("view", f"./{path.stem}", technique, file=shown(path))
        graph = Graph(path.stem, str(path), (view,), title=title)
    return Sketch(path.stem, str(path), str(folder), graph, title, picture=PictureSettings(samples=1))


def _folder_of(path: Path) -> Path:
    """Return the folder of the sketch that shows a technique: what the technique may read is in it."""
    root = root_of(path)
    return path.parent if root == GLSL else root


def _in_plain_sketch(path: Path, technique: Technique) -> Sketch:
    """Return ``jacksboro`` with a technique in the place of the pass that has its outputs."""
    plain = load(PLAIN_SKETCH)
    outputs = set(output_names(technique))
    passes = list(plain.graph.passes)
    index = next((i for i, p in enumerate(passes) if outputs & set(output_names(p.technique))), None)
    folder = _folder_of(path)
    use = f"./{path.relative_to(folder).with_suffix('').as_posix()}"
    line = technique.pragma.number if isinstance(technique, Kernel) and technique.pragma else 0
    spec = PassSpec("", use, technique, file=shown(path), line=line)
    if index is not None:
        passes[index] = replace(spec, name=passes[index].name)
    else:
        taken = [p.name for p in passes]
        name = next(n for n in (output_names(technique)[0], "alone", "alone_") if n not in taken)
        look = read_technique("view/map", GLSL, GLSL)
        view = PassSpec("view", "view/map", look, inputs=(("shown", name),), file=shown(path))
        passes = [*passes[:-1], replace(spec, name=name), view]
    graph = Graph(path.stem, str(path), tuple(passes), title=technique.title)
    sketch = replace(
        plain,
        name=path.stem,
        file=str(path),
        folder=str(folder),
        graph=graph,
        title=technique.title or path.stem,
        presets=(),
        shots=(),
        keyframes=(),
        overrides=_default_files(graph, plain),
    )
    own = next(p.name for p in passes if p.technique is technique)
    shown_first = (s.path for s in shown_parameters(sketch) if s.exported)
    sketch = replace(sketch, main=tuple(path for path in shown_first if path.startswith(f"{own}.")))
    flatten(sketch)
    return sketch


def _default_files(graph: Graph, plain: Sketch) -> tuple[tuple[str, Value], ...]:
    """Return the data files of that sketch's own passes by absolute path: they are in its folder."""
    values = effective_values(graph)
    remaining = {spec.name for spec in graph.passes if spec in plain.graph.passes}
    values_of_files: list[tuple[str, Value]] = []
    for path, parameter in graph.leaf_parameters.items():
        text = str(values[path])
        if parameter.widget.kind != "file" or path.partition(".")[0] not in remaining or is_absolute(text):
            continue
        file = Path(plain.folder) / text
        if text and is_file(file):
            values_of_files.append((path, str(file)))
    return tuple(values_of_files)
