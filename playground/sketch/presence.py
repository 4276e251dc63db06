"""Leave out the passes of a technique that are there only where something is wired.

A pass of a technique may say ``when = "density"``: it is there only where its technique's input
``density`` is wired, by its user or by a pass of that name; ``"not dome"``, only where that is not. An
input may list its sources, ``["wooded:albedo", "cover"]``: it reads the first that is there.

What remains is a form of the technique, a ``Graph`` like any other, so that all that reads a sketch
sees only what is there; ``Graph.written`` is all of it. An output's name alone wires no input that
decides on passes: else a technique that happens to give a ``density`` would plant trees.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import product

from playground.errors import SketchError
from playground.shader.kernel import NOT, Export, Graph, PassSpec, Technique, Variant
from playground.sketch.assign import find_targets, unmet
from playground.sketch.identity import Identity
from playground.sketch.wiring import check_graph, inner, input_names, is_optional, output_names, takes_input

_ALL_FORMS = 4
"""With more inputs that decide, only some of their combinations are checked."""


def as_wired(sketch: Graph) -> Graph:
    """Return the passes of a sketch, the techniques in them in the forms that its wiring gives them."""
    return _as_wired(Identity(sketch))


@lru_cache(maxsize=256)
def _as_wired(key: Identity[Graph]) -> Graph:
    sketch = key.object
    if not is_conditional(sketch):
        return sketch
    passes = _present(sketch.passes, sketch, frozenset())
    same = all(one is other for one, other in zip(passes, sketch.passes, strict=True))
    return sketch if same else replace(sketch, passes=passes)


def form_of(technique: Graph, wired: Iterable[str]) -> Graph:
    """Return a technique as it is where some of its inputs, or paths inside, are wired."""
    whole = technique.written
    return _form(Identity(whole), frozenset(wired)) if is_conditional(whole) else whole


@lru_cache(maxsize=1024)
def _form(key: Identity[Graph], wired: frozenset[str]) -> Graph:
    whole = key.object
    form = replace(whole, passes=_present(whole.passes, whole, wired), whole=whole, wired=wired)
    return replace(
        form,
        inputs=tuple(_narrowed(e, [t for t in e.targets if takes_input(form, t)]) for e in whole.inputs),
        parameters=tuple(
            _narrowed(export, targets)
            for export in whole.parameters
            if (targets := [target for target in export.targets if find_targets(form, target)])
        ),
        variants=tuple(_variant(variant, wired) for variant in whole.variants),
    )


def _narrowed(export: Export, targets: Sequence[str]) -> Export:
    return export if len(targets) == len(export.targets) else replace(export, targets=tuple(targets))


def _variant(variant: Variant, wired: frozenset[str]) -> Variant:
    technique = variant.technique
    return replace(variant, technique=form_of(technique, wired)) if isinstance(technique, Graph) else variant


def is_conditional(technique: Technique) -> bool:
    """Return whether any pass inside may not be there."""
    return isinstance(technique, Graph) and _is_conditional(Identity(technique))


@lru_cache(maxsize=1024)
def _is_conditional(key: Identity[Graph]) -> bool:
    graph = key.object
    return graph.whole is not None or any(
        spec.when or spec.choices or is_conditional(spec.technique) for spec in graph.passes
    )


def decides(technique: Technique, name: str) -> bool:
    """Return whether some pass of a technique is there or not by one of its inputs."""
    return name in deciding_inputs(technique)


def deciding_inputs(technique: Technique) -> tuple[str, ...]:
    """Return the inputs of a technique by which some pass in it is there or not."""
    return _deciding(Identity(technique.written)) if isinstance(technique, Graph) else ()


@lru_cache(maxsize=512)
def _deciding(key: Identity[Graph]) -> tuple[str, ...]:
    graph = key.object
    if not is_conditional(graph):
        return ()
    terms = {term.removeprefix(NOT) for spec in graph.passes for term in spec.when}
    for export in graph.inputs:
        for head, _, rest in (target.partition(".") for target in export.targets):
            spec = graph.find(head)
            if spec is not None and decides(spec.technique, rest):
                terms.add(export.name)
    return tuple(export.name for export in graph.inputs if export.name in terms)


def why_unfed(technique: Technique, name: str) -> str:
    """Return why an input inside a technique, by its path, is not there to be wired."""
    head, _, rest = name.partition(".")
    spec = technique.find(head) if isinstance(technique, Graph) else None
    if spec is not None:
        return why_unfed(spec.technique, rest)
    whole = technique.written.find(head) if isinstance(technique, Graph) else None
    if whole is None or not isinstance(technique, Graph):
        return "there is no such input"
    term = unmet(whole.when, technique.wired)
    name = term.removeprefix(NOT)
    return f"pass '{head}' is there only where '{name}' is {'not wired' if name != term else 'wired'}"


def _present(passes: Sequence[PassSpec], graph: Graph, wired: frozenset[str]) -> tuple[PassSpec, ...]:
    """Return the passes that are there, each in its form."""
    there = [spec for spec in passes if not unmet(spec.when, wired)]
    names = {spec.name: spec.technique for spec in there}
    absent = {spec.name for spec in passes} - names.keys()
    inside = {name for name in wired if "." in name}
    inside |= {target for e in graph.inputs if e.name in wired for target in e.targets}
    found: list[PassSpec] = []
    for spec in there:
        inputs = tuple(_chosen(spec, names, absent))
        given = {name.partition(".")[2] for name in inside if name.partition(".")[0] == spec.name}
        given |= {name for name, _ in (*inputs, *spec.feedback)}
        own = _in_form(spec, inputs, given, found)
        names[own.name] = own.technique
        found.append(own)
    return tuple(found)


def _in_form(
    spec: PassSpec, inputs: tuple[tuple[str, str], ...], given: set[str], earlier: Sequence[PassSpec]
) -> PassSpec:
    technique = spec.technique
    if isinstance(technique, Graph) and is_conditional(technique):
        names = [name for name in input_names(technique) if name not in given]
        technique = form_of(technique, {*given, *(n for n in names if _is_found(technique, n, earlier))})
    values = spec.values
    if technique is not spec.technique:
        values = tuple((path, value) for path, value in values if find_targets(technique, path))
    if technique is spec.technique and inputs == spec.inputs and not spec.choices:
        return spec
    return replace(spec, technique=technique, inputs=inputs, choices=(), values=values)


def _is_found(technique: Technique, name: str, earlier: Sequence[PassSpec]) -> bool:
    """Return whether an earlier pass feeds an input that nothing is wired to: see ``flatten``."""
    if any(spec.name == name for spec in earlier):
        return True
    return not decides(technique, name) and any(name in output_names(spec.technique) for spec in earlier)


def _chosen(
    spec: PassSpec, there: Mapping[str, Technique], absent: Collection[str]
) -> Iterator[tuple[str, str]]:
    """Yield what each input of a pass reads, of several sources the first that is there; else it is unwired.

    A source that the technique never has is yielded as well: ``flatten`` names the nearest.
    """
    choices = dict(spec.choices)
    for name, text in spec.inputs:
        for source in choices.get(name, (text,)):
            path = source.partition(":")[0]
            head, _, rest = path.partition(".")
            if head not in absent and not _is_lost(there.get(head), rest):
                yield name, source
                break


def _is_lost(technique: Technique | None, path: str) -> bool:
    """Return whether a technique's file has a pass inside, by its path, that is not there."""
    if not path or not isinstance(technique, Graph):
        return False
    return inner(technique, path) is None and inner(technique.written, path) is not None


