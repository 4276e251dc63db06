"""Leave out the passes of a technique whose sources are absent.

A pass of a technique may name an input of its technique as a source, ``inputs = { density = "density" }``:
it is absent where nothing is wired to that input. So is a pass that names an absent pass, a technique
of which an output is absent, and a pass that others name and none of those present reads. A list of
sources, ``["wooded:albedo", "cover"]``, is read from the first that is present, and unwired without one.

What remains is a form of the technique, a ``Graph`` like any other, so that all that reads a sketch
sees only what is present; ``Graph.written`` is all of it. An output's name alone wires no input that
a pass names: else a technique that happens to give a ``density`` would plant trees.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from playground.memo import GRAPHS
from playground.shader.kernel import Export, Graph, PassSpec, Technique
from playground.sketch.assign import find_targets
from playground.sketch.wiring import check_graph, input_names, output_names, takes_input


@GRAPHS.cached(identities=1)
def as_wired(sketch: Graph) -> Graph:
    """Return the passes of a sketch, the techniques in them in the forms that its wiring gives them.

    Raises ``SketchError`` at a pass whose technique has no output without an input that is not wired.
    """
    if not is_conditional(sketch):
        return sketch
    passes: list[PassSpec] = []
    for spec in sketch.passes:
        form, lacking = _in_form(spec, spec.inputs, (), passes)
        if lacking:
            example = f'as inputs = {{ {lacking} = "…" }}'
            raise spec.error(f"pass '{spec.name}' needs its input '{lacking}' wired, {example}")
        passes.append(form)
    same = all(left is other for left, other in zip(passes, sketch.passes, strict=True))
    return sketch if same else replace(sketch, passes=tuple(passes))


def form_of(technique: Graph, wired: Iterable[str]) -> Graph:
    """Return a technique as it is where some of its inputs, or paths inside, are wired."""
    whole = technique.written
    return _form(whole, frozenset(wired)) if is_conditional(whole) else whole


@GRAPHS.cached(identities=1)
def _form(whole: Graph, wired: frozenset[str]) -> Graph:
    passes, absent = _present(whole, wired)
    form = replace(whole, passes=tuple(passes), whole=whole, absent=tuple(absent.items()))
    form = replace(
        form,
        inputs=tuple(_narrowed(e, [t for t in e.targets if takes_input(form, t)]) for e in whole.inputs),
        parameters=tuple(
            _narrowed(export, targets)
            for export in whole.parameters
            if (targets := [target for target in export.targets if find_targets(form, target)])
        ),
        variants=() if absent else whole.variants,
    )
    if absent and not missing_input(form):
        check_graph(form)
    return form


def _narrowed(export: Export, targets: Sequence[str]) -> Export:
    return export if len(targets) == len(export.targets) else replace(export, targets=tuple(targets))


def missing_input(form: Graph) -> str:
    """Return the input that one of a technique's outputs lacks in this form of it; "" for none."""
    absent = dict(form.absent)
    return next((absent[name] for name in _output_passes(form.written) if name in absent), "")


def _output_passes(graph: Graph) -> list[str]:
    return [_head(target) for _, target in graph.outputs] or [graph.passes[-1].name]


def _head(source: str) -> str:
    return source.partition(":")[0].partition(".")[0]


@GRAPHS.cached(identities=1)
def is_conditional(technique: Technique) -> bool:
    """Return whether any pass inside may be absent."""
    return isinstance(technique, Graph) and (
        technique.whole is not None
        or bool(_named_inputs(technique))
        or any(spec.choices or is_conditional(spec.technique) for spec in technique.passes)
    )


def _named_inputs(graph: Graph) -> set[str]:
    """Return the inputs of a technique that its passes name as sources."""
    names = {export.name for export in graph.inputs} - {spec.name for spec in graph.passes}
    return names & {text for spec in graph.passes for _, texts in sources_of(spec) for text in texts}


