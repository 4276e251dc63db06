"""Ask sources what they know before any texel is made, and leaves which files they read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from playground.engine.error_place import placed
from playground.engine.files import find_file
from playground.engine.plan_request import DEFAULT_EXTENT, DEFAULT_RELIEF, DEFAULT_SIZE
from playground.engine.source_kinds import Terrain
from playground.engine.sources import source_kind
from playground.errors import DataError, PlaygroundError
from playground.sketch.flat import Flat, Leaf
from playground.sketch.model import Sketch, Value

Values = Mapping[str, Mapping[str, Value]]
"""The values of each leaf, by its path."""


def known_by_sources(sketch: Sketch, flat: Flat, values: Values) -> Terrain:
    """Return what the first source that knows anything of the terrain says of it."""
    for leaf in flat.sources:
        _check_source(leaf)
        try:
            known = source_kind(leaf.kernel.registry).describe(values[leaf.path])
        except DataError as error:
            raise placed(error, sketch, flat.user(leaf.path)) from error
        if known != Terrain():
            return known
    return Terrain()


def extent_follows_size(sketch: Sketch, flat: Flat, values: Values) -> bool:
    """Return whether nothing says the terrain's metres: its sides are to each other as its texels are."""
    known = known_by_sources(sketch, flat, values)
    return sketch.extent is None and known.extent is None and known.size is None


def described(sketch: Sketch, flat: Flat, values: Values) -> Terrain:
    """Return the terrain with every field known: by the sketch, else by its first source that knows."""
    known = known_by_sources(sketch, flat, values)
    size = sketch.size or flat.accepted(known.size or DEFAULT_SIZE)
    extent = sketch.extent or known.extent
    if extent is None:
        shape = known.size or size
        ratio = (shape[1] - 1) / max(shape[0] - 1, 1) or 1.0
        extent = (DEFAULT_EXTENT, DEFAULT_EXTENT * ratio)
    relief = sketch.relief if sketch.relief is not None else known.relief
    base = sketch.base_elevation if sketch.base_elevation is not None else known.base_elevation
    relief = DEFAULT_RELIEF if relief is None else relief
    return Terrain(size, extent, relief, base or 0.0, known.place)


def own_sizes(sketch: Sketch, flat: Flat, values: Values) -> Iterator[tuple[str, tuple[int, int]]]:
    """Yield the texels that sources have by themselves, such as a film, where their passes say none."""
    for leaf in flat.sources:
        if leaf.spec.size is None and leaf.path != "view":
            try:
                size = source_kind(leaf.kernel.registry).size(values[leaf.path])
            except DataError as error:
                raise placed(error, sketch, flat.user(leaf.path)) from error
            if size is not None:
                yield leaf.path, size


def given_values(leaf: Leaf, sketch: Sketch, flat: Flat) -> dict[str, Value]:
    """Return a leaf's values as its kernel gets them: files by absolute path, of menus their values."""
    values = flat.values_of(leaf)
    for parameter in leaf.kernel.valued_menus:
        values[parameter.name] = parameter.widget.given(values[parameter.name])
    for parameter in leaf.kernel.file_parameters:
        text = str(values[parameter.name])
        try:
            path = find_file(text, flat.folder, parameter.file, f"{leaf.path}.{parameter.name}")
        except DataError as error:
            raise placed(error, sketch, flat.user(leaf.path)) from error
        values[parameter.name] = str(path)
    return values


def _check_source(leaf: Leaf) -> None:
    try:
        kind = source_kind(leaf.kernel.registry)
    except PlaygroundError as error:
        raise leaf.spec.error(str(error)) from None
    missing = [name for name in kind.parameters if leaf.kernel.parameter(name) is None]
    if missing:
        raise leaf.spec.error(f"source '{leaf.kernel.registry}' needs the parameters {', '.join(missing)}")
    declared = [one.name for one in leaf.kernel.inputs]
    if set(declared) != set(kind.inputs):
        wanted = f"the inputs {', '.join(kind.inputs)}" if kind.inputs else "no inputs"
        found = f"; the file declares {', '.join(declared) or 'none'}"
        raise leaf.spec.error(f"source '{leaf.kernel.registry}' needs {wanted}{found}")
