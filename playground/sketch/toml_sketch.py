"""Read a technique of several passes, or a whole sketch, from its TOML."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from playground.allowed_files import is_absolute, is_variant, leads_outside
from playground.errors import ParameterError, PlaygroundError, SketchError, nearest
from playground.paths import GLSL, shown
from playground.shader.kernel import Export, read_agreement
from playground.shader.parameter import coerce, spell
from playground.sketch import toml_table, wiring
from playground.sketch.assign import (
    TERRAIN_KEYS,
    check_value,
    effective_values,
    find_targets,
    flat_values,
    resolve,
    why_absent,
)
from playground.sketch.flat import repeated_path, repeated_paths
from playground.sketch.flatten import flatten
from playground.sketch.keyframes import EASES
from playground.sketch.model import (
    MAX_SIDE,
    MAX_SUPERSAMPLE,
    Camera,
    Graph,
    Keyframe,
    PassSpec,
    PictureSettings,
    Preset,
    Shot,
    Sketch,
    Technique,
    TerrainSettings,
    Tolerance,
    Value,
    tolerance_of,
)
from playground.sketch.toml_table import CAMERA, KEYFRAME, TomlFile
from playground.sketch.toml_text import KeyPath
from playground.sketch.wiring import check_graph, sources_of

TECHNIQUE_KEYS = tuple(key for key in toml_table.TECHNIQUE if key not in toml_table.SKETCH)
"""What a technique's TOML may hold and a sketch's may not."""

Read = Callable[[str, Path, Path], Technique]
"""Returns the technique that ``use`` names, from a folder inside a root."""

_ALL = "*"
"""Exports every parameter of every pass by its own name: ``"*" = "*"``."""


def read_graph(file: TomlFile, use: str, read: Read) -> Graph:
    """Return a technique of several passes; raise ``SketchError`` at the line that is wrong."""
    more = toml_table.VARIANT if is_variant(file.path) else ()
    file.only(file.table, (*toml_table.TECHNIQUE, *more))
    file.version(required=False)
    try:
        stated = file.take(file.table, "agrees", str, "")
        agrees = read_agreement(stated) if stated else ()
    except ValueError as error:
        raise file.error(f"agrees: {error}", "agrees") from None
    inputs = _exports(file, "inputs")
    passes = read_passes(file, read, inside=True)
    graph = Graph(
        use,
        str(file.path),
        passes,
        _with_all(file, passes, _exports(file, "parameters")),
        inputs,
        file.texts(file.table, "outputs"),
        file.take(file.table, "title", str, ""),
        agrees,
        line=file.line("outputs"),
    )
    names = [("parameters", export.name) for export in graph.parameters]
    names += [("inputs", export.name) for export in graph.inputs]
    for key, name in (*names, *(("outputs", name) for name, _ in graph.outputs)):
        if not name.isidentifier():
            raise file.error(f"'{name}': expected a name of letters, digits and _", key, name)
    wiring.check_graph(graph)
    _check_sources(graph)
    return replace(graph, warnings=tuple(file.warnings))


def _check_sources(graph: Graph) -> None:
    """Raise ``SketchError`` for a source that is neither a pass nor an input for it."""
    names = [spec.name for spec in graph.passes]
    exports = {export.name: export.targets for export in graph.inputs if export.name not in names}
    for spec in graph.passes:
        for name, sources in sources_of(spec):
            target = f"{spec.name}.{name}"
            for source in sources:
                head = source.partition(":")[0].partition(".")[0]
                if head not in names and source not in exports:
                    hint = nearest(source, [*(other for other in names if other != spec.name), *exports])
                    raise spec.error(f"input '{name}' names no pass '{source}'{hint}")
                if source in exports and target not in exports[source]:
                    message = f"input '{source}' of the technique is not for '{target}'; list it in [inputs]"
                    raise spec.error(f"pass '{spec.name}': {message}")


def read_passes(file: TomlFile, read: Read, *, inside: bool = False) -> tuple[PassSpec, ...]:
    """Return what the ``[[pass]]`` tables of a sketch say, or, ``inside``, those of a technique."""
    tables, view = file.tables("pass"), file.table.get("view")
    own = str(view.get("use", "")) if isinstance(view, dict) else ""
    if not tables and not own.startswith("./"):  # a shader of the sketch's own may be the whole picture
        raise file.error('no passes; a [[pass]] with name = "…" and use = "…" was expected', "pass")
    specs: dict[str, PassSpec] = {}
    for index, table in enumerate(tables):
        position = ("pass", index)
        file.only(table, toml_table.PASS, *position)
        name = file.take(table, "name", str, "", *position)
        wrong = ""
        if not name.isidentifier():
            wrong = f"name = {spell(name)}: a pass needs a name of letters, digits and _"
        elif name in specs:
            wrong = f"a second pass named '{name}'"
        elif name == "view":
            wrong = "a pass may not be named 'view'; that is the [view] table's name"
        if wrong:
            raise file.error(wrong, *position, "name")
        specs[name] = read_pass(file, table, position, name, read, inside=inside)
    return tuple(specs.values())


def read_pass(
    file: TomlFile,
    table: Mapping[str, Any],
    key_path: KeyPath,
    name: str,
    read: Read,
    *,
    inside: bool = False,
) -> PassSpec:
    """Return what one table, a pass's or the view's, says of a pass; ``inside`` as in ``read_passes``."""
    use = file.take(table, "use", str, "", *key_path)
    if not use:
        raise file.error(f"pass '{name}' needs use = \"…\", the technique that fills it", *key_path, "use")
    try:
        technique = read(use, file.path.parent, file.root)
    except SketchError as error:
        if error.diagnostics[0].file:
            raise
        raise file.error(error.diagnostics[0].message, *key_path, "use") from None
    repeat = _repeat(file, table, key_path)
    feedback = file.texts(table, "feedback", *key_path)
    if feedback and not repeat:
        raise file.error(f"pass '{name}': feedback needs a repeat, as repeat = 8", *key_path, "feedback")
    if repeat and not feedback:
        example = ', as feedback = { water = "water" }'
        message = f"pass '{name}': repeat needs feedback{example}: without, each step gives the same"
        raise file.error(message, *key_path, "repeat")
    sources = file.sources(table, "inputs", *key_path)
    choices = tuple((name, texts) for name, texts in sources if isinstance(texts, tuple))
    if choices and not inside:
        message = "one source each: all passes of a sketch are present, so none is needed in place of another"
        raise file.error(f"pass '{name}': {choices[0][0]}: {message}", *key_path, "inputs", choices[0][0])
    inputs = tuple((name, text if isinstance(text, str) else text[0]) for name, text in sources)
    for key, pairs in (("inputs", inputs), ("feedback", feedback)):
        for input_name, _ in pairs:
            if not wiring.takes_input(technique, input_name):
                valid = [*wiring.input_names(technique), *_inner_inputs(technique)]
                message = f"{use} has no input '{input_name}'{nearest(input_name, valid)}"
                raise file.error(message, *key_path, key, input_name)
    for input_name, output in feedback:
        if output not in wiring.output_names(technique):
            hint = nearest(output, wiring.output_names(technique))
            raise file.error(f"{use} has no output '{output}'{hint}", *key_path, "feedback", input_name)

    def read_value(path: str, value: object) -> Value:
        return coerce(resolve(technique, path)[0].parameter, value, path)

    values = _read_values(file, table, key_path, technique, read_value, f"pass '{name}'")
    return PassSpec(
        name=name,
        use=use,
        technique=technique,
        inputs=inputs,
        values=values,
        size=_size(file, table, key_path),
        repeat=repeat,
        feedback=feedback,
        choices=choices,
        file=shown(file.path),
        line=file.line(*key_path),
        set_lines=tuple(
            (path, file.line(*key_path, "set", path)) for path in flat_values(technique, table.get("set", {}))
        ),
    )


def _read_values(
    file: TomlFile,
    table: Mapping[str, Any],
    key_path: KeyPath,
    technique: Technique,
    read_value: Callable[[str, object], Value],
    who: str,
    *,
    left_out: list[str] | None = None,
) -> tuple[tuple[str, Value], ...]:
    """Return what ``set`` says, checked: each value by ``read_value``, and that no file lies outside.

    A value that no parameter takes is an error, or, where there is a list ``left_out``, a warning in it.
    """
    try:
        raw_values = flat_values(technique, file.take(table, "set", dict, {}, *key_path))
    except ParameterError as error:
        raise file.error(f"{who}: {error.diagnostics[0].message}", *key_path, "set") from None
    values_read = []
    for path, raw in raw_values.items():
        if why := why_absent(technique, path):
            file.warn(f"{who}: {path}: {why}", *key_path, "set", path)
            continue
        try:
            value = read_value(path, raw)
        except ParameterError as error:
            message = f"{who}: {error.diagnostics[0].message}"
            if left_out is None or path in TERRAIN_KEYS:
                raise file.error(message, *key_path, "set", path) from None
            left_out.append(message)
            file.warn(f"{who} leaves out {path}: {error.diagnostics[0].message}", *key_path, "set", path)
            continue
        parameters = [target.parameter for target in find_targets(technique, path)[:1]]
        files = [parameter.file for parameter in parameters if parameter.widget.kind == "file"]
        if value and any(leads_outside(str(value), file.root, declared_in) for declared_in in files):
            message = f"{who}: {path} = {spell(value)} lies outside the sketch's own folder and glsl/"
            raise file.error(message, *key_path, "set", path)
        values_read.append((path, value))
    return tuple(values_read)


def read_set(
    file: TomlFile,
    sketch: Sketch,
    table: Mapping[str, Any],
    key_path: KeyPath,
    who: str,
    left_out: list[str] | None = None,
) -> tuple[tuple[str, Value], ...]:
    """Return what a shot, a preset or a keyframe sets, checked; ``who`` begins the sentence of a mistake.

    A value that no parameter takes is an error, or, where there is a list ``left_out``, a warning in it.
    """
    check = partial(check_value, sketch)
    return _read_values(file, table, key_path, sketch.graph, check, who, left_out=left_out)


def _repeat(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath) -> str:
    count = table.get("repeat", "")
    if isinstance(count, bool) or not isinstance(count, int | str) or ("repeat" in table and count == ""):
        raise file.error(
            f"repeat = {spell(count)}: expected a number or an expression in quotes", *key_path, "repeat"
        )
    return _expression(file, count, *key_path, "repeat")


def _size(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath) -> tuple[str, str] | None:
    size = table.get("size")
    if size is None:
        return None
    both = size if isinstance(size, list) else [size, size]
    if len(both) != 2 or any(isinstance(v, bool) or not isinstance(v, int | str) for v in both):
        message = f"size = {spell(size)}: expected a number, an expression in quotes, or [x, y]"
        raise file.error(message, *key_path, "size")
    x, y = (_expression(file, side, *key_path, "size") for side in both)
    return (_axis(x, "x"), _axis(y, "y")) if isinstance(size, str) else (x, y)


def _expression(file: TomlFile, text: int | str, *key_path: str | int) -> str:
    if isinstance(text, int) and abs(text) > 2**62:
        raise file.error(f"{key_path[-1]} = {spell(text)}: expected a smaller number", *key_path)
    return str(text)


def _axis(expression: str, axis: str) -> str:
    """Return the expression of one axis: ``size``, as in ``"height.size // 2"``, is for both."""
    return re.sub(r"\bsize\b(?!\s*\.)", f"size.{axis}", expression)


def _exports(file: TomlFile, key: str) -> tuple[Export, ...]:
    exports = []
    for name, value in file.take(file.table, key, dict, {}).items():
        if key == "parameters" and name == _ALL:
            if value != _ALL:
                raise file.error(f'"*" = {spell(value)}: expected "*", for all passes', key, name)
            exports.append(Export(_ALL, (), file.line(key, name)))
            continue
        targets = value if isinstance(value, list) else [value]
        if not targets or not all(isinstance(t, str) for t in targets):
            raise file.error(f"{name} = {spell(value)}: expected a path inside, or a list of them", key, name)
        exports.append(Export(name, tuple(targets), file.line(key, name)))
    return tuple(exports)


def _with_all(file: TomlFile, passes: Sequence[PassSpec], exports: tuple[Export, ...]) -> tuple[Export, ...]:
    """Return exports with ``"*"`` replaced by what no other export has, each name for all that have it.

    Passes that share a name must agree on type, default and choices: else the first one's default would be
    every other one's, and nobody would have written so.
    """
    index = next((i for i, export in enumerate(exports) if export.name == _ALL), None)
    if index is None:
        return exports
    others = exports[:index] + exports[index + 1 :]
    bare = Graph("", str(file.path), tuple(passes))
    taken = {t.path for export in others for target in export.targets for t in find_targets(bare, target)}
    values, targets_by_name = effective_values(bare), dict[str, list[str]]()
    kinds: dict[str, tuple[str, object]] = {}
    for spec in passes:
        for parameter in spec.technique.parameters:
            path, name = f"{spec.name}.{parameter.name}", parameter.name
            targets = resolve(bare, path)
            if any(target.path in taken for target in targets):
                continue
            first = targets[0]
            kind = (path, (first.parameter.type, first.parameter.widget.choices, values[first.path]))
            other, same = kinds.setdefault(name, kind)
            if any(export.name == name for export in others) or same != kind[1]:
                who = "an export of that name is written" if same == kind[1] else f"it is not that of {other}"
                message = f"\"*\" cannot export {path} as '{name}': {who}; export it by a name of its own"
                raise file.error(message, "parameters", _ALL)
            targets_by_name.setdefault(name, []).append(path)
    line = exports[index].line
    every = tuple(Export(name, tuple(paths), line) for name, paths in targets_by_name.items())
    return exports[:index] + every + exports[index + 1 :]


def _inner_inputs(technique: Technique) -> Iterable[str]:
    if isinstance(technique, Graph):
        for spec in technique.passes:
            names = [*wiring.input_names(spec.technique), *_inner_inputs(spec.technique)]
            yield from (f"{spec.name}.{name}" for name in names)


# ── sketches ────────────────────────────────────────────────────────────────

_LIMITS = {
    "azimuth": (-720, 720),
    "elevation": (-89, 89),
    "distance": (0, 1e9),
    "field_of_view": (5, 120),
}  # degrees, degrees, metres, degrees
_FARTHEST = 1e9  # [m] of a camera's target from the origin


def read_camera(file: TomlFile, table: Mapping[str, Any], default: Camera, key_path: KeyPath) -> Camera:
    """Return what a table's ``camera`` says, and of the rest what ``default`` has; raise ``SketchError``."""
    camera = file.take(table, "camera", dict, None, *key_path)
    if camera is None:
        return default
    here = (*key_path, "camera")
    file.only(camera, CAMERA, *here)
    numbers = {key: file.take(camera, key, float, None, *here) for key in _LIMITS if key in camera}
    return camera_of({**camera, **numbers}, default, lambda key, message: file.error(message, *here, key))


