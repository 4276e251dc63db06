"""Verify fast variants: draw each and its canonical form, and compare by its stated bound.

A technique is drawn in a sketch of its own, and inside the smallest of the techniques that use
it, where it reads what it is made for. Both forms are drawn at several sizes, square and not,
with the same and with unequal spacing along x and y, of two terrains and two seeds; then with
each choice of its menus and both ends of its sliders.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import FAST, canonical_of, is_variant, looking_once, root_of
from playground.engine.engine import Engine
from playground.engine.on_arrays import free_name
from playground.errors import PlaygroundError, SketchError, nearest
from playground.files import write_file
from playground.paths import GLSL, shown
from playground.shader import expressions
from playground.shader.kernel import Bound, Variant, bound_of, with_inner
from playground.sketch.assign import all_paths, resolve
from playground.sketch.find import find, shipped_names, shipped_sketches
from playground.sketch.load import load
from playground.sketch.model import (
    DEFAULT_PICTURE,
    Graph,
    Kernel,
    Parameter,
    PassSpec,
    Sketch,
    Technique,
    TerrainSettings,
    TexelKernel,
    Value,
    kernels_of,
)
from playground.sketch.techniques import Techniques
from playground.sketch.variants import (
    Verified,
    check_shape,
    content_of,
    read,
    record_of,
    without_variants,
    written,
)
from playground.sketch.wiring import initial_names, inner, input_names, is_optional, output_names
from playground.verify.standalone import standalone_sketch

SIZES = ((33, 33), (64, 48), (129, 129), (97, 130), (257, 193))
"""Texels; a technique that takes others is drawn at the nearest that it takes."""

_EXTENTS = ((1000.0, 1000.0), (700.0, 1900.0))  # [m]
_RELIEF = 180.0  # [m]
_SEEDS = (7, 1234)
_USERS = 2  # techniques that use it, besides the sketch of its own


@dataclass(frozen=True)
class VariantUse:
    """Where a fast variant can run: in a sketch, at a pass."""

    sketch: Sketch
    path: str  # of the pass
    technique: Technique
    variant: Variant
    varied: bool = False  # parameters are varied here


@dataclass
class Verdict:
    """How the two forms of a technique compare."""

    variant: Variant
    contents: tuple[str, str]  # of the canonical form and of the variant
    drawings: int = 0  # compared
    worst: dict[str, tuple[float, Bound]] = field(default_factory=dict)  # by output
    wrong: str = ""  # the first difference beyond the bound, or why nothing could be compared
    skipped: str = ""  # why it could not be drawn here

    @property
    def ok(self) -> bool:
        """Whether they were compared and agree."""
        return not self.wrong and not self.skipped and self.drawings > 0

    @property
    def words(self) -> str:
        """How closely they agree, or what is wrong."""
        if self.wrong or self.skipped:
            return self.wrong or self.skipped
        parts = [
            f"{name} to the last bit" if not bound.most else f"{name} {apart:.2g} of {bound}"
            for name, (apart, bound) in self.worst.items()
        ]
        return f"{', '.join(parts)} ({self.drawings} drawings)"


def places_in(sketch: Sketch, folder: Path) -> Iterator[VariantUse]:
    """Yield where the fast variants of a folder run in a sketch."""
    for spec in sketch.graph.passes:
        for path, technique in _inside(spec):
            for variant in technique.variants:
                if Path(variant.path).is_relative_to(folder):
                    yield VariantUse(sketch, path, technique, variant)


def places_of(
    technique: Technique, variant: Variant, picture: Path, users: Iterable[Technique] = ()
) -> Iterator[VariantUse]:
    """Yield where a technique is drawn: alone, for two terrains, and inside the smallest of its ``users``.

    ``picture`` is a file that may be written, for parameters that name none.
    """
    uses = sorted(
        ((user, path) for user in users for path in _paths_in(user, variant)),
        key=lambda pair: sum(1 for _ in kernels_of(pair[0])),
    )
    for number, seed in enumerate(_SEEDS):
        alone = _standalone(technique, seed, picture, variant)
        yield VariantUse(alone, _subject(technique), technique, variant, number == 0)
    for user, path in uses[:_USERS]:
        yield VariantUse(
            _standalone(user, _SEEDS[0], picture), f"{_subject(user)}.{path}", technique, variant
        )


def verify(engine: Engine, variant: Variant, technique: Technique, places: Iterable[VariantUse]) -> Verdict:
    """Draw a technique by both forms at each place, and compare them."""
    verdict = Verdict(variant, (content_of(technique), content_of(variant.technique)))
    if not variant.technique.agrees:
        verdict.wrong = 'it does not say how closely it agrees, as agrees = "1e-5"'
    elif variant.kind not in engine.plain_forms.kinds:
        verdict.skipped = f"this context is {engine.info.opengl}; compute needs 4.3"
    else:
        try:
            check_shape(variant.technique, technique)
            for site in places:
                for words, sketch in _cases(site):
                    if not verdict.wrong:
                        _compare(engine, site, sketch, words, verdict)
        except PlaygroundError as error:  # of this variant: the others are verified all the same
            verdict.wrong = str(error.diagnostics[0])
        if not verdict.wrong and not verdict.drawings:
            verdict.wrong = "it did not run in any of the drawings, so nothing was compared"
    return verdict


def compared(engine: Engine, site: VariantUse) -> Verdict:
    """Compare both forms of a technique in one sketch as it is; no drawings where the variant steps back."""
    contents = (content_of(site.technique), content_of(site.variant.technique))
    verdict = Verdict(site.variant, contents)
    _compare(engine, site, site.sketch, "its own values", verdict)
    return verdict


def difference(actual: NDArray[np.float32], expected: NDArray[np.float32], bound: Bound) -> float:
    """Return how far numbers are apart, as a bound counts it; 0 where every bit is the same."""
    if actual.shape != expected.shape:
        return float("inf")
    if not bound.most:
        same = (actual.view(np.uint32) == expected.view(np.uint32)) | (np.isnan(actual) & np.isnan(expected))
        return float(np.count_nonzero(~same))
    left, other = (values.astype(np.float64) for values in (actual, expected))
    if bound.degrees:
        left, other = (np.degrees(np.arctan(values)) for values in (left, other))
    alike = (left == other) | (np.isnan(left) & np.isnan(other))
    with np.errstate(invalid="ignore"):
        apart = np.abs(np.where(alike, 0.0, left - np.where(alike, 0.0, other)))
    apart = np.where(alike, 0.0, np.where(np.isnan(apart), np.inf, apart))
    if not np.isfinite(apart).all():
        return float("inf")
    return float(np.sqrt((apart**2).mean()) if bound.rms else apart.max(initial=0.0))


# ── places ───────────────────────────────────────────────────────────────────


def _subject(technique: Technique) -> str:
    return free_name("subject", technique)


def _standalone(technique: Technique, seed: int, picture: Path, variant: Variant | None = None) -> Sketch:
    """Return a sketch of a technique; what its ``variant`` cannot read, and it can do without, is unwired."""
    folder = GLSL if Path(technique.path).is_relative_to(GLSL) else Path(technique.path).parent
    made = standalone_sketch(technique, _subject(technique), folder, picture, seed=seed)
    starts = {export.name for export in technique.inputs if _starts(technique, export.name)}
    inputs = input_names(variant.technique) if variant else input_names(technique)
    starts |= {n for n in input_names(technique) if n not in inputs and is_optional(technique, n)}
    passes = tuple(spec for spec in made.graph.passes if spec.name not in starts)
    # Where a pixel has more than one sample, no draw has a fast variant.
    return replace(made, graph=replace(made.graph, passes=passes)).with_picture(samples=1)


def _starts(technique: Technique, name: str) -> bool:
    """Return whether a repeat starts from an input; wired, it has the plain form run (see ``flatten``)."""
    if isinstance(technique, Kernel):
        return isinstance(technique, TexelKernel) and name in initial_names(technique)
    targets = [t.rpartition(".") for e in technique.inputs if e.name == name for t in e.targets]
    starts = [(inner(technique, path), last) for path, _, last in targets]
    return any(below is not None and _starts(below, last) for below, last in starts)


def _inside(spec: PassSpec, prefix: str = "") -> Iterator[tuple[str, Technique]]:
    path = f"{prefix}{spec.name}"
    yield path, spec.technique
    if isinstance(spec.technique, Graph):
        for inner in spec.technique.passes:
            yield from _inside(inner, f"{path}.")


def _paths_in(user: Technique, variant: Variant) -> Iterator[str]:
    if isinstance(user, Graph):
        for spec in user.passes:
            for path, technique in _inside(spec):
                if any(v.path == variant.path for v in technique.variants):
                    yield path


# ── cases ────────────────────────────────────────────────────────────────────


def _cases(site: VariantUse) -> Iterator[tuple[str, Sketch]]:
    """Yield what is drawn at a place, with the words for it."""
    sizes = list(dict.fromkeys(_accepted(site.sketch, size) for size in SIZES))
    seeds = [path for path in all_paths(site.sketch.graph) if path.rpartition(".")[2] == "seed"]
    own = [path for path in seeds if path.partition(".")[0] == site.path.partition(".")[0]]
    # A seed that the technique keeps inside would have the plain form run.
    own = [path for path in own if path.rpartition(".")[0] not in _within(site)]
    for number, size in enumerate(sizes):
        for order, seed in enumerate(_SEEDS if own else _SEEDS[:1]):
            extent = _EXTENTS[(number + order) % len(_EXTENTS)]
            sketch = replace(site.sketch, terrain=TerrainSettings(size, extent, _RELIEF))
            values = {path: seed for path in own}
            yield f"{size[0]} x {size[1]} texels, seed {seed}", sketch.with_values(values)
    if site.varied:
        small = replace(site.sketch, terrain=TerrainSettings(sizes[0], _EXTENTS[1], _RELIEF))
        for path, value in _variations(site):
            yield f"{path.rpartition('.')[2]} = {value}", small.with_values({path: value})


def _within(site: VariantUse) -> set[str]:
    """Return the paths of all passes inside a place's technique."""
    if not isinstance(site.technique, Graph):
        return set()
    inside = (path for spec in site.technique.passes for path, _ in _inside(spec))
    return {f"{site.path}.{path}" for path in inside}


