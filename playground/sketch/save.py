"""Write a user's changes back into a sketch's own TOML: values, camera, wiring.

Values go to the ``set`` of their pass, the camera to ``[view]``, a technique to ``use``. A
value that is in the file already is written over in its place; what the file does not hold
yet is added at the end of its table. The result is loaded before it replaces the file:
it says exactly what was set, or nothing is written.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path

from playground.allowed_files import is_elevation, leads_outside, sidecars
from playground.errors import DataError, PlaygroundError, SketchError
from playground.files import partial_file, read_regular, write_file
from playground.paths import GLSL
from playground.shader.colours import parse_hex, to_hex
from playground.shader.kernel import ARRAY
from playground.shader.parameter import is_whole, shortest
from playground.shader.source import normalised
from playground.sketch.assign import TERRAIN_KEYS, resolve, values_of
from playground.sketch.load import load, load_with
from playground.sketch.model import Camera, Parameter, PassSpec, Sketch, Value
from playground.sketch.techniques import Techniques
from playground.sketch.toml_text import KeyPath, TomlPlaces, append, drop, key_text, put, text_of

_QUOTED = re.compile(r"(?<=[\"'])[\w.]+(?=[\"'])")


def written_value(sketch: Sketch, path: str, value: Value, before: str) -> str:
    """Return a value as TOML writes it, in the fewest digits that a shader reads as the same number.

    A direction is written in braces where ``before``, the text that it replaces, has them.
    """
    if path in TERRAIN_KEYS:
        return written_terrain_value(value)
    value = shortest(value)
    parameter: Parameter = resolve(sketch.graph, path)[0].parameter
    kind = parameter.widget.kind
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return text_of(value)
    if kind == "menu" and isinstance(value, int):
        return text_of(parameter.widget.choices[value])
    if kind == "colour" and isinstance(value, tuple):
        raw = parameter.widget.raw
        text = to_hex(value, raw=raw)
        if shortest((*parse_hex(text, raw=raw), 1.0)[: len(value)]) == value:
            return text_of(text)
    if kind == "direction" and isinstance(value, tuple) and before.startswith("{"):
        return f"{{ azimuth = {written_number(value[0])}, elevation = {written_number(value[1])} }}"
    whole = is_whole(parameter.type) or before.lstrip("+-").isdigit()
    if whole or isinstance(value, int | tuple):
        return written_number(value)
    return repr(float(value))


def written_number(value: float | tuple[float, ...]) -> str:
    """Return a number without a point where it is whole; several in square brackets."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(written_number, value))}]"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def written_terrain_value(value: Value) -> str:
    """Return one of the terrain's own values as TOML writes it: two equal sides as one number."""
    if isinstance(value, tuple) and len(set(value)) == 1:
        value = value[0]
    return str(value) if isinstance(value, str) else written_number(value)


def written_so_far(text: str, table: KeyPath, key: str) -> str:
    """Return how a text writes the value of a key so far; "" where it does not."""
    places = TomlPlaces(text)
    pair_found = places.find(table, key)
    if pair_found is None:
        # Azimuth and elevation may also be set by two dotted keys; then the key itself has no value.
        return ""
    pair = places.pairs[pair_found]
    return text[pair.value : pair.end]


_CHANGED = "the file has changed meanwhile: save again once it shows"


class ReadOnlySketch(DataError):
    """A sketch's file cannot be written to, or is not to be: a copy can."""


def saved_text(text: str, file: Sketch, edited: Sketch) -> str:
    """Return a sketch's TOML text with what ``edited`` has over ``file``, which the text says.

    ``edited`` is ``file`` with other values over it, another camera, other techniques.
    """
    for key in TERRAIN_KEYS:
        value = getattr(edited.terrain, key)
        if value is not None and value != getattr(file.terrain, key):
            text = put(text, (), key, written_terrain_value(value))
    for spec in edited.graph.passes:
        was = file.graph.find(spec.name)
        if was is None and spec.use == ARRAY:
            raise SketchError(f"'{spec.name}' is an array, which a sketch's file cannot name", file=file.file)
        if was is None:
            text = _with_pass(text, edited, spec)
            continue
        if spec.use != was.use:
            text = _with_technique(with_view(text, file, spec.name), table_of(file, spec.name), was, spec)
        text = _with_feed(text, file, edited, was, spec)
    if edited.main != file.main:  # what another technique lacks is gone from it
        text = put(text, (), "main", f"[{', '.join(map(text_of, edited.main))}]")
    for path, value in edited.overrides:
        text = _with_value(text, file, edited, path, value)
    if edited.camera != file.camera:
        text = _with_camera(text, file, edited.camera)
    return text


