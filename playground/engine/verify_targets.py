"""Find the fast variants that a word of the command line means, and keep the record of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from playground.engine.verify import Place, Verdict, places_in, places_of
from playground.errors import PlaygroundError, SketchError, nearest
from playground.images.files import replacing
from playground.paths import GLSL, shown
from playground.sketch.allowed_files import FAST, canonical_of, is_variant, looking_once, root_of
from playground.sketch.find import find, shipped_names, shipped_sketches
from playground.sketch.load import load
from playground.sketch.model import Graph, Technique, Variant
from playground.sketch.techniques import Techniques
from playground.sketch.variant_record import Verified, read, record_of, written


@dataclass(frozen=True)
class Subject:
    """A fast variant, its technique, and where the two are compared."""

    variant: Variant
    technique: Technique
    places: tuple[Place, ...]


@looking_once()
def subjects(what: str, picture: Path) -> list[Subject]:
    """Return the fast variants that ``what`` means; raise ``SketchError`` where there are none.

    It is the name of a technique or of a folder of ``glsl/``, or the path of a variant, of a
    technique or of a sketch, whose folder's own variants are meant; "" is all of ``glsl/``.
    ``picture`` is a file that may be written.
    """
    found = list(_found(what, picture))
    if not found:
        where = f"in {what}" if what else "in glsl/"
        raise SketchError(f"there is no fast variant {where}; one is a file ending in {' or '.join(FAST)}")
    return found


def recorded(verdicts: Iterable[Verdict]) -> list[Path]:
    """Write verdicts into the records, and return those that changed; what was not drawn stays as it was."""
    records: dict[Path, dict[str, Verified]] = {}
    changed = []
    for verdict in verdicts:
        record, name = record_of(Path(verdict.variant.path))
        entries = records.setdefault(record, read(record))
        if verdict.ok:
            entries[name] = verdict.contents
        elif verdict.wrong:
            entries.pop(name, None)
    for record, entries in records.items():
        there = {n: e for n, e in entries.items() if (record.parent / n).is_file()}
        if there != read(record):
            with replacing(record) as handle:
                handle.write(written(there).encode())
            changed.append(record)
    return changed


def _found(what: str, picture: Path) -> Iterator[Subject]:
    path = Path(what).expanduser()
    if not what:
        yield from _of_library([GLSL], picture)
    elif not path.exists():
        yield from _of_library(_named(what.removeprefix("glsl/")), picture)
    elif path.resolve().is_relative_to(GLSL):
        yield from _of_library(_named(path.resolve().relative_to(GLSL).as_posix()), picture)
    elif is_variant(path) or path.suffix in (".glsl", ".frag"):
        yield from _of_file(path.resolve(), picture)
    else:
        yield from _of_sketch(path, picture)


def _named(what: str) -> list[Path]:
    """Return the files and the folder of ``glsl/`` that a name means; raise ``SketchError`` for none."""
    found = [GLSL / f"{what}{ending}" for ending in ("", ".glsl", ".toml")]
    if present := [path for path in found if path.exists()]:
        return present
    raise SketchError(
        f"there is no file and no technique '{what}'{nearest(what, [*shipped_names(), *shipped_sketches()])}"
    )


def _of_library(places: list[Path], picture: Path) -> Iterator[Subject]:
    """Yield those of ``glsl/`` in some folders, or those of some files."""
    reader = Techniques()
    known: list[Technique] = []
    for name in shipped_names():
        try:
            known.append(reader.read(name, GLSL, GLSL))
        except PlaygroundError as error:
            if "library file" not in str(error):
                raise
    for technique in known:
        for variant in technique.variants:
            if any(Path(p).is_relative_to(at) for p in (variant.path, technique.path) for at in places):
                users = [other for other in known if other is not technique and isinstance(other, Graph)]
                yield Subject(variant, technique, tuple(places_of(technique, variant, picture, users)))


def _of_file(path: Path, picture: Path) -> Iterator[Subject]:
    """Yield the variant in a file, or those of a technique."""
    owner = canonical_of(path) if is_variant(path) else path
    if owner is None:
        raise SketchError("there is no .glsl and no .toml next to it to verify it against", file=shown(path))
    technique = Techniques().read(f"./{owner.stem}", owner.parent, root_of(owner))
    for variant in technique.variants:
        if path in (owner, Path(variant.path)):
            yield Subject(variant, technique, tuple(places_of(technique, variant, picture)))


def _of_sketch(path: Path, picture: Path) -> Iterator[Subject]:
    """Yield the variants of a sketch's own folder that it uses."""
    sketch = load(find(path))
    found: dict[str, list[Place]] = {}
    for place in places_in(sketch, Path(sketch.folder)):
        found.setdefault(place.variant.path, []).append(place)
    for places in found.values():
        technique, variant = places[0].technique, places[0].variant
        yield Subject(variant, technique, (*places_of(technique, variant, picture), *places))