def camera_of(
    camera_table: Mapping[str, Any], default: Camera, error: Callable[[str, str], PlaygroundError]
) -> Camera:
    """Return a camera of some values by key, and of the rest what ``default`` has.

    Raises what ``error`` makes of a key and a message where a value is none or out of its range.
    """
    values: dict[str, Any] = {}
    for key, (low, high) in _LIMITS.items():
        number = camera_table.get(key, getattr(default, key))
        if type(number) not in (int, float) or not low <= number <= high:
            number = f"{number:g}" if isinstance(number, float) else spell(number)
            raise error(key, f"{key} = {number}: expected {low:g} to {high:g}")
        values[key] = float(number)
    values["target"] = default.target
    if (target := camera_table.get("target")) is not None:
        numbers = target if isinstance(target, list) else []
        good = len(numbers) == 3 and all(type(v) in (int, float) and abs(v) <= _FARTHEST for v in numbers)
        if not good:
            raise error("target", f"target = {spell(target)}: expected [east, north, up] in metres")
        values["target"] = tuple(float(v) for v in numbers)
    return Camera(**values)


MASK_ENDING = ".png"
"""A mask's text that ends so is an image; another names a texture."""

Mask = tuple[tuple[int, int, int, int] | str, ...]


def _tolerance(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath) -> Tolerance | None:
    reason = file.take(table, "reason", str, "", *key_path)
    if "tolerance" not in table and "reason" not in table:
        return None
    declared = table.get("tolerance")
    if not isinstance(declared, str | int | dict | None) or isinstance(declared, bool):
        raise file.error(
            f"tolerance = {spell(declared)}: expected a tier, levels, or a table", *key_path, "tolerance"
        )
    try:
        return tolerance_of(declared, reason)
    except ValueError as error:
        raise file.error(str(error), *key_path, "tolerance" if "tolerance" in table else "reason") from None


