"""List a technique's inputs and outputs, check what its TOML says of them, leave out what lacks a source."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from playground.errors import SketchError, nearest
from playground.memo import GRAPHS
from playground.shader import expressions
from playground.shader.expressions import ExpressionError
from playground.shader.kernel import Draw, Export, Graph, Kernel, Output, PassSpec, Technique, TexelKernel
from playground.shader.widgets import SCALARS
from playground.sketch.assign import find_targets, resolve

_GIVEN = (*expressions.CLOCKS, *expressions.COUNTERS, "compute", "size.x", "size.y")
"""What every expression may name."""


def output_names(technique: Technique) -> tuple[str, ...]:
    """Return the names of a technique's outputs."""
    if isinstance(technique, Kernel):
        return tuple(o.name for o in technique.outputs)
    if technique.outputs:
        return tuple(name for name, _ in technique.outputs)
    return output_names(technique.passes[-1].technique)


def input_names(technique: Technique) -> tuple[str, ...]:
    """Return the names of a technique's inputs, optional ones included."""
    if isinstance(technique, Kernel):
        return tuple(i.name for i in technique.inputs)
    return tuple(e.name for e in technique.inputs)


def initial_names(technique: Technique) -> dict[str, str]:
    """Map the optional inputs that a repeated kernel or a draw starts from to the outputs they start."""
    if isinstance(technique, Draw):
        return {"initial": technique.outputs[0].name}
    if not isinstance(technique, TexelKernel) or technique.repeat == "1":
        return {}
    if len(technique.outputs) == 1:
        return {"initial": technique.outputs[0].name}
    return {f"initial_{o.name}": o.name for o in technique.outputs}


def takes_input(technique: Technique, name: str) -> bool:
    """Return whether an input of that name, or path inside, can be wired."""
    if isinstance(technique, Kernel):
        return name in input_names(technique) or name in initial_names(technique)
    head, _, rest = name.partition(".")
    if not rest:
        return name in input_names(technique)
    spec = technique.find(head)
    return spec is not None and takes_input(spec.technique, rest)


def is_optional(technique: Technique, name: str) -> bool:
    """Return whether an input may stay unwired."""
    if isinstance(technique, Kernel):
        if name in initial_names(technique):
            return True
        return any(i.name == name and i.fallback for i in technique.inputs)
    head, _, rest = name.partition(".")
    if rest:
        spec = technique.find(head)
        return spec is not None and (rest in dict(spec.inputs) or is_optional(spec.technique, rest))
    export = next((e for e in technique.inputs if e.name == name), None)
    return export is not None and all(is_optional(technique, target) for target in export.targets)


def target_of(technique: Graph, name: str) -> str:
    """Return the target of a technique's output, as ``inner:output``; by default the last pass has it."""
    return dict(technique.outputs).get(name, f"{technique.passes[-1].name}:{name}")


def inner(technique: Technique, path: str) -> Technique | None:
    """Return the technique of a pass inside, by path; None if there is none."""
    for part in path.split("."):
        spec = technique.find(part) if isinstance(technique, Graph) else None
        if spec is None:
            return None
        technique = spec.technique
    return technique


def outputs_with_formats(graph: Graph) -> tuple[Output, ...]:
    """Return a technique's outputs with the formats that its inner kernels give them."""
    return tuple(replace(_leaf_output(graph, name), name=name) for name in output_names(graph))


def check_graph(graph: Graph) -> None:
    """Raise ``SketchError`` for an export, an output or an expression without a target."""
    for export in graph.parameters:
        _check_parameter(graph, export)
    for export in graph.inputs:
        for target in export.targets:
            if "." not in target or not takes_input(graph, target):
                valid = [f"{s.name}.{i}" for s in graph.passes for i in input_names(s.technique)]
                message = f"input '{export.name}': nothing inside takes '{target}'{nearest(target, valid)}"
                raise graph.error(message, export.line)
    for name, _ in graph.outputs:
        _leaf_output(graph, name)
    for spec in graph.passes:
        _check_expressions(graph, spec)


def _check_parameter(graph: Graph, export: Export) -> None:
    def wrong(message: str) -> SketchError:
        return graph.error(f"{export.name}: {message}", export.line)

    types: dict[str, str] = {}
    for target in export.targets:
        if "." not in target:
            raise wrong(f"'{target}' should be a path inside, as \"{graph.passes[0].name}.{target}\"")
        try:
            types |= {t.path: t.parameter.type for t in resolve(graph, target)}
        except SketchError as error:
            raise wrong(error.diagnostics[0].message) from None
    if len(set(types.values())) > 1:
        raise wrong("its targets have types of their own: " + ", ".join(f"{p} {t}" for p, t in types.items()))


