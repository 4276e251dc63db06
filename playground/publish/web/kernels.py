"""Write down kernels, draws, sources and plain shaders: see ``Kernel`` in schema.js."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from playground.engine.meshes import mesh_parameters
from playground.engine.textures import split_format
from playground.errors import ShaderError
from playground.publish.web.formulas import accepted_runs, formula
from playground.publish.web.texts import Texts
from playground.publish.web.traces import trace_data
from playground.shader.common_glsl import desktop_only, in_common_glsl, lacking
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.kernel import options_of
from playground.shader.parameter import Sampling
from playground.shader.stage_recipe import Recipe, StagePart
from playground.shader.wrap import FRAGMENT, previous_name, recipes_of
from playground.sketch.model import (
    ComputeVariant,
    CpuSource,
    Draw,
    ForeignShader,
    Kernel,
    Parameter,
    PlainCompute,
    PlainFragment,
    PlainShader,
)
from playground.sketch.wiring import initial_names

UNITS = 16
"""Textures that a fragment shader of WebGL2 may read at least, and on many devices at most."""


class Kernels:
    """The kernels of one sketch, each once."""

    def __init__(self, texts: Texts, folder: str, *, traces: bool = False) -> None:
        self.texts = texts
        self.folder = folder
        self.traces = traces  # whether traced texts go with them
        self.data: list[dict[str, Any]] = []
        self._numbers: dict[int, int] = {}  # by identity
        self._held: list[Kernel] = []

    def add(self, kernel: Kernel) -> int:
        """Return a kernel's number; raise ``SketchError`` for one that no page can run."""
        if id(kernel) not in self._numbers:
            _refuse(kernel)
            self._numbers[id(kernel)] = len(self.data)
            self._held.append(kernel)
            self.data.append(self._written(kernel))
        return self._numbers[id(kernel)]

    def _written(self, kernel: Kernel) -> dict[str, Any]:
        recipes = _recipes(kernel)
        source = recipes["fragment"].source if recipes else kernel.source
        data: dict[str, Any] = {
            "name": name_of(kernel),
            "kind": kernel.kind,
            "file": self.texts.add(source, self.folder, name_of(kernel)),
            "title": kernel.title,
            "outputs": [{"name": output.name, "format": output.format} for output in kernel.outputs],
            "inputs": [
                {
                    "name": declared.name,
                    "sampling": sampling_data(declared.sampling),
                    "fallback": declared.fallback,
                    "shape": declared.shape,
                }
                for declared in kernel.inputs
            ],
            "parameters": [_uniform(parameter) for parameter in kernel.parameters],
            "repeat": formula(kernel.repeat),
            "countsFrames": counts_frames(kernel.repeat),
            "followsTime": follows_time(kernel.repeat),
            "initial": initial_names(kernel),
            "extensions": [],
            "vertex": {},
            "fragment": {},
        }
        rows = [(row, row.of(kernel)) for row in options_of(type(kernel)).values() if row.page]
        data |= {row.page: formula(value) if row.expressions else value for row, value in rows if value != ""}
        if kernel.accepts:
            data["accepted"] = accepted_runs(kernel.accepts)
        if isinstance(kernel, PlainShader):
            data["usual"] = [list(pair) for pair in kernel.usual]
            data["dialect"] = kernel.dialect if isinstance(kernel, ForeignShader) else ""
        if used := _used(kernel):
            data["used"] = used
        for name, recipe in recipes.items():
            own = kernel.vertex_source if name == "vertex" and isinstance(kernel, ForeignShader) else None
            label = f"{name_of(kernel)} vertex"
            data[name] = stage_data(recipe, self.texts.add(recipe.source, self.folder, label) if own else "")
        if self.traces and (trace := trace_data(kernel, recipes, self.texts, self.folder, name_of(kernel))):
            data["trace"] = trace
        return data


def _recipes(kernel: Kernel) -> dict[str, Recipe]:
    """Return how a kernel's stages are made, of a text that GLSL ES 3.00 has as well.

    Other tools' shaders are rewritten. Raises ``ShaderError`` at the first line of a kernel that would be.
    """
    if isinstance(kernel, CpuSource):
        return {}
    _, recipes = recipes_of(kernel, FRAGMENT)
    if isinstance(kernel, PlainFragment):
        return {name: _in_common_glsl(recipe) for name, recipe in recipes.items()}
    for diagnostic in desktop_only(kernel):
        raise ShaderError(diagnostics=[replace(diagnostic, severity="error")])
    return recipes