def _mask(file: TomlFile, sketch: Sketch, table: Mapping[str, Any], key_path: KeyPath) -> Mask:
    mask_items = table.get("mask", [])
    items = mask_items if isinstance(mask_items, list) and not _is_rectangle(mask_items) else [mask_items]
    mask: list[tuple[int, int, int, int] | str] = []
    for item in items:
        if _is_rectangle(item):
            mask.append((item[0], item[1], item[2], item[3]))
        elif isinstance(item, str) and item.endswith(MASK_ENDING):
            if is_absolute(item) or leads_outside(item, Path(sketch.folder)):
                message = f"mask = {spell(item)}: it leads outside the sketch's folder"
                raise file.error(message, *key_path, "mask")
            mask.append(item)
        elif isinstance(item, str):
            try:
                flatten(sketch).ref(item, sketch.name)
            except SketchError as error:
                raise file.error(f"mask: {error.diagnostics[0].message}", *key_path, "mask") from None
            mask.append(item)
        else:
            message = (
                f"mask = {spell(item)}: expected [x, y, width, height] in pixels from the top left, "
                f'an image as "sky.png", a texture as "water:foam", or a list of such'
            )
            raise file.error(message, *key_path, "mask")
    return tuple(mask)


def _is_rectangle(item: object) -> bool:
    numbers = isinstance(item, list) and len(item) == 4 and all(type(v) is int for v in item)
    return numbers and item[2] > 0 and item[3] > 0  # type: ignore[index]