def _accepted(sketch: Sketch, size: tuple[int, int]) -> tuple[int, int]:
    for spec in sketch.graph.passes:
        for _, kernel in kernels_of(spec.technique):
            if kernel.accepts and not expressions.is_accepted(kernel.accepts, size):
                size = expressions.nearest_accepted(kernel.accepts, size)[-1]
    return size


def _variations(site: VariantUse) -> Iterator[tuple[str, Value]]:
    names = [p.name for p in site.technique.parameters]
    for name in names:
        path = f"{site.path}.{name}"
        parameter = resolve(site.sketch.graph, path)[0].parameter
        yield from ((path, value) for value in _ends(parameter) if value != parameter.default)


def _ends(parameter: Parameter) -> Iterator[Value]:
    widget = parameter.widget
    if parameter.type == "bool":
        yield from (False, True)
    elif widget.kind == "menu":
        yield from range(len(widget.choices))
    elif widget.kind == "direction":
        yield from ((0.0, 20.0), (45.0, 8.0), (200.0, 3.0), (275.5, 50.0))
    elif isinstance(parameter.default, tuple):
        count = len(parameter.default)
        kind = float if parameter.type.startswith("vec") else int
        ends = [[1.0 if end is None else end for end in widget.ends(i)] for i in range(count)]
        apart = (low + (high - low) * (i + 1) / (count + 1) for i, (low, high) in enumerate(ends))
        yield tuple(kind(value) for value in apart)
    elif parameter.type in ("int", "uint", "float") and None not in (widget.low, widget.high):
        for end in (widget.low, widget.high):
            assert end is not None
            yield end if parameter.type == "float" else int(end)


