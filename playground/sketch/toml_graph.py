"""Read the passes of a sketch or of a technique from its TOML."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from playground.allowed_files import is_variant, leads_outside
from playground.errors import ParameterError, SketchError, nearest
from playground.paths import shown
from playground.shader.kernel import Export
from playground.shader.options import read_agreement
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
from playground.sketch.model import Graph, PassSpec, Sketch, Technique, Value
from playground.sketch.presence import sources_of
from playground.sketch.toml_table import TomlFile
from playground.sketch.toml_text import KeyPath

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