_LATEST = 1e6  # [s]


def read_keyframes(file: TomlFile, sketch: Sketch) -> tuple[Keyframe, ...]:
    """Return what the ``[[keyframe]]`` tables say; raise ``SketchError`` at the line that is wrong."""
    keyframes: list[Keyframe] = []
    names: dict[str, str] = {}  # the path that a parameter inside was set by, by its own path
    for index, table in enumerate(file.tables("keyframe")):
        key_path: KeyPath = ("keyframe", index)
        file.only(table, KEYFRAME, *key_path)
        time = _time(file, table, key_path, keyframes)
        who = f"keyframe at {time:g} s"
        values = read_set(file, sketch, table, key_path, who)
        for path, _ in values:
            if path in TERRAIN_KEYS:
                message = f"'{path}' is the terrain's; keyframes set parameters and the camera"
                raise file.error(f"{who}: {message}", *key_path, "set", path)
            for target in resolve(sketch.graph, path):
                other = names.setdefault(target.path, path)
                if other != path:
                    message = f"'{path}' is what '{other}' sets in another keyframe"
                    raise file.error(f"{who}: {message}", *key_path, "set", path)
        camera = _camera(file, table, key_path)
        if not values and not camera:
            raise file.error(f"{who}: it sets nothing; expected camera = {{ … }} or set = {{ … }}", *key_path)
        ease = file.take(table, "ease", str, EASES[0], *key_path)
        if ease not in EASES:
            raise file.error(f"ease = {spell(ease)}: expected {', '.join(EASES)}", *key_path, "ease")
        keyframes.append(Keyframe(time, camera, values, ease, file.line(*key_path)))
    _check_distances(file, keyframes)
    return tuple(keyframes)


