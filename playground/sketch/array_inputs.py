"""Wire an array to an input of a pass: it becomes the texture of a pass of its own, which a source reads.

The array is a file as ``arrays`` makes it, and that file a value of the sketch like any other.
"""

from __future__ import annotations

from dataclasses import replace

from playground.errors import ParameterError, nearest
from playground.shader.kernel import ARRAY, CpuSource, Graph, Output, PassSpec
from playground.shader.parameter import Parameter
from playground.shader.source import Line, SourceText
from playground.shader.widgets import Widget
from playground.sketch.arrays import ArrayFile, texels
from playground.sketch.wiring import initial_names, input_names, takes_input

_FORMATS = {1: "r32f", 2: "rg32f", 4: "rgba32f"}
_PARAMETER = "array"


def wired(graph: Graph, path: str, value: object) -> tuple[Graph, str, ArrayFile]:
    """Return the graph with an array on an input, the path of the parameter that names it, and its value.

    ``path`` is ``pass.input``. Raises ``ParameterError`` where there is no such input, or no such array.
    """
    name, _, input_name = path.partition(".")
    spec = graph.find(name)
    if spec is None or not input_name or not takes_input(spec.technique, input_name):
        there = [
            f"{spec.name}.{each}"
            for spec in graph.passes
            for each in (*input_names(spec.technique), *initial_names(spec.technique))
        ]
        raise ParameterError(f"no input '{path}'{nearest(path, there)}")
    file, (ny, nx, channels) = texels(value, path)
    own = _name(graph, path, dict(spec.inputs).get(input_name, ""))
    array = PassSpec(own, ARRAY, _kernel(channels), size=(str(nx), str(ny)))
    wires = {**dict(spec.inputs), input_name: own}
    others = [spec for spec in graph.passes if spec.name != own]
    passes = [replace(item, inputs=tuple(wires.items())) if item is spec else item for item in others]
    return replace(graph, passes=(array, *passes)), f"{own}.{_PARAMETER}", file


def _name(graph: Graph, path: str, before: str) -> str:
    """Return the name of an array's pass: that of the array which it takes the place of, else a new one."""
    earlier = graph.find(before)
    if earlier is not None and earlier.use == ARRAY:
        return before
    name = f"{path.replace('.', '_')}_{_PARAMETER}"
    while graph.find(name) is not None:
        name += "_"
    return name


def _kernel(channels: int) -> CpuSource:
    return CpuSource(
        name=ARRAY,
        source=SourceText("", (Line("", "", "", "", 1),)),
        outputs=(Output("values", _FORMATS[channels]),),
        parameters=(Parameter(_PARAMETER, "sampler2D", "", Widget("file")),),
        registry="array_file",
    )