def _check_expressions(graph: Graph, spec: PassSpec) -> None:
    texts = [("size", text) for text in spec.size or ()]
    texts += [("repeat", spec.repeat)] if spec.repeat else []
    for what, text in texts:
        try:
            names = expressions.names_in(text)
            if "frames" in names and find_targets(graph, "frames"):
                raise ExpressionError(f"'{text}': 'frames' {expressions.TWO_FRAMES}")
            numbers = {name for name in names if _is_number(graph, name)}
            if names - numbers:
                expressions.check(text, [*numbers, *_numbers(graph)])
            expressions.check(text, numbers)
        except ExpressionError as error:
            raise spec.error(f"pass '{spec.name}': {what}: {error}") from None


def _is_number(graph: Graph, name: str) -> bool:
    if name in _GIVEN:
        return True
    head, _, axis = name.rpartition(".")
    if axis in ("x", "y") and head.endswith(".size"):
        sized = head.removesuffix(".size")
        if inner(graph, sized) is not None or sized in input_names(graph):
            return True
        if any(target.parameter.widget.kind == "file" for target in find_targets(graph, sized)[:1]):
            return True
    return any(target.parameter.type in SCALARS for target in find_targets(graph, name)[:1])


def _numbers(graph: Graph) -> list[str]:
    """Return names that an expression may well mean, for a hint."""
    sized = [spec.name for spec in graph.passes] + list(input_names(graph))
    return [
        *_GIVEN,
        *(f"{name}.size.{axis}" for name in sized for axis in "xy"),
        *(export.name for export in graph.parameters),
        *(f"{spec.name}.{p.name}" for spec in graph.passes for p in spec.technique.parameters),
    ]


def _leaf_output(graph: Graph, name: str) -> Output:
    path, _, output = target_of(graph, name).partition(":")
    technique = inner(graph, path)

    def wrong(message: str) -> SketchError:
        return graph.error(f"output '{name}': {message}", graph.line)

    if technique is None:
        raise wrong(f"no pass '{path}' inside{nearest(path, [s.name for s in graph.passes])}")
    names = output_names(technique)
    output = output or (name if name in names else names[0])
    if output not in names:
        raise wrong(f"'{path}' has no '{output}'{nearest(output, names)}")
    if isinstance(technique, Graph):
        return _leaf_output(technique, output)
    return next(o for o in technique.outputs if o.name == output)


# ── passes that are present ──────────────────────────────────────────────────
#
# A pass of a technique may name an input of its technique as a source, inputs = { density = "density" }:
# it is absent where nothing is wired to that input. So is a pass that names an absent pass, a technique
# of which an output is absent, and a pass that others name and none of those present reads. A list of
# sources, ["wooded:albedo", "cover"], is read from the first that is present, and unwired without one.
#
# What remains is a form of the technique, a ``Graph`` like any other, so that all that reads a sketch
# sees only what is present; ``Graph.written`` is all of it. An output's name alone wires no input that
# a pass names: else a technique that happens to give a ``density`` would plant trees.


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
    complete = technique.written
    return _form(complete, frozenset(wired)) if is_conditional(complete) else complete


@GRAPHS.cached(identities=1)
def _form(complete: Graph, wired: frozenset[str]) -> Graph:
    passes, absent = _present(complete, wired)
    form = replace(complete, passes=tuple(passes), complete=complete, absent=tuple(absent.items()))
    form = replace(
        form,
        inputs=tuple(_narrowed(e, [t for t in e.targets if takes_input(form, t)]) for e in complete.inputs),
        parameters=tuple(
            _narrowed(export, targets)
            for export in complete.parameters
            if (targets := [target for target in export.targets if find_targets(form, target)])
        ),
        variants=() if absent else complete.variants,
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
        technique.complete is not None
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
    return found_source(technique, name, earlier) is not None


def found_source(technique: Technique, name: str, earlier: Sequence[PassSpec]) -> tuple[PassSpec, str] | None:
    """Return the earlier pass, and its output, that feed an input that nothing is wired to; else None.

    It is the latest pass of the input's name, else the latest with an output of that name, but for an
    input by which passes are there.
    """
    for spec in reversed(earlier):
        if spec.name == name:
            names = output_names(spec.technique)
            return spec, name if name in names else names[0]
    for spec in reversed(earlier if name not in deciding_inputs(technique) else ()):
        if name in output_names(spec.technique):
            return spec, name
    return None


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