# ── comparing ────────────────────────────────────────────────────────────────


def _compare(engine: Engine, site: VariantUse, sketch: Sketch, words: str, verdict: Verdict) -> None:
    fast = replace(sketch, graph=_with_one(sketch.graph, site.variant, verdict.contents))
    for output in output_names(site.technique):
        bound = bound_of(site.variant.technique.agrees, output)
        if bound is None:
            continue
        ref = f"{site.path}:{output}"
        try:
            if not _runs(engine, site, fast, ref):
                return
            actual = engine.read(fast, ref)
        except SketchError:
            if _is_drawn(engine, sketch.plainly(), ref):
                raise
            return  # the technique itself needs more here, as a mesh in tiles what says how fine each is
        expected = engine.read(sketch.plainly(), ref)
        apart = difference(actual, expected, bound)
        if apart >= verdict.worst.get(output, (0.0, bound))[0]:
            verdict.worst[output] = apart, bound
        if apart > bound.most:
            many = f"in {apart:.0f} numbers" if not bound.most else f"by {apart:.3g}, more than {bound},"
            verdict.wrong = (
                f"{output} differs {many} from {shown(site.technique.path)}, with {words}"
                f" (as {site.path} of {sketch.name})"
            )
            return
    verdict.drawings += 1


def _is_drawn(engine: Engine, sketch: Sketch, texture: str) -> bool:
    """Return whether a texture of a sketch can be drawn at all."""
    try:
        engine.read(sketch, texture)
    except SketchError:
        return False
    return True