def _time(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, before: list[Keyframe]) -> float:
    if "time" not in table:
        raise file.error("a keyframe needs time = …, in seconds", *key_path)
    time: float = file.take(table, "time", float, 0.0, *key_path)
    if not 0.0 <= time <= _LATEST:
        raise file.error(f"time = {time:g}: expected seconds from 0 to {_LATEST:g}", *key_path, "time")
    if before and time <= before[-1].time:
        last = before[-1]
        what = "there is one at that time" if time == last.time else f"the one before is at {last.time:g} s"
        raise file.error(
            f"time = {time:g}: {what}, on line {last.line}; times must increase", *key_path, "time"
        )
    return time


def _camera(
    file: TomlFile, table: Mapping[str, Any], key_path: KeyPath
) -> tuple[tuple[str, float | tuple[float, ...]], ...]:
    if "camera" not in table:
        return ()
    camera = read_camera(file, table, Camera(), key_path)
    return tuple((name, getattr(camera, name)) for name in table["camera"])


def _check_distances(file: TomlFile, keyframes: list[Keyframe]) -> None:
    """Raise ``SketchError`` where the distance is metres in one keyframe and 0, automatic, in another."""
    far = {bool(dict(k.camera)["distance"]) for k in keyframes if "distance" in dict(k.camera)}
    for index, keyframe in enumerate(keyframes):
        if len(far) > 1 and dict(keyframe.camera).get("distance") == 0.0:
            message = "distance = 0 shows the whole terrain and cannot be mixed with metres; give metres"
            raise file.error(message, "keyframe", index, "camera", "distance")