def with_preset(text: str, sketch: Sketch, name: str, values: Mapping[str, Value]) -> str:
    """Return the text with a preset more, or with the values of the one of that name."""
    names = [preset.name for preset in sketch.presets]
    if name in names:
        table: KeyPath = ("preset", names.index(name), "set")
        for path, value in values.items():
            text = put(text, table, path, written_value(sketch, path, value, ""))
        return text
    pairs = [f'"{path}" = {written_value(sketch, path, value, "")}' for path, value in values.items()]
    return append(text, ["[[preset]]", f"name = {text_of(name)}", "[preset.set]", *pairs])


def save(file: Sketch, edited: Sketch) -> None:
    """Write ``edited`` into the file that ``file`` was loaded from.

    Raises ``ReadOnlySketch`` for one that cannot be written or belongs to the playground
    itself, ``SketchError`` where the file no longer says what ``file`` does, or cannot
    say what is wanted.
    """
    path = Path(file.file)
    write_over(
        path, file, lambda text: saved_text(text, file, _with_files_inside(edited)), says_same_as(edited)
    )


def save_preset(file: Sketch, name: str, values: Mapping[str, Value]) -> None:
    """Write a preset into the file that ``file`` was loaded from; raises as ``save`` does."""

    def holds(reloaded: Sketch) -> bool:
        preset = next((p for p in reloaded.presets if p.name == name), None)
        found_values = {path: shortest(value) for path, value in preset.values} if preset else {}
        return all(found_values.get(path) == shortest(value) for path, value in values.items())

    write_over(Path(file.file), file, lambda text: with_preset(text, file, name, values), holds)


def save_copy(
    file: Sketch,
    edited: Sketch,
    folder: Path,
    *,
    main: str | None = None,
    texts: Mapping[str, bytes] | None = None,
) -> Path:
    """Write ``edited`` as a sketch in a new folder of ``folder``, with the files it needs; return its path.

    Its own techniques and images come along; what lies in ``glsl/`` is found there. ``main`` takes the place
    of what the sketch's file holds, ``texts`` of what others do, by names relative to the sketch's folder.
    Raises ``DataError`` where nothing can be written, and as ``save`` does.
    """
    source = Path(file.file)
    text, texts = _read(source) if main is None else main, texts or {}
    target = _new_folder(folder, file.name)
    try:
        for name in dict.fromkeys([*_own_files(file, edited), *texts]):
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            if name in texts:
                write_file(target / name, texts[name])
            else:
                shutil.copyfile(Path(file.folder) / name, target / name)
        path = target / "sketch.toml"
        write_file(path, text)
        copied = load(path)
        graph = replace(edited.graph, path=copied.graph.path, name=copied.graph.name)
        moved = replace(edited, file=copied.file, folder=copied.folder, name=copied.name, graph=graph)
        inside = _with_files_inside(moved)
        write_over(path, copied, lambda t: saved_text(t, copied, inside), says_same_as(edited))
    except (PlaygroundError, OSError) as error:
        shutil.rmtree(target, ignore_errors=True)
        if isinstance(error, OSError):
            raise DataError(f"cannot be written: {error.strerror}", file=target) from None
        raise
    return path


# ── what is written ──────────────────────────────────────────────────────────


def table_of(file: Sketch, name: str) -> KeyPath:
    """Return the place of a pass's table."""
    if name == "view":
        return ("view",)
    return ("pass", [spec.name for spec in file.graph.passes].index(name))


def with_view(text: str, file: Sketch, name: str) -> str:
    """Return the text with a [view], where the pass is the view and the file leaves that out."""
    if name != "view" or "view" in tomllib.loads(normalised(text)):
        return text
    spec = file.graph.find("view")
    assert spec is not None
    wires = ", ".join(f"{key} = {text_of(source)}" for key, source in spec.inputs)
    return append(text, ["[view]", f"use = {text_of(spec.use)}", f"inputs = {{ {wires} }}"])


def _with_technique(text: str, table: KeyPath, was: PassSpec, now: PassSpec) -> str:
    """Return the text with another technique in a pass, without what that has no place for."""
    text = put(text, table, "use", text_of(now.use))
    for part in ("inputs", "values", "feedback"):
        left = dict(getattr(now, part))
        for key, _ in getattr(was, part):
            if key not in left:
                text = drop(text, (*table, "set" if part == "values" else part), key)
    return text if now.repeat == was.repeat else drop(text, table, "repeat")