def _in_common_glsl(recipe: Recipe) -> Recipe:
    """Return a recipe of the same stage, line for line, in the common subset of desktops and pages."""
    text, first = recipe.make()
    if (common := in_common_glsl(text)) == text:
        return recipe
    if not first:
        return replace(recipe, text=common)
    lines, before, count = common.split("\n"), text.split("\n"), len(recipe.source.lines)
    begin, end = first - 1, first - 1 + count
    own = zip(recipe.source.lines, before[begin:end], lines[begin:end], strict=True)
    source = recipe.source.with_codes([line.code if was == now else now for line, was, now in own])
    head = (StagePart("\n".join(lines[:begin])),) if begin else ()
    return replace(recipe, source=source, before=head, after="\n".join(lines[end:]))


def stage_data(recipe: Recipe, file: str = "") -> dict[str, Any]:
    """Return a recipe as data; ``file``: the name of its lines' file where it is not the kernel's own."""
    if recipe.text:
        return {"text": recipe.text}
    before = [
        {"text": part.text, **({"names": list(part.names)} if part.names else {})} for part in recipe.before
    ]
    data: dict[str, Any] = {"before": before, "after": recipe.after.removesuffix("\n")}
    if recipe.without:
        data["without"] = recipe.without
    if recipe.replaced:
        data["replace"] = dict(recipe.replaced)
    if recipe.keeps_version:
        data["keepsVersion"] = True
    if file:
        data["file"] = file
    return data


def sampling_data(sampling: Sampling) -> dict[str, Any]:
    """Return how a texture is read, without what is as usual: see ``Sampling`` in schema.js."""
    whole = asdict(sampling)
    always = {name: whole.pop(name) for name in ("filter", "wrap", "mipmap")}
    return always | {name: value for name, value in whole.items() if value}


def name_of(kernel: Kernel) -> str:
    """Return a kernel's name, of one that was opened by its path the file's."""
    return Path(kernel.name).name if Path(kernel.name).is_absolute() else kernel.name


def _uniform(parameter: Parameter) -> dict[str, Any]:
    data: dict[str, Any] = {
        "name": parameter.name,
        "type": parameter.type,
        "widget": parameter.widget.kind,
    }
    if parameter.widget.values:
        data["values"] = list(parameter.widget.values)
    if parameter.widget.kind == "file":
        data["sampling"] = sampling_data(parameter.sampling)
    return data


def _used(kernel: Kernel) -> list[str]:
    """Return the names that a kernel's textures depend on though its text may not name them twice."""
    used = set(kernel.names_in_options)
    match kernel:
        case Draw():
            used |= set(mesh_parameters(kernel.mesh))
        case CpuSource():
            used |= {parameter.name for parameter in kernel.parameters}
        case ForeignShader():  # what its tool declares is not in its text
            used |= {p.name for p in kernel.parameters if kernel.reads(p.name)}
    return sorted(used)


def _refuse(kernel: Kernel) -> None:
    """Raise ``SketchError`` for a kernel that WebGL2 cannot run."""
    if isinstance(kernel, ComputeVariant | PlainCompute):
        raise kernel.error(f"{name_of(kernel)} is a compute shader, which no web page can run")
    if isinstance(kernel, CpuSource):
        return
    if name := lacking(kernel.source.code):
        raise kernel.error(f"{name_of(kernel)} names {name}, which the GLSL of web pages has not")
    if isinstance(kernel, Draw) and kernel.over:
        raise kernel.error(f"{name_of(kernel)} draws over the pixels of another draw, which no web page does")
    floats = any(split_format(output.format)[1] == "f4" for output in kernel.outputs)
    if isinstance(kernel, Draw) and kernel.blend != "none" and floats:
        raise kernel.error(f"{name_of(kernel)} blends 32-bit floats, which many browsers cannot; 16f can")
    names = [declared.name for declared in kernel.inputs]
    names += [parameter.name for parameter in kernel.file_parameters]
    names += [o.name for o in kernel.outputs if kernel.reads(previous_name(kernel, o))]
    if len(names) > UNITS:
        raise kernel.error(
            f"{name_of(kernel)} reads {len(names)} textures; a web page has {UNITS} at a time for certain"
        )
