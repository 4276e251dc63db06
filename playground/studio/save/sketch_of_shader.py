"""Save a shader that was opened alone as a sketch next to it, with the user's edits; the shader stays.

The sketch uses the shader's file. What was edited is done again on the sketch: a shader opened alone
has its stand-ins as passes of its own, and in a sketch they are inside its technique. An elevation file
that was opened alone is saved likewise, as the sketch around it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from playground.allowed_files import TECHNIQUES, is_elevation
from playground.errors import DataError
from playground.files import new_name, write_file
from playground.paths import GLSL
from playground.sketch.assign import TERRAIN_KEYS, find_targets
from playground.sketch.load import elevation_text, load
from playground.sketch.model import ForeignShader, PassSpec, Sketch, kernels_of
from playground.sketch.save import save, written_size, written_terrain_value, written_value
from playground.sketch.toml_text import key_text, text_of
from playground.studio.channels.channels import Channel, channels, in_order, source_of
from playground.studio.edits.edits import Draft, Edits


def is_shader(draft: Draft) -> bool:
    """Return whether a draft is of a shader, or of an elevation file, that was opened alone."""
    return not draft.file.file.endswith(".toml")


def save_as_sketch(draft: Draft, folder: Path) -> Draft:
    """Write the sketch of a draft for which ``is_shader``, as a new file; return its draft.

    It is in the folder of the file, or that of the sketch around it; of a shader that ships, in
    ``folder``. Files from elsewhere are copied next to it. Raises ``DataError`` where the shader's name
    cannot be used or nothing can be written, and as ``save``.
    """
    shader = Path(draft.file.file)
    if is_elevation(shader):
        return _save_elevation(draft, shader, folder)
    if shader.suffix not in TECHNIQUES:
        *endings, last = (ending for ending in TECHNIQUES if ending != ".toml")
        endings_text = f"{', '.join(endings)} or {last}"
        raise DataError(
            f"a sketch uses shaders that end in {endings_text}, not in {shader.suffix}", file=shader
        )
    ships = shader.is_relative_to(GLSL)
    root = GLSL if ships else Path(draft.file.folder)
    use = f"{'' if ships else './'}{shader.relative_to(root).with_suffix('').as_posix()}"
    with new_name((folder if ships else root) / f"{shader.stem}_sketch.toml") as path:
        write_file(path, _text(draft.file, use))
        loaded = load(path)
        if _dialects(loaded) != _dialects(draft.file):
            message = "a sketch depends on the shader's text, not on --dialect, so the picture would differ"
            raise DataError(message, file=shader)
        again = _again(draft, loaded)
        edited = again.sketch if again.edits.camera else again.sketch.with_camera(draft.file.camera)
        save(loaded, edited)
        saved = load(path)
    return Draft(saved, saved, Edits(locked=again.edits.locked))


def _save_elevation(draft: Draft, file: Path, folder: Path) -> Draft:
    """Write the sketch around an elevation file as ``save_as_sketch`` does."""
    ships = file.is_relative_to(GLSL)
    named = file.relative_to(GLSL).as_posix() if ships else file.name
    with new_name((folder if ships else file.parent) / f"{file.stem}.toml") as path:
        write_file(path, elevation_text(file, named))
        loaded = load(path)
        save(loaded, Draft(loaded, loaded).with_all(draft.edits).sketch)
        saved = load(path)
    return Draft(saved, saved, Edits(locked=draft.edits.locked))


def _dialects(sketch: Sketch) -> set[str]:
    kernels = [kernel for _, kernel in kernels_of(sketch.graph)]
    return {kernel.dialect if isinstance(kernel, ForeignShader) else "" for kernel in kernels}


# ── the text before the edits ────────────────────────────────────────────────


def _text(sketch: Sketch, use: str) -> str:
    """Return the TOML of a shader's sketch as it was opened; ``use`` names the shader."""
    title = sketch.graph.title or sketch.name
    lines = ["format = 1", f"title = {text_of(title)}"]
    for key in TERRAIN_KEYS:
        value = getattr(sketch.terrain, key)
        if value is not None:
            lines.append(f"{key} = {written_terrain_value(value)}")
    *passes, view = sketch.graph.passes
    is_picture = Path(view.technique.path) == Path(sketch.file)
    for spec in () if is_picture else passes:
        own = Path(spec.technique.path) == Path(sketch.file)
        lines += ["", "[[pass]]", f"name = {text_of(spec.name)}"]
        lines += _lines(sketch, spec, use if own else spec.use)
    lines += ["", "[view]", *_lines(sketch, view, use if is_picture else view.use)]
    lines += [f"samples = {sketch.picture.samples}"]
    return "\n".join([*lines, ""])


def _lines(sketch: Sketch, spec: PassSpec, use: str) -> Iterator[str]:
    yield f"use = {text_of(use)}"
    if spec.inputs:
        yield f"inputs = {{ {', '.join(f'{key_text(n)} = {text_of(s)}' for n, s in spec.inputs)} }}"
    if spec.values:
        pairs = [(path, written_value(sketch, f"{spec.name}.{path}", v, "")) for path, v in spec.values]
        yield f"set = {{ {', '.join(f'{key_text(path)} = {value}' for path, value in pairs)} }}"
    if spec.size is not None:
        yield f"size = {written_size(spec.size)}"


# ── the edits ────────────────────────────────────────────────────────────────


def _again(draft: Draft, loaded: Sketch) -> Draft:
    """Return the edits of a draft on the sketch that its shader is in now."""
    made, edits = Draft(loaded, loaded), draft.edits
    feeders = {channel.feeder: channel.path for channel in channels(draft.file) if channel.alone}
    sources = dict(edits.channels)
    for name, use in edits.techniques:
        if name in feeders:
            sources.setdefault(feeders[name], use)
        else:
            made = made.choose(name, use)
    for path, source in in_order(sources.items()):
        made = made.feed(path if source_of(loaded, path) is not None else f"view.{path}", source)
    names = dict(_renamed(channels(draft.base), channels(made.base)))
    values = [*draft.file.overrides, *draft.applied.items()]
    values_again = {_place(made.base, path, names): value for path, value in values}
    kept = replace(
        edits,
        values=tuple(values_again.items()),
        techniques=made.edits.techniques,
        channels=made.edits.channels,
        locked=tuple(_place(made.base, path, names) for path in edits.locked),
    )
    return made.with_edits(kept)


def _renamed(before: tuple[Channel, ...], now: tuple[Channel, ...]) -> Iterator[tuple[str, str]]:
    """Yield the passes that feed a channel alone, as they were called and as they are now."""
    for was in before:
        for channel in now:
            if channel.path in (was.path, f"view.{was.path}") and was.alone and channel.alone:
                yield was.feeder, channel.feeder


def _place(sketch: Sketch, path: str, names: dict[str, str]) -> str:
    """Return the path that a parameter has in the sketch."""
    head, dot, rest = path.partition(".")
    path = f"{names.get(head, head)}{dot}{rest}"
    inside = f"view.{path}"
    return path if find_targets(sketch.graph, path) or not find_targets(sketch.graph, inside) else inside