def sources_of(spec: PassSpec) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the inputs of a pass and what feeds each: several sources, where its file lists them."""
    choices = dict(spec.choices)
    for name, text in spec.inputs:
        yield name, choices.get(name, (text,))


@GRAPHS.cached(identities=1)
def deciding_inputs(technique: Technique) -> tuple[str, ...]:
    """Return the inputs of a technique by which some pass in it is present or absent."""
    if not isinstance(technique, Graph) or not is_conditional(technique):
        return ()
    graph = technique.written
    named = _named_inputs(graph)
    for export in graph.inputs:
        for head, _, rest in (target.partition(".") for target in export.targets):
            spec = graph.find(head)
            if spec is not None and rest in deciding_inputs(spec.technique):
                named.add(export.name)
    return tuple(export.name for export in graph.inputs if export.name in named)


def _present(graph: Graph, wired: frozenset[str]) -> tuple[list[PassSpec], dict[str, str]]:
    """Return the passes that are present, each in its form, and of the others the input that each lacks."""
    named = _named_inputs(graph)
    inside = {name for name in wired if "." in name}
    inside |= {target for e in graph.inputs if e.name in wired for target in e.targets}
    absent: dict[str, str] = {}
    while True:
        specs: list[PassSpec] = []
        lost: dict[str, str] = {}
        lacks = {name: name for name in named - wired} | absent
        for spec in graph.passes:
            if spec.name in absent:
                continue
            inputs, lacking = _chosen(spec, named, lacks)
            if not lacking:
                names_given = [t.partition(".")[2] for t in inside if t.partition(".")[0] == spec.name]
                form, name = _in_form(spec, inputs, names_given, specs)
                path = f"{spec.name}.{name}"
                lacking = next((e.name for e in graph.inputs if path in e.targets), name)
            if lacking:
                lost[spec.name] = lacking
            else:
                specs.append(form)
        lost = lost or _unread(graph, specs, absent)
        if not lost:
            return specs, absent
        absent |= lost


def _chosen(
    spec: PassSpec, named: Collection[str], lacks: Mapping[str, str]
) -> tuple[tuple[tuple[str, str], ...], str]:
    """Return what each input of a pass reads inside its technique, and what a source that it needs lacks."""
    inputs: list[tuple[str, str]] = []
    for name, sources in sources_of(spec):
        source = next((source for source in sources if _head(source) not in lacks), None)
        if source is None and name not in dict(spec.choices):
            return (), lacks[_head(sources[0])]
        if source is not None and source not in named:  # else the technique's own input feeds it
            inputs.append((name, source))
    return tuple(inputs), ""


def _in_form(
    spec: PassSpec,
    inputs: tuple[tuple[str, str], ...],
    names_given: Collection[str],
    earlier: Sequence[PassSpec],
) -> tuple[PassSpec, str]:
    """Return a pass with its technique in its form, and the input that an output of it lacks."""
    technique, values = spec.technique, spec.values
    if isinstance(technique, Graph) and is_conditional(technique):
        wired = {*names_given, *(name for name, _ in (*inputs, *spec.feedback))}
        names = [name for name in input_names(technique) if name not in wired]
        technique = form_of(technique, wired | {n for n in names if _is_found(technique, n, earlier)})
        if lacking := missing_input(technique):
            return spec, lacking
        values = tuple((path, value) for path, value in values if find_targets(technique, path))
    if technique is spec.technique and inputs == spec.inputs and not spec.choices:
        return spec, ""
    return replace(spec, technique=technique, inputs=inputs, choices=(), values=values), ""


def _is_found(technique: Technique, name: str, earlier: Sequence[PassSpec]) -> bool:
    """Return whether an earlier pass feeds an input that nothing is wired to: see ``flatten``."""
    if any(spec.name == name for spec in earlier):
        return True
    decides = name in deciding_inputs(technique)
    return not decides and any(name in output_names(spec.technique) for spec in earlier)


def _unread(graph: Graph, specs: Sequence[PassSpec], absent: Mapping[str, str]) -> dict[str, str]:
    """Return the passes that others name and none reads, with the input that one of those lacks."""
    readers: dict[str, list[str]] = {}
    for spec in graph.passes:
        for _, sources in sources_of(spec):
            for source in sources:
                readers.setdefault(_head(source), []).append(spec.name)
    read = {_head(source) for spec in specs for _, source in spec.inputs} | {*_output_passes(graph)}
    return {
        spec.name: next((absent[name] for name in readers[spec.name] if name in absent), "")
        for spec in specs
        if spec.name in readers.keys() - read
    }