def _with_pass(text: str, edited: Sketch, spec: PassSpec) -> str:
    """Return the text with a pass more: one that feeds a channel."""
    lines = ["[[pass]]", f"name = {text_of(spec.name)}", f"use  = {text_of(spec.use)}"]
    if spec.size is not None:
        lines.append(f"size = {written_size(spec.size)}")
    if spec.values:
        own = [(path, written_value(edited, f"{spec.name}.{path}", value, "")) for path, value in spec.values]
        pairs = [f"{key_text(path)} = {value}" for path, value in own]
        lines.append(f"set  = {{ {', '.join(pairs)} }}")
    return append(text, lines)


def _with_feed(text: str, file: Sketch, edited: Sketch, was: PassSpec, now: PassSpec) -> str:
    """Return the text with a pass's wires, and of one that feeds a channel its size and values."""
    before = dict(was.inputs)
    for name, source in now.inputs:
        if before.get(name) != source:
            text = put(
                with_view(text, file, was.name), (*table_of(file, was.name), "inputs"), name, text_of(source)
            )
    if now.size is None:
        text = drop(text, table_of(file, was.name), "size") if was.size is not None else text
    elif now.size != was.size:
        text = put(text, table_of(file, was.name), "size", written_size(now.size))
    for path, value in now.values:
        if (path, value) not in was.values:
            written = written_value(edited, f"{now.name}.{path}", value, "")
            text = put(text, (*table_of(file, was.name), "set"), path, written)
    return text


def written_size(size: tuple[str, str]) -> str:
    """Return a size as TOML writes it."""
    x, y = (side if side.isdecimal() else text_of(side) for side in size)
    return f"[{x}, {y}]"


def _with_value(text: str, file: Sketch, edited: Sketch, path: str, value: Value) -> str:
    """Return the text with a parameter set, by the name that the file has for it already."""
    name, _, inner = path.partition(".")
    spec = edited.graph.find(name)
    assert spec is not None
    text = with_view(text, file, name)
    mine = {target.path for target in resolve(spec.technique, inner)}
    names = [key for key, _ in spec.values if {t.path for t in resolve(spec.technique, key)} == mine]
    table = (*table_of(edited, name), "set")
    for key in names or [inner]:
        written = written_value(edited, f"{name}.{key}", value, written_so_far(text, table, key))
        text = put(text, table, key, written)
    return text


def _with_camera(text: str, file: Sketch, camera: Camera) -> str:
    text = with_view(text, file, "view")
    table: KeyPath = ("view", "camera")
    for part in fields(Camera):
        value = getattr(camera, part.name)
        if value == getattr(file.camera, part.name):
            continue
        if value is None:
            text = drop(text, table, part.name)
        else:
            text = put(text, table, part.name, written_number(value))
    return text


# ── files ────────────────────────────────────────────────────────────────────


def _read(path: Path) -> str:
    try:
        return read_regular(path).decode()
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"cannot be read: {error}", file=path) from None


def write_over(
    path: Path, file: Sketch, change: Callable[[str], str], is_right: Callable[[Sketch], bool]
) -> None:
    """Replace a sketch's text: whole, where it still says what ``file`` does, and only by what is right.

    ``change`` makes the new text of the old one, and ``is_right`` judges the sketch that is
    loaded of it. Raises ``ReadOnlySketch`` where the file is not to be written to,
    ``SketchError`` where it has changed meanwhile or the result is not right, and
    ``DataError`` where the system refuses.
    """
    path = path.resolve()  # a link stays a link: what it leads to is written
    if path.suffix != ".toml":
        kind = "an elevation file" if is_elevation(path) else "a shader"
        raise ReadOnlySketch(f"{kind} opened alone has no sketch file to save into", file=path)
    if path.is_relative_to(GLSL.resolve()):
        raise ReadOnlySketch("this sketch belongs to the playground itself", file=path)
    if not os.access(path, os.W_OK) or not os.access(path.parent, os.W_OK):
        raise ReadOnlySketch("this sketch cannot be written to", file=path)
    text = _read(path)
    if not _same_text(load(path), file):
        raise SketchError(_CHANGED, file=path)
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    new = mark + change(text.removeprefix(mark))
    if new == text:
        return
    try:
        right = is_right(load_with(Techniques(), path, normalised(new)))
    except PlaygroundError:
        right = False
    if not right:
        message = "what was set cannot be written into this file; copy it as --set words instead"
        raise SketchError(message, file=path)
    try:
        with partial_file(path) as partial:
            partial.handle.write(new.encode())
            partial.path.chmod(stat.S_IMODE(path.stat().st_mode))
            if _read(path) != text:
                raise SketchError(_CHANGED, file=path)
            partial.rename(path)
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}", file=path) from None


