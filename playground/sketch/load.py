"""Read a sketch and every technique it uses from their files.

``load(name or path)`` is the way in. A sketch is data: nothing in it is run, and the
files it names lie in its own folder or in ``glsl/``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from playground.errors import ParameterError, SketchError, nearest
from playground.paths import DEFAULT_SKETCH, GLSL, SKETCHES, shown
from playground.sketch import flatten
from playground.sketch.assign import check_values, flat_values, values_of
from playground.sketch.header import parse_kernel
from playground.sketch.model import (
    Camera,
    Export,
    Graph,
    Kernel,
    PassSpec,
    Preset,
    Shot,
    Sketch,
    Technique,
    Value,
    kernels_of,
)
from playground.sketch.source import read_source, read_text
from playground.sketch.toml_lines import Place, key_lines, line_of

FORMAT = 1
_SHADERS = (".glsl", ".frag", ".comp", ".fs", ".fragment")
_MAX_NESTING = 16


def load(name: str | Path = "") -> Sketch:
    """Load a sketch by the name of a shipped one, or by path: a TOML, a folder holding ``sketch.toml``, a GLSL file.

    With no name, the shipped default. A kernel alone, or a technique of several passes,
    takes the place of the pass with its outputs in the default sketch; a plain shader is
    the whole picture.

    Raises ``SketchError`` or ``ShaderError`` naming file, line, what was found and expected.
    """
    path = find(name or DEFAULT_SKETCH)
    if path.suffix in _SHADERS or is_technique(path):
        return _alone(path)
    return _Toml(path, path.parent.resolve()).sketch()


def find(name: str | Path) -> Path:
    """Return the file that a sketch's name or path stands for; raise ``SketchError`` if there is none."""
    path = Path(name).expanduser()
    if path.is_dir():
        if (path / "sketch.toml").is_file():
            return path / "sketch.toml"
        raise SketchError("this folder holds no sketch.toml", file=shown(path))
    if path.is_file():
        if path.suffix not in (".toml", *_SHADERS):
            raise SketchError(f"a sketch is a .toml, a shader ends in {', '.join(_SHADERS)}", file=shown(path))
        return path
    text = str(name)
    shipped = SKETCHES / f"{text}.toml"
    if shipped.is_file() and "/" not in text and "\\" not in text:
        return shipped
    inside = [GLSL / f"{text}{suffix}" for suffix in ("", ".toml", ".glsl")]
    for candidate in inside:
        if candidate.is_file() and candidate.resolve().is_relative_to(GLSL):
            return candidate
    names = shipped_sketches()
    raise SketchError(f"there is no file and no shipped sketch '{text}'{nearest(text, names)}")


def shipped_sketches() -> list[str]:
    """List the names of the sketches that ship."""
    return sorted(path.stem for path in SKETCHES.glob("*.toml"))


def shipped_techniques() -> list[str]:
    """List the names of the techniques in ``glsl/``: kernels, draws, sources and TOML techniques."""
    names = []
    for path in sorted(GLSL.rglob("*")):
        if path.suffix == ".toml" and not path.is_relative_to(SKETCHES):
            names.append(path.relative_to(GLSL).with_suffix("").as_posix())
        elif path.suffix == ".glsl" and read_kernel(path, GLSL) is not None:
            names.append(path.relative_to(GLSL).with_suffix("").as_posix())
    return names


def read_kernel(path: Path, folder: Path) -> Kernel | None:
    """Read one GLSL file with its ``.comp`` companion; None for a library file."""
    path = path.resolve()
    name = path.relative_to(GLSL).with_suffix("").as_posix() if path.is_relative_to(GLSL) else path.stem
    companion = None
    beside = path.with_suffix(".comp")
    kernel = parse_kernel(name, read_source(path, (folder,)))
    if kernel is not None and path.suffix == ".glsl" and kernel.kind == "kernel" and beside.is_file():
        companion = _read_companion(beside, folder, kernel.outputs)
        _check_companion(companion, {p.name for p in kernel.parameters}, {i.name for i in kernel.inputs}, kernel)
        kernel = _with(kernel, companion=companion)
    return kernel