def _runs(engine: Engine, site: VariantUse, fast: Sketch, ref: str) -> bool:
    """Return whether the variant would run for a texture: where more is wired, it has the plain form run.

    A file of both forms tells nothing, so what each runs at the place is compared; nothing is drawn.
    """
    plans = (engine.plan(s, DEFAULT_PICTURE, ref=ref) for s in (fast, fast.plainly()))
    left, other = (
        {
            (step.path, step.kernel.path, step.size, step.repeat, repr(sorted(step.values.items())))
            for step in plan.walk()
            if f"{step.path}.".startswith(f"{site.path}.")
        }
        for plan in plans
    )
    return left != other


def _with_one(technique: Graph, variant: Variant, contents: tuple[str, str]) -> Graph:
    """Return a graph in which one fast variant runs, verified or not, and no other."""
    changed = with_inner(technique, lambda inside: _only(inside, variant, contents))
    return replace(changed, variants=())


def _only(technique: Technique, variant: Variant, contents: tuple[str, str]) -> Technique:
    if any(v.path == variant.path for v in technique.variants):
        return replace(without_variants(technique), variants=(replace(variant, verified=contents),))
    if isinstance(technique, Graph):
        return _with_one(technique, variant, contents)
    return replace(technique, variants=()) if isinstance(technique, Kernel) else technique


@dataclass(frozen=True)
class Subject:
    """A fast variant, its technique, and where the two are compared."""

    variant: Variant
    technique: Technique
    places: tuple[VariantUse, ...]


@looking_once()
def subjects(what: str, picture: Path) -> list[Subject]:
    """Return the fast variants that ``what`` means; raise ``SketchError`` where there are none.

    It is the name of a technique or of a folder of ``glsl/``, or the path of a variant, of a
    technique or of a sketch, whose folder's own variants are meant; "" is all of ``glsl/``.
    ``picture`` is a file that may be written.
    """
    result = list(_found(what, picture))
    if not result:
        where = f"in {what}" if what else "in glsl/"
        raise SketchError(f"there is no fast variant {where}; one is a file ending in {' or '.join(FAST)}")
    return result


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
            write_file(record, written(there))
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
    paths = [GLSL / f"{what}{ending}" for ending in ("", ".glsl", ".toml")]
    if present := [path for path in paths if path.exists()]:
        return present
    raise SketchError(
        f"there is no file and no technique '{what}'{nearest(what, [*shipped_names(), *shipped_sketches()])}"
    )


def _of_library(places: list[Path], picture: Path) -> Iterator[Subject]:
    """Yield those of ``glsl/`` in some folders, or those of some files."""
    reader = Techniques()
    techniques: list[Technique] = []
    for name in shipped_names():
        try:
            techniques.append(reader.read(name, GLSL, GLSL))
        except PlaygroundError as error:
            if "library file" not in str(error):
                raise
    for technique in techniques:
        for variant in technique.variants:
            if any(Path(p).is_relative_to(at) for p in (variant.path, technique.path) for at in places):
                users = [other for other in techniques if other is not technique and isinstance(other, Graph)]
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
    sites: dict[str, list[VariantUse]] = {}
    for site in places_in(sketch, Path(sketch.folder)):
        sites.setdefault(site.variant.path, []).append(site)
    for places in sites.values():
        technique, variant = places[0].technique, places[0].variant
        yield Subject(variant, technique, (*places_of(technique, variant, picture), *places))
