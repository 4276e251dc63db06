"""Check that a fast variant has its technique's outputs, and no other inputs and parameters."""

from __future__ import annotations

from playground.errors import SketchError, nearest
from playground.paths import shown
from playground.sketch.agreement import Bound
from playground.sketch.model import Graph, Kernel, Output, Technique
from playground.sketch.wiring import outputs_with_formats

INSIDE = "fast"
"""Name of the place, inside a technique, that the passes of its fast variant are in."""

_HELD = {1: ("float", "vec4"), 2: ("vec2", "vec4"), 4: ("vec4",)}  # types of a buffer that is an output


def check_shape(variant: Technique, of: Technique) -> None:
    """Raise ``SketchError`` or ``ShaderError`` where a fast variant has what its technique has not."""
    if isinstance(variant, Graph):
        check_passes(variant, of)
    else:
        check_compute(variant, of, of.outputs if isinstance(of, Kernel) else outputs_with_formats(of))


def check_compute(variant: Kernel, of: Technique, outputs: tuple[Output, ...]) -> None:
    """Raise ``SketchError`` or ``ShaderError`` where a ``.comp`` has what its technique has not."""
    items = [(p.name, p.line) for p in variant.parameters] + [(i.name, i.line) for i in variant.inputs]
    parameters, inputs = _names(of.parameters), _names(of.inputs)
    for name, line in items:
        valid = parameters if name in _names(variant.parameters) else inputs
        if name not in valid:
            raise _no_such(name, valid, of, variant.path, line)
    written = [*(o.name for o in outputs), *(b.name for b in variant.buffers)]
    for name in variant.overwrites:
        if name not in written:
            raise variant.error(f"overwrites: no output or buffer '{name}'{nearest(name, written)}")
    for output in outputs:
        held = next((b.type for b in variant.buffers if b.name == output.name), "")
        if held and not (output.format.endswith("32f") and held in _HELD[output.components]):
            raise variant.error(f"a buffer of {held} cannot be the output {output.name}:{output.format}")
    wrong = _unbound(variant.agrees, outputs)
    if wrong:
        raise variant.error(wrong)


def check_passes(variant: Graph, of: Technique) -> None:
    """Raise ``SketchError`` where a ``.fast.toml`` has what its technique has not, or other outputs."""
    for exports, valid in (
        (variant.parameters, _names(of.parameters)),
        (variant.inputs, _names(of.inputs)),
    ):
        for export in exports:
            if export.name not in valid:
                raise _no_such(export.name, valid, of, variant.path, export.line)
    wanted = of.outputs if isinstance(of, Kernel) else outputs_with_formats(of)
    found = outputs_with_formats(variant)
    if {(o.name, o.format) for o in found} != {(o.name, o.format) for o in wanted}:
        one, other = (", ".join(f"{o.name}:{o.format}" for o in some) for some in (found, wanted))
        raise SketchError(f"gives {one}; {of.name} gives {other}", file=shown(variant.path))
    wrong = _unbound(variant.agrees, wanted)
    if wrong:
        raise SketchError(wrong, file=shown(variant.path))
    if isinstance(of, Graph) and of.find(INSIDE):
        message = f"beside a fast variant no pass is named '{INSIDE}': that is where the variant's passes are"
        raise SketchError(message, file=shown(of.path))


def _names(some: tuple[object, ...]) -> set[str]:
    return {one.name for one in some}  # type: ignore[attr-defined]


def _no_such(name: str, valid: set[str], of: Technique, path: str, line: int) -> SketchError:
    message = f"'{name}' is not among the parameters and inputs of {of.name}{nearest(name, valid)}"
    return SketchError(message, file=shown(path), line=line)


def _unbound(agrees: tuple[Bound, ...], outputs: tuple[Output, ...]) -> str:
    """Return what is wrong with the bounds: an output without one, or one of no output."""
    names, bounds = [o.name for o in outputs], {bound.output for bound in agrees}
    for name in sorted(bounds - {"", *names}):
        return f"agrees: there is no output '{name}'{nearest(name, names)}"
    missing = [name for name in names if agrees and name not in bounds and "" not in bounds]
    return f"agrees: no bound for the output '{missing[0]}'" if missing else ""