SKETCH_KEYS = frozenset(toml_table.SKETCH.keys() - toml_table.TECHNIQUE.keys())
"""What a sketch's TOML may hold and a technique's may not."""

_PAIRS = {"size": "a whole number of texels, or [x, y]", "extent": "metres, or [east, north]"}
DEFAULT_VIEW = "view/terrain"
"""What gives the frame where [view] does not say."""
_MAP_VIEW = "view/map"  # of a sketch without [view]: its last pass from above


def read_sketch(file: TomlFile, read: Read) -> Sketch:
    """Return a sketch, wired once to see that it can be; raise ``SketchError`` at the line that is wrong."""
    file.only(file.table, toml_table.SKETCH)
    file.version(required=True)
    passes = read_passes(file, read)
    view, camera, picture = _view(file, passes, read)
    name = file.path.parent.name if file.path.name == "sketch.toml" else file.path.stem
    title = file.take(file.table, "title", str, "")
    terrain = {key: _terrain_value(file, key) for key in TERRAIN_KEYS if key in file.table}
    sketch = Sketch(
        name=name,
        file=str(file.path),
        folder=str(file.path.parent),
        graph=Graph(name, str(file.path), (*passes, view), title=title),
        title=title or name,
        terrain=TerrainSettings(**terrain),
        camera=camera,
        picture=picture,
    )
    _warn_of_absent(file, sketch, (*passes, view))
    check_graph(sketch.graph)
    flatten(sketch)
    sketch = replace(sketch, main=_main(file, sketch))
    sketch = replace(sketch, presets=_presets(file, sketch))
    sketch = replace(sketch, shots=_shots(file, sketch))
    sketch = replace(sketch, keyframes=read_keyframes(file, sketch))
    return replace(sketch, warnings=tuple(file.warnings))