def read_technique(use: str, folder: Path, root: Path, _depth: int = 0) -> Technique:
    """Return what ``use`` names: ``./x`` in ``folder`` (inside ``root``), else in ``glsl/``.

    Raises ``SketchError`` with the nearest name when there is none.
    """
    own = use.startswith("./")
    base = (folder if own else GLSL) / (use[2:] if own else use)
    limit = root if own else GLSL
    if not base.resolve().is_relative_to(limit.resolve()):
        raise SketchError(f"use = '{use}' lies outside {'the sketch’s own folder' if own else 'glsl/'}")
    toml, shaders = base.with_name(base.name + ".toml"), [base.with_name(base.name + s) for s in (".glsl", ".frag")]
    present = [p for p in (toml, *shaders) if p.is_file()]
    if len(present) > 1:
        raise SketchError(f"use = '{use}' is both {shown(present[0])} and {shown(present[1])}; remove one")
    if not present:
        known = shipped_names() if not own else [f"./{p.stem}" for p in folder.glob("*.glsl")]
        ending = f" (without '{base.suffix}')" if base.suffix in (".glsl", ".toml") else ""
        raise SketchError(f"there is no technique '{use}'{ending}{nearest(use, known)}")
    if present[0] == toml:
        if _depth >= _MAX_NESTING:
            raise SketchError(f"techniques nest more than {_MAX_NESTING} deep; does '{use}' use itself?")
        return _Toml(toml, limit.resolve(), _depth + 1).technique(use)
    kernel = read_kernel(present[0], root)
    if kernel is None:
        raise SketchError(f"'{use}' is a library file: it has no #pragma kernel, source or draw to run")
    return kernel


def shipped_names() -> list[str]:
    """List every name that ``use`` may take in ``glsl/``, without reading the files."""
    found = [p for p in GLSL.rglob("*") if p.suffix in (".glsl", ".toml") and not p.is_relative_to(SKETCHES)]
    return sorted({p.relative_to(GLSL).with_suffix("").as_posix() for p in found})


def _with(kernel: Kernel, **changes: Any) -> Kernel:
    return replace(kernel, **changes)


def _read_companion(path: Path, folder: Path, outputs: tuple[Any, ...]) -> Kernel:
    name = path.stem
    companion = parse_kernel(name, read_source(path, (folder,)))
    if companion is None or companion.kind != "compute":
        raise SketchError('a .comp beside a kernel begins with #pragma compute(groups = "…")', file=shown(path))
    return _with(companion, outputs=outputs)


def _check_companion(companion: Kernel, parameters: set[str], inputs: set[str], of: Kernel | Graph) -> None:
    for item in (*companion.parameters, *companion.inputs):
        valid = inputs if item in companion.inputs else parameters
        if item.name not in valid:
            raise SketchError(
                f"'{item.name}' is not among the parameters and inputs of {of.name}{nearest(item.name, valid)}",
                file=shown(companion.path),
                line=item.line,
            )


def is_technique(path: Path) -> bool:
    """Say whether a TOML file is a technique of several passes, not a sketch."""
    path = path.resolve()
    if path.is_relative_to(GLSL):
        return not path.is_relative_to(SKETCHES)
    try:
        keys = tomllib.loads(read_text(path)).keys()
    except (SketchError, tomllib.TOMLDecodeError):
        return False
    if path.name == "sketch.toml" or keys & {"view", "shot", "preset", "size", "extent", "relief"}:
        return False
    return bool(keys & {"parameters", "inputs", "outputs"})


def _alone(path: Path) -> Sketch:
    """Return a sketch that shows one shader file, or one technique."""
    path = path.resolve()
    if path.suffix == ".comp" and path.with_suffix(".glsl").is_file():
        path = path.with_suffix(".glsl")
    technique: Technique | None
    if path.suffix == ".toml":
        root = GLSL if path.is_relative_to(GLSL) else path.parent
        technique = _Toml(path, root, 1).technique(path.stem)
    else:
        technique = read_kernel(path, path.parent)
    if technique is None:
        raise SketchError("a library file: it has no #pragma kernel, source or draw to run", file=shown(path))
    kind = technique.kind if isinstance(technique, Kernel) else ""
    if kind == "compute":
        raise SketchError(f"a companion runs in place of {path.stem}.glsl, which is missing", file=shown(path))
    if kind.startswith("plain"):
        view = PassSpec("view", f"./{path.stem}", technique, file=shown(path))
        graph = Graph(path.stem, str(path), (view,), title=technique.title)
        return Sketch(path.stem, str(path), str(path.parent), graph, technique.title, samples=1)
    return _on_stage(path, technique)