def _same_text(a: Sketch, b: Sketch) -> bool:
    """Return whether two sketches were read from the same TOML; their kernels may differ."""

    def parts(sketch: Sketch) -> object:
        passes = [
            (p.name, p.use, p.inputs, p.values, p.size, p.repeat, p.feedback) for p in sketch.graph.passes
        ]
        return passes, replace(sketch, graph=a.graph)

    return parts(a) == parts(b)


def says_same_as(edited: Sketch) -> Callable[[Sketch], bool]:
    """Return a check that a sketch says what is wanted; files may have moved into its folder."""
    files = {p for p, v in values_of(edited).items() if isinstance(v, str)}

    def parts(sketch: Sketch) -> object:
        values = {path: shortest(value) for path, value in values_of(sketch).items() if path not in files}
        uses = [(spec.name, spec.use, spec.inputs) for spec in sketch.graph.passes]
        return values, uses, sketch.camera, sketch.terrain

    return lambda reloaded: parts(reloaded) == parts(edited)


def _with_files_inside(edited: Sketch) -> Sketch:
    """Return the sketch with every file from elsewhere copied into its folder, as it may name no others."""
    folder, overrides = Path(edited.folder), []
    for path, value in edited.overrides:
        parameter = resolve(edited.graph, path)[0].parameter
        if parameter.widget.kind == "file" and isinstance(value, str) and value:
            if leads_outside(value, folder, parameter.file):
                value = _copied_into(folder, Path(value))
            elif Path(value).is_absolute():
                value = Path(value).relative_to(folder).as_posix()
        overrides.append((path, value))
    return replace(edited, overrides=tuple(overrides))


def _copied_into(folder: Path, source: Path) -> str:
    """Copy a file whole or not at all; return its name there, numbered where another file has it.

    The files next to it that say how to read it go along.
    """
    if source.is_absolute() and source.is_relative_to(folder):
        return source.relative_to(folder).as_posix()
    if source.suffix.lower() == ".vrt":
        message = "names other files, so it is not copied into the sketch's folder; put all of them there"
        raise DataError(message, file=source)
    target, number = folder / source.name, 2
    try:
        data = _contents(source)
        while (there := _contents(target)) and there != data:
            target, number = folder / f"{source.stem}-{number}{source.suffix}", number + 1
        for ending, content in reversed(data.items()):  # the file itself comes last
            path = target.with_name(target.stem + ending)
            with partial_file(path) as partial:
                partial.handle.write(content)
                partial.rename(path)
    except OSError as error:
        raise DataError(
            f"cannot be copied into the folder of the sketch: {error.strerror}", file=source
        ) from None
    return target.name


def _contents(path: Path) -> dict[str, bytes]:
    """Return what a file and those next to it hold, by what follows its stem; of those that are there."""
    files = filter(Path.exists, (path, *sidecars(path)))
    return {file.name[len(path.stem) :]: read_regular(file) for file in files}


def _new_folder(folder: Path, name: str) -> Path:
    for number in range(1, 10_000):
        target = folder / (name if number == 1 else f"{name}-{number}")
        try:
            target.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise DataError(f"cannot be written to: {error.strerror}", file=folder) from None
        return target
    raise DataError("has ten thousand copies of this sketch", file=folder)


def _own_files(file: Sketch, edited: Sketch) -> list[str]:
    """Return the files that a sketch needs in its own folder, relative to it, without its TOML."""
    folder, files = Path(file.folder), dict[str, None]()
    texts = [Path(name) for name in (*file.files, *edited.files)]
    values = [v for v in values_of(edited).values() if isinstance(v, str) and v]
    data = [file for value in values for file in (folder / value, *sidecars(folder / value))]
    for path in (*texts, *data):
        if path.is_file() and path.is_relative_to(folder) and str(path) != file.file:
            files[path.relative_to(folder).as_posix()] = None
    return list(files)