# ── checking a technique's file ──────────────────────────────────────────────


def check_forms(graph: Graph) -> None:
    """Raise ``SketchError`` for what one of a technique's forms lacks, and say where it is so."""
    deciding = deciding_inputs(graph)
    others = [name for name in input_names(graph) if name not in deciding]
    for wired in _combinations(deciding):
        form = form_of(graph, [*others, *wired])
        lacking = [name for name in deciding if name not in wired]
        where = f"where nothing is wired to {' and '.join(lacking)}" if lacking else "where all is wired"
        last = graph.passes[-1]
        if not graph.outputs and form.find(last.name) is None:
            message = f"pass '{last.name}' gives the outputs and is not there {where}"
            raise last.error(f"{message}; [outputs] can name another's")
        try:
            check_graph(form)
        except SketchError as error:
            one = error.diagnostics[0]
            raise SketchError(f"{one.message} ({where})", file=one.file, line=one.line) from None
        for spec, name in _unfed(form):
            message = f"pass '{spec.name}' needs its input '{name}' wired, as inputs = {{ {name} = \"…\" }}"
            raise spec.error(f"{message} ({where})")


def _combinations(deciding: Sequence[str]) -> list[set[str]]:
    if len(deciding) <= _ALL_FORMS:
        return [
            {name for name, on in zip(deciding, chosen, strict=True) if on}
            for chosen in product((True, False), repeat=len(deciding))
        ]
    whole = set(deciding)
    return [whole, set(), *({name} for name in deciding), *(whole - {name} for name in deciding)]


def _unfed(form: Graph) -> Iterator[tuple[PassSpec, str]]:
    """Yield each input that must be wired and that nothing in a form, nor its user, can feed."""
    exported = {target for export in form.inputs for target in export.targets}
    earlier: list[PassSpec] = []
    for spec in form.passes:
        wired = {name for name, _ in (*spec.inputs, *spec.feedback)}
        for name in input_names(spec.technique):
            if name in wired or f"{spec.name}.{name}" in exported or is_optional(spec.technique, name):
                continue
            inside = any(target.startswith(f"{spec.name}.") and target.count(".") > 1 for target in exported)
            if not inside and not _is_found(spec.technique, name, earlier):
                yield spec, name
        earlier.append(spec)