def _warn_of_absent(file: TomlFile, sketch: Sketch, written: Sequence[PassSpec]) -> None:
    """Warn of what passes set that is not there by their wiring."""
    for index, (spec, own) in enumerate(zip(written, sketch.graph.passes, strict=True)):
        there = dict(own.values)
        key_path = ("view",) if spec.name == "view" else ("pass", index)
        for path, _ in spec.values:
            if path not in there:
                why = why_absent(own.technique, path)
                file.warn(f"pass '{spec.name}': {path}: {why}", *key_path, "set", path)


def _terrain_value(file: TomlFile, key: str) -> Any:
    value = file.table[key]
    numbers = value if isinstance(value, list) else [value]
    types = (int,) if key == "size" else (int, float)
    if len(numbers) > (2 if key in _PAIRS else 1) or any(type(n) not in types for n in numbers):
        raise file.error(f"{key} = {spell(value)}: expected {_PAIRS.get(key, 'metres')}", key)
    try:
        return check_value(Sketch("", "", "", Graph("", "", ())), key, value)
    except ParameterError as error:
        raise file.error(error.diagnostics[0].message, key) from None


def _view(
    file: TomlFile, passes: tuple[PassSpec, ...], read: Read
) -> tuple[PassSpec, Camera, PictureSettings]:
    table = file.take(file.table, "view", dict, None)
    if table is None:
        technique = read(_MAP_VIEW, GLSL, GLSL)
        inputs = (("shown", passes[-1].name),)
        spec = PassSpec("view", _MAP_VIEW, technique, inputs, file=shown(file.path))
        return spec, Camera(), PictureSettings()
    file.only(table, toml_table.VIEW, "view")
    spec = read_pass(file, {"use": DEFAULT_VIEW, **table}, ("view",), "view", read)
    picture = PictureSettings(
        _samples(file, table, 4, ("view",)),
        _supersample(file, table, 1, ("view",)),
        file.take(table, "above_ground", bool, True, "view"),
    )
    return spec, read_camera(file, table, Camera(), ("view",)), picture


def _main(file: TomlFile, sketch: Sketch) -> tuple[str, ...]:
    """Return the paths of the parameters that the sketch is about, checked."""
    paths = file.take(file.table, "main", list, [])
    there = []
    for path in paths:
        if not isinstance(path, str):
            message = f'main: {spell(path)}: expected paths of parameters, as ["height.seed", "light.sun"]'
            raise file.error(message, "main")
        if why := why_absent(sketch.graph, path):
            file.warn(f"main: {path}: {why}", "main")
            continue
        try:
            resolve(sketch.graph, path)
        except ParameterError as error:
            file.warn(f"main leaves out {path}: {error.diagnostics[0].message}", "main")
            continue
        there.append(path)
        if paths.count(path) > 1:
            raise file.error(f"main: '{path}' appears twice", "main")
    return tuple(there)


def _samples(file: TomlFile, table: Mapping[str, Any], default: int, key_path: KeyPath) -> int:
    samples: int = file.take(table, "samples", int, default, *key_path)
    if samples not in (1, 2, 4, 8):
        raise file.error(f"samples = {spell(samples)}: expected 1, 2, 4 or 8", *key_path, "samples")
    return samples


def _supersample(file: TomlFile, table: Mapping[str, Any], default: int, key_path: KeyPath) -> int:
    factor: int = file.take(table, "supersample", int, default, *key_path)
    if not 1 <= factor <= MAX_SUPERSAMPLE:
        message = f"supersample = {spell(factor)}: expected a whole number, 1 to {MAX_SUPERSAMPLE}"
        raise file.error(message, *key_path, "supersample")
    return factor


