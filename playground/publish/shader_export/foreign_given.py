"""List what other tools give a shader, and what stands for it elsewhere, by its meaning."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playground.shader.reserved_names import NEUTRAL, SIZES
from playground.sketch.model import ForeignShader, Kernel

_COMPONENTS = {"float": 1, "int": 1, "uint": 1, "bool": 1}
MOUSE = ("mouse", "hover", "drag", "hover_share")


def reason_to_stay(kernel: Kernel) -> str:
    """Return what of another tool's shader cannot leave, as the end of a message; "" if all of it can."""
    name = Path(kernel.path).name
    if isinstance(kernel, ForeignShader) and (kernel.helpers or kernel.vertex_source):
        return f"is {name}, whose own tool gives it functions or a vertex shader that others have not"
    shaped = [i.name for i in kernel.inputs if i.shape or i.sampling.flip or i.sampling.decode]
    if shaped:
        return f"reads {', '.join(shaped)} in a way that these formats have not"
    if kernel.file_parameters:
        return f"reads image files as they are encoded ({', '.join(p.name for p in kernel.file_parameters)})"
    if "k_frag_data" in kernel.source.names:
        return "writes several pictures (gl_FragData)"
    odd = [name for name, meaning in kernel.usual if not _is_known(meaning)]
    return f"reads {', '.join(odd)}, which these formats have not" if odd else ""


def _is_known(meaning: str) -> bool:
    meanings = ("time", "resolution", "delta", "frame", "frame_of_time", "date", *MOUSE)
    return meaning in meanings or meaning in NEUTRAL or meaning.startswith(SIZES)


def neutral(kind: str, values: tuple[float, ...]) -> str:
    """Return constant numbers as a type has them, zeros for those that are missing."""
    if kind.startswith("mat"):
        return f"{kind}(1.0)"
    count = _COMPONENTS.get(kind) or int(kind[-1])
    numbers = [*values, 0.0, 0.0, 0.0, 0.0][:count]
    if kind in ("int", "uint", "bool"):
        return f"{kind}({int(numbers[0])})"
    listed = ", ".join(map(repr, map(float, numbers)))
    return listed if kind == "float" else f"{kind}({listed})"


def fitted(expression: str, components: int) -> Callable[[str], str]:
    """Return a function that makes of a float or a vector what a type takes of it."""

    def of(kind: str) -> str:
        count = _COMPONENTS.get(kind) or int(kind[-1])
        if components == 1:
            return expression if kind in ("float", "vec1") else f"{kind}({expression})"
        if count <= components:
            part = f"({expression}).{'xyzw'[:count]}"
        else:
            part = f"vec{count}({expression}{', 0.0' * (count - components)})"
        return part if kind == "float" or kind.startswith("vec") else f"{kind}({part})"

    return of


def given_by(size: str, time: str, frame: str, mouse: str) -> dict[str, Callable[[str], str]]:
    """Return what gives each meaning as a type, of expressions that a format has; ``mouse`` may be ""."""
    expressions = {
        "time": fitted(time, 1),
        "resolution": fitted(f"vec3(vec2({size}), 1.0)", 3),
        "delta": fitted("(1.0 / 60.0)", 1),
        "frame": fitted(f"float({frame})", 1),
        "frame_of_time": fitted(f"float({frame})", 1),
    }
    if mouse:
        expressions |= {"drag": fitted(mouse, 4), "mouse": fitted(mouse, 4), "hover": fitted(mouse, 4)}
        expressions["hover_share"] = fitted(f"({mouse}.xy / vec2({size}))", 2)
    return expressions