def _on_stage(path: Path, technique: Technique) -> Sketch:
    """Return the default sketch with a technique in the place of the pass with its outputs."""
    stage = load(DEFAULT_SKETCH)
    outputs = flatten.output_names(technique)
    passes = list(stage.graph.passes)
    spec = PassSpec(outputs[0], f"./{path.stem}", technique, file=shown(path))
    place = next((i for i, p in enumerate(passes) if set(outputs) & set(flatten.output_names(p.technique))), None)
    if place is not None:
        passes[place] = replace(spec, name=passes[place].name)
    else:
        if any(p.name == spec.name for p in passes):
            spec = replace(spec, name=path.stem)
        look = PassSpec("view", "view/map", read_technique("view/map", GLSL, GLSL), inputs=(("shown", spec.name),))
        passes = [*passes[:-1], spec, look]
    graph = Graph(path.stem, str(path), tuple(passes), title=technique.title)
    sketch = replace(
        stage,
        name=path.stem,
        file=str(path),
        folder=str(path.parent),
        graph=graph,
        title=technique.title or path.stem,
        shots=(),
        presets=(),
    )
    flatten.flatten(sketch, compute=False)
    return sketch.with_values(_files_of(stage, sketch))


def _files_of(stage: Sketch, sketch: Sketch) -> dict[str, str]:
    """Return the files that the default sketch names in its own folder, by whole path."""
    found: dict[str, str] = {}
    values = values_of(sketch)
    for path, kernel in kernels_of(sketch.graph):
        for parameter in kernel.parameters:
            value = str(values[f"{path}.{parameter.name}"])
            beside = Path(stage.folder) / value
            if parameter.widget.kind == "file" and value and beside.is_file():
                found[f"{path}.{parameter.name}"] = str(beside)
    return found