def _presets(file: TomlFile, sketch: Sketch) -> tuple[Preset, ...]:
    presets: list[Preset] = []
    for index, table in enumerate(file.tables("preset")):
        key_path = ("preset", index)
        file.only(table, toml_table.PRESET, *key_path)
        name = file.take(table, "name", str, "", *key_path)
        if not name or name in [p.name for p in presets]:
            raise file.error(f"name = {spell(name)}: a preset needs a name of its own", *key_path, "name")
        left_out: list[str] = []
        values = read_set(file, sketch, table, key_path, f"preset '{name}'", left_out)
        presets.append(Preset(name, values, tuple(left_out)))
    return tuple(presets)


def _shots(file: TomlFile, sketch: Sketch) -> tuple[Shot, ...]:
    shots: list[Shot] = []
    presets = [preset.name for preset in sketch.presets]
    samples = sketch.picture.samples
    for index, table in enumerate(file.tables("shot")):
        key_path = ("shot", index)
        file.only(table, toml_table.SHOT, *key_path)
        name = file.take(table, "name", str, "", *key_path)
        if not name.replace("-", "_").isidentifier():
            message = f"name = {spell(name)}: a shot needs a name of letters, digits, _ and -"
            raise file.error(message, *key_path, "name")
        if name in [s.name for s in shots]:
            raise file.error(f"a second shot named '{name}'", *key_path, "name")
        size = file.take(table, "size", list, [640, 360], *key_path)
        if len(size) != 2 or not all(type(v) is int and 1 <= v <= MAX_SIDE for v in size):
            message = f"size = {spell(size)}: expected [width, height] in pixels, 1 to {MAX_SIDE}"
            raise file.error(message, *key_path, "size")
        preset = file.take(table, "preset", str, "", *key_path)
        if "preset" in table and preset not in presets:
            raise file.error(f"no preset '{preset}'{nearest(preset, presets)}", *key_path, "preset")
        for message in [m for p in sketch.presets if p.name == preset for m in p.left_out]:
            # A shot is the picture that its sketch says, or none: a test must be able to trust it.
            raise file.error(f"shot '{name}': {message}", *key_path, "preset")
        shots.append(
            Shot(
                name=name,
                size=(size[0], size[1]),
                time=file.take(table, "time", float, 0.0, *key_path),
                camera=read_camera(file, table, sketch.camera, key_path) if "camera" in table else None,
                values=read_set(file, sketch, table, key_path, f"shot '{name}'"),
                preset=preset,
                samples=_samples(file, table, samples, key_path) if "samples" in table else None,
                supersample=_supersample(file, table, 1, key_path) if "supersample" in table else None,
                steps=read_steps(file, sketch, table, key_path),
                marks=_marks(file, table, key_path),
                line=file.line(*key_path),
                tolerance=_tolerance(file, table, key_path),
                mask=_mask(file, sketch, table, key_path),
                allow_blank=file.take(table, "allow_blank", bool, False, *key_path),
            )
        )
    return tuple(shots)


def _marks(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath) -> tuple[str, ...]:
    marks = file.take(table, "marks", list, [], *key_path)
    if not all(isinstance(mark, str) and mark.isidentifier() for mark in marks):
        message = f'marks = {spell(marks)}: expected names of pytest\'s markers, as ["slow"]'
        raise file.error(message, *key_path, "marks")
    return tuple(marks)


def read_steps(
    file: TomlFile, sketch: Sketch, table: Mapping[str, Any], key_path: KeyPath
) -> tuple[tuple[str, int], ...]:
    """Return what a table's ``steps`` says of repeated passes: steps by path; raise ``SketchError``."""
    steps = file.whole_numbers(table, "steps", *key_path)
    if steps:
        nodes = flatten(sketch).nodes
        for path, _ in steps:
            if repeated_path(path, nodes) is None:
                message = f"steps: no repeated pass '{path}'{nearest(path, repeated_paths(nodes))}"
                raise file.error(message, *key_path, "steps", path)
    return steps
