"""List a technique's inputs and outputs, and check what its TOML says of them."""

from __future__ import annotations

from dataclasses import replace

from playground.errors import SketchError, nearest
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