class _Toml:
    """One TOML file being read."""

    def __init__(self, path: Path, root: Path, depth: int = 0) -> None:
        self.path = path.resolve()
        self.root = root
        self.depth = depth
        text = read_text(self.path)
        self.lines = key_lines(text)
        try:
            self.table: dict[str, Any] = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise self._syntax(error, text) from None

    def _syntax(self, error: tomllib.TOMLDecodeError, text: str) -> SketchError:
        import re

        message = str(error)
        place = re.search(r"\s*\(at line (\d+), column (\d+)\)$", message)
        if place is None:
            last = text.count("\n") + 1
            return SketchError(f"not TOML: {message.split(' (at')[0]}", file=shown(self.path), line=last)
        line, column = int(place.group(1)), int(place.group(2))
        excerpt = text.split("\n")[line - 1]
        cause = message[: place.start()]
        return SketchError(f"not TOML: {cause}", file=shown(self.path), line=line, column=column, excerpt=excerpt)

    def error(self, message: str, *place: str | int) -> SketchError:
        return SketchError(message, file=shown(self.path), line=line_of(self.lines, place))

    def sketch(self) -> Sketch:
        top = ("format", "title", "size", "extent", "relief", "base_elevation", "pass", "view", "shot", "preset")
        self.only(self.table, top)
        self.version(required=True)
        passes = self.passes()
        view, camera, samples = self.view(passes)
        name = self.path.parent.name if self.path.name == "sketch.toml" else self.path.stem
        title = self.take(self.table, "title", str, "")
        sketch = Sketch(
            name,
            str(self.path),
            str(self.path.parent),
            Graph(name, str(self.path), (*passes, view), title=title),
            title or name,
            self.size(),
            self.pair("extent"),
            self.number("relief"),
            self.number("base_elevation", positive=False),
            camera,
            samples,
        )
        flatten.flatten(sketch, compute=False)
        sketch = replace(sketch, presets=self.presets(sketch))
        return replace(sketch, shots=self.shots(sketch))

    def technique(self, name: str) -> Graph:
        self.only(self.table, ("format", "title", "pass", "parameters", "inputs", "outputs"))
        self.version(required=False)
        passes = self.passes()
        title = self.take(self.table, "title", str, "")
        exports = {key: self.exports(key) for key in ("parameters", "inputs")}
        outputs = tuple(
            (key, self.text(value, "outputs", key)) for key, value in self.take(self.table, "outputs", dict, {}).items()
        )
        graph = Graph(name, str(self.path), passes, exports["parameters"], exports["inputs"], outputs, title)
        beside = self.path.with_suffix(".comp")
        if beside.is_file():
            companion = _read_companion(beside, self.root, flatten.outputs_with_formats(graph))
            _check_companion(
                companion, {e.name for e in graph.parameters}, {e.name for e in graph.inputs}, graph
            )
            graph = replace(graph, companion=companion)
        flatten.check_graph(graph)
        return graph

    def version(self, *, required: bool) -> None:
        found = self.table.get("format", None if required else FORMAT)
        if found is None:
            raise self.error(f"a sketch begins with format = {FORMAT}")
        if found != FORMAT:
            raise self.error(f"format = {found!r}: this version reads format = {FORMAT}", "format")

    def only(self, table: Mapping[str, Any], valid: tuple[str, ...], *place: str | int) -> None:
        for key in table:
            if key not in valid:
                raise self.error(f"no key '{key}' here{nearest(key, valid)}", *place, key)

    def take(self, table: Mapping[str, Any], key: str, kind: type, default: Any, *place: str | int) -> Any:
        value = table.get(key, default)
        names = {str: "text in quotes", dict: "a table", list: "a list", int: "a whole number", float: "a number"}
        fits = isinstance(value, kind) or (kind is float and isinstance(value, int))
        if key in table and (not fits or (isinstance(value, bool) and kind is not bool)):
            raise self.error(f"{key} = {value!r}: expected {names.get(kind, kind.__name__)}", *place, key)
        return value

    def text(self, value: object, *place: str | int) -> str:
        if not isinstance(value, str):
            raise self.error(f"{place[-1]} = {value!r}: expected text in quotes", *place)
        return value

    def size(self) -> tuple[int, int] | None:
        given = self.table.get("size")
        if given is None:
            return None
        pair = given if isinstance(given, list) else [given, given]
        if len(pair) != 2 or any(isinstance(v, bool) or not isinstance(v, int) for v in pair):
            raise self.error(f"size = {given!r}: expected a whole number of texels, or [x, y]", "size")
        if not all(1 <= v <= 16384 for v in pair):
            raise self.error(f"size = {given!r}: expected 1 to 16384 texels a side", "size")
        return pair[0], pair[1]

    def pair(self, key: str) -> tuple[float, float] | None:
        given = self.table.get(key)
        if given is None:
            return None
        both = given if isinstance(given, list) else [given, given]
        if len(both) != 2 or any(isinstance(v, bool) or not isinstance(v, int | float) or not 0 < v < 1e9 for v in both):
            raise self.error(f"{key} = {given!r}: expected metres above 0, or [east, north]", key)
        return float(both[0]), float(both[1])

    def number(self, key: str, *, positive: bool = True) -> float | None:
        given = self.table.get(key)
        if given is None:
            return None
        if isinstance(given, bool) or not isinstance(given, int | float) or not abs(given) < 1e9 or (positive and given < 0):
            raise self.error(f"{key} = {given!r}: expected metres{', 0 or more' if positive else ''}", key)
        return float(given)

    def passes(self) -> tuple[PassSpec, ...]:
        tables = self.take(self.table, "pass", list, [])
        if not tables:
            raise self.error('no passes; a [[pass]] with name = "…" and use = "…" was expected')
        found: list[PassSpec] = []
        for index, table in enumerate(tables):
            spec = self.one_pass(table, "pass", index)
            if spec.name in [other.name for other in found]:
                raise self.error(f"a second pass named '{spec.name}'", "pass", index, "name")
            if spec.name == "view":
                raise self.error("a pass may not be named 'view'; that is the [view] table's name", "pass", index, "name")
            found.append(spec)
        return tuple(found)

    def one_pass(self, table: Any, *place: str | int, name: str = "") -> PassSpec:
        if not isinstance(table, dict):
            raise self.error(f"{place[0]}: expected a table", *place)
        keys = ("name", "use", "inputs", "set", "size", "repeat", "feedback")
        self.only(table, keys if not name else ("use", "inputs", "set", "camera", "samples"), *place)
        name = name or self.take(table, "name", str, "", *place)
        use = self.take(table, "use", str, "", *place)
        if not name or not name.isidentifier():
            raise self.error(f"name = {name!r}: a pass needs a name of letters, digits and _", *place, "name")
        if not use:
            raise self.error(f"pass '{name}' needs use = \"…\", the technique that fills it", *place, "use")
        try:
            technique = read_technique(use, self.path.parent, self.root, self.depth)
        except SketchError as error:
            if error.diagnostics[0].file:
                raise
            raise self.error(str(error), *place, "use") from None
        inputs = tuple(
            (key, self.text(value, *place, "inputs", key))
            for key, value in self.take(table, "inputs", dict, {}, *place).items()
        )
        given = self.take(table, "set", dict, {}, *place)
        try:
            pairs = check_values(technique, flat_values(technique, given))
        except ParameterError as error:
            key = next(iter(given)) if len(given) == 1 else _key_named(given, str(error))
            raise self.error(f"pass '{name}': {error}", *place, "set", *([key] if key else [])) from None
        valid_inputs = flatten.input_names(technique)
        for key, _ in inputs:
            if not flatten.takes_input(technique, key):
                raise self.error(f"{use} has no input '{key}'{nearest(key, valid_inputs)}", *place, "inputs", key)
        feedback = tuple(
            (key, self.text(value, *place, "feedback", key))
            for key, value in self.take(table, "feedback", dict, {}, *place).items()
        )
        repeat = table.get("repeat", "")
        if feedback and repeat == "":
            raise self.error("feedback needs a repeat", *place, "feedback")
        for key, output in feedback:
            if not flatten.takes_input(technique, key):
                raise self.error(f"{use} has no input '{key}'{nearest(key, valid_inputs)}", *place, "feedback", key)
            if output not in flatten.output_names(technique):
                hint = nearest(output, flatten.output_names(technique))
                raise self.error(f"{use} has no output '{output}'{hint}", *place, "feedback", key)
        line = line_of(self.lines, place)
        return PassSpec(
            name, use, technique, inputs, pairs, self.expressions(table, *place), str(repeat), feedback,
            shown(self.path), line,
        )

    def expressions(self, table: Mapping[str, Any], *place: str | int) -> tuple[str, str] | None:
        given = table.get("size")
        if given is None:
            return None
        both = given if isinstance(given, list) else [given, given]
        if len(both) != 2 or any(isinstance(v, bool) or not isinstance(v, int | str) for v in both):
            raise self.error(f"size = {given!r}: expected a number, an expression in quotes, or [x, y]", *place, "size")
        if not isinstance(given, list) and isinstance(given, str):
            return _axis(given, "x"), _axis(given, "y")
        return str(both[0]), str(both[1])

    def exports(self, key: str) -> tuple[Export, ...]:
        found = []
        for name, given in self.take(self.table, key, dict, {}).items():
            targets = given if isinstance(given, list) else [given]
            if not targets or not all(isinstance(t, str) for t in targets):
                raise self.error(f"{name} = {given!r}: expected a path inside, or a list of them", key, name)
            found.append(Export(name, tuple(targets), line_of(self.lines, (key, name))))
        return tuple(found)

    def view(self, passes: tuple[PassSpec, ...]) -> tuple[PassSpec, Camera, int]:
        table = self.take(self.table, "view", dict, None)
        if table is None:
            use = "view/map"
            shown_pass = passes[-1].name
            return PassSpec("view", use, read_technique(use, GLSL, GLSL), inputs=(("shown", shown_pass),)), Camera(), 4
        spec = self.one_pass({"use": "view/terrain", **table}, "view", name="view")
        return spec, self.camera(table, Camera(), "view"), self.samples(table, 4, "view")

    def samples(self, table: Mapping[str, Any], default: int, *place: str | int) -> int:
        found = self.take(table, "samples", int, default, *place)
        if found not in (1, 2, 4, 8):
            raise self.error(f"samples = {found}: expected 1, 2, 4 or 8", *place, "samples")
        return int(found)

    def camera(self, table: Mapping[str, Any], default: Camera, *place: str | int) -> Camera:
        given = self.take(table, "camera", dict, None, *place)
        if given is None:
            return default
        here = (*place, "camera")
        self.only(given, ("azimuth", "elevation", "distance", "target", "field_of_view"), *here)
        values = {f: getattr(default, f) for f in ("azimuth", "elevation", "distance", "target", "field_of_view")}
        limits = {"azimuth": (-720, 720), "elevation": (-89, 89), "distance": (0, 1e9), "field_of_view": (5, 120)}
        for key, (low, high) in limits.items():
            number = self.take(given, key, float, values[key], *here)
            if not low <= number <= high:
                raise self.error(f"{key} = {number!r}: expected {low:g} to {high:g}", *here, key)
            values[key] = float(number)
        target = given.get("target")
        if target is not None:
            good = isinstance(target, list) and len(target) == 3
            if not good or any(isinstance(v, bool) or not isinstance(v, int | float) for v in target):
                raise self.error(f"target = {target!r}: expected [east, north, up] in metres", *here, "target")
            values["target"] = tuple(float(v) for v in target)
        return Camera(**values)

    def presets(self, sketch: Sketch) -> tuple[Preset, ...]:
        found: list[Preset] = []
        for index, table in enumerate(self.take(self.table, "preset", list, [])):
            self.only(table, ("name", "set"), "preset", index)
            name = self.take(table, "name", str, "", "preset", index)
            if not name or name in [p.name for p in found]:
                raise self.error(f"name = {name!r}: a preset needs a name of its own", "preset", index)
            found.append(Preset(name, self.set_of(sketch, table, "preset", index)))
        return tuple(found)

    def set_of(self, sketch: Sketch, table: Mapping[str, Any], *place: str | int) -> tuple[tuple[str, Value], ...]:
        given = self.take(table, "set", dict, {}, *place)
        try:
            return sketch.with_values(flat_values(sketch.graph, given)).overrides
        except ParameterError as error:
            raise self.error(str(error), *place, "set") from None

    def shots(self, sketch: Sketch) -> tuple[Shot, ...]:
        found: list[Shot] = []
        for index, table in enumerate(self.take(self.table, "shot", list, [])):
            place = ("shot", index)
            self.only(table, ("name", "size", "time", "camera", "set", "preset", "samples", "steps"), *place)
            name = self.take(table, "name", str, "", *place)
            if not name or not name.replace("-", "_").isidentifier():
                raise self.error(f"name = {name!r}: a shot needs a name of letters, digits, _ and -", *place)
            if name in [s.name for s in found]:
                raise self.error(f"a second shot named '{name}'", *place, "name")
            size = self.take(table, "size", list, [640, 360], *place)
            if len(size) != 2 or not all(isinstance(v, int) and 1 <= v <= 8192 for v in size):
                raise self.error(f"size = {size!r}: expected [width, height] in pixels, 1 to 8192", *place, "size")
            preset = self.take(table, "preset", str, "", *place)
            if preset and preset not in [p.name for p in sketch.presets]:
                raise self.error(
                    f"no preset '{preset}'{nearest(preset, [p.name for p in sketch.presets])}", *place, "preset"
                )
            steps = self.take(table, "steps", dict, {}, *place)
            if any(isinstance(v, bool) or not isinstance(v, int) or v < 0 for v in steps.values()):
                raise self.error(f"steps = {steps!r}: expected pass = turn, 0 or more", *place, "steps")
            camera = self.camera(table, sketch.camera, *place) if "camera" in table else None
            samples = self.samples(table, sketch.samples, *place) if "samples" in table else None
            found.append(
                Shot(
                    name, (size[0], size[1]), float(self.take(table, "time", float, 0.0, *place)), camera,
                    self.set_of(sketch, table, *place), preset, samples, tuple(steps.items()),
                    line_of(self.lines, place),
                )
            )
        return tuple(found)


def _axis(expression: str, axis: str) -> str:
    """Let ``size = "size"`` or ``"height.size // 2"`` stand for both axes."""
    import re

    return re.sub(r"\bsize\b(?!\s*\.)", f"size.{axis}", expression)


def _key_named(given: Mapping[str, Any], message: str) -> str:
    return next((key for key in given if message.startswith(key)), "")
