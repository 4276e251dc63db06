"""Check that a fast variant has its technique's outputs, and no other inputs and parameters."""

from __future__ import annotations

from playground.errors import SketchError, nearest
from playground.paths import shown
from playground.sketch.agreement import Bound
from playground.sketch.model import Graph, Kernel, Output, Technique
from playground.sketch.wiring import initial_names, outputs_with_formats

INSIDE = "fast"
"""Name of the place, inside a technique, that the passes of its fast variant are in."""

_HELD = {1: ("float", "vec4"), 2: ("vec2", "vec4"), 4: ("vec4",)}  # types of a buffer that is an output


def check_shape(variant: Technique, of: Technique) -> None:
    """Raise ``SketchError`` or ``ShaderError`` where a fast variant has what its technique has not."""
    starts = initial_names(of) if isinstance(of, Kernel) and of.kind == "draw" else ()
    names = [one.name for one in of.parameters], [*(one.name for one in of.inputs), *starts]
    for declared, valid in zip((variant.parameters, variant.inputs), names, strict=True):
        for one in declared:
            if one.name not in valid:
                message = f"'{one.name}' is not among the parameters and inputs of {of.name}"
                raise SketchError(
                    f"{message}{nearest(one.name, valid)}", file=shown(variant.path), line=one.line
                )
    outputs = of.outputs if isinstance(of, Kernel) else outputs_with_formats(of)
    if isinstance(variant, Graph):
        _check_passes(variant, of, outputs)
    else:
        _check_compute(variant, outputs)
    if wrong := _unbound(variant.agrees, outputs):
        raise variant.error(wrong)


def _check_compute(variant: Kernel, outputs: tuple[Output, ...]) -> None:
    written = [*(o.name for o in outputs), *(b.name for b in variant.buffers)]
    for name in variant.overwrites:
        if name not in written:
            raise variant.error(f"overwrites: no output or buffer '{name}'{nearest(name, written)}")
    if variant.in_place and len(outputs) != 1:
        raise variant.error(f"in_place: one output was expected, not {', '.join(o.name for o in outputs)}")
    for output in outputs:
        buffer = variant.buffer_of(output.name)
        held = buffer.type if buffer else ""
        if held and not (output.format.endswith("32f") and held in _HELD[output.components]):
            raise variant.error(f"a buffer of {held} cannot be the output {output.name}:{output.format}")


def _check_passes(variant: Graph, of: Technique, wanted: tuple[Output, ...]) -> None:
    found = outputs_with_formats(variant)
    if {(o.name, o.format) for o in found} != {(o.name, o.format) for o in wanted}:
        one, other = (", ".join(f"{o.name}:{o.format}" for o in some) for some in (found, wanted))
        raise variant.error(f"gives {one}; {of.name} gives {other}")
    if isinstance(of, Graph) and of.find(INSIDE):
        message = f"with a fast variant no pass is named '{INSIDE}': that is where the variant's passes are"
        raise of.error(message)


def _unbound(agrees: tuple[Bound, ...], outputs: tuple[Output, ...]) -> str:
    """Return what is wrong with the bounds: an output without one, or one of no output."""
    names, bounds = [o.name for o in outputs], {bound.output for bound in agrees}
    for name in sorted(bounds - {"", *names}):
        return f"agrees: there is no output '{name}'{nearest(name, names)}"
    missing = [name for name in names if agrees and name not in bounds and "" not in bounds]
    return f"agrees: no bound for the output '{missing[0]}'" if missing else ""
