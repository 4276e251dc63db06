"""Write down kernels, draws, sources and plain shaders: see ``Kernel`` in schema.js."""

from __future__ import annotations

import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

from playground.engine.meshes import mesh_parameters
from playground.engine.textures import split_format
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.wrap import FRAGMENT, previous_name, recipes_of
from playground.sketch.model import Kernel, Parameter, Sampling
from playground.sketch.wiring import initial_names
from playground.web.es_lacks import lacking
from playground.web.expression_trees import accepted, tree
from playground.web.stages import stage_data
from playground.web.texts import Texts

UNITS = 16
"""Textures that a fragment shader of WebGL2 may read at least, and on many devices at most."""

_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


class Kernels:
    """The kernels of one sketch, each once."""

    def __init__(self, texts: Texts, folder: str) -> None:
        self.texts = texts
        self.folder = folder
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
        found: dict[str, Any] = {
            "name": _name(kernel),
            "kind": kernel.kind,
            "file": self.texts.add(kernel.source, self.folder, _name(kernel)),
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
            "repeat": tree(kernel.repeat),
            "countsFrames": counts_frames(kernel.repeat),
            "followsTime": follows_time(kernel.repeat),
            "initial": initial_names(kernel),
            "extensions": [],
            "vertex": {},
            "fragment": {},
        }
        if kernel.stride:
            found |= {"stride": tree(kernel.stride), "between": kernel.between}
        if kernel.at_once != "1":
            found["atOnce"] = tree(kernel.at_once)
        if kernel.until:
            found["until"] = kernel.until
        if kernel.accepts:
            found |= {"accepts": kernel.accepts, "accepted": accepted(kernel.accepts)}
        if kernel.kind == "draw":
            found |= {"mesh": kernel.registry, "blend": kernel.blend, "depth": kernel.depth}
            found["samples"] = kernel.samples
            if kernel.count:
                found["count"] = tree(kernel.count)
            if kernel.instances:
                found["instances"] = tree(kernel.instances)
        if kernel.kind.startswith("plain"):
            found |= {"usual": [list(pair) for pair in kernel.usual], "dialect": kernel.dialect}
        if used := _used(kernel):
            found["used"] = used
        if kernel.kind != "source":
            found |= self._stages(kernel)
        return found

    def _stages(self, kernel: Kernel) -> dict[str, Any]:
        _, recipes = recipes_of(kernel, FRAGMENT)
        found = {}
        for name, recipe in recipes.items():
            own = kernel.vertex_source if name == "vertex" else None
            file = self.texts.add(own, self.folder, f"{_name(kernel)} vertex") if own else ""
            found[name] = stage_data(recipe, file)
        return found


def sampling_data(sampling: Sampling) -> dict[str, Any]:
    """Return how a texture is read, without what is as usual: see ``Sampling`` in schema.js."""
    whole = asdict(sampling)
    always = {name: whole.pop(name) for name in ("filter", "wrap", "mipmap")}
    return always | {name: value for name, value in whole.items() if value}


def _name(kernel: Kernel) -> str:
    """Return a kernel's name, of one that was opened by its path the file's."""
    return Path(kernel.name).name if Path(kernel.name).is_absolute() else kernel.name


def _uniform(parameter: Parameter) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": parameter.name,
        "type": parameter.type,
        "widget": parameter.widget.kind,
    }
    if parameter.widget.values:
        found["values"] = list(parameter.widget.values)
    if parameter.widget.kind == "file":
        found["sampling"] = sampling_data(parameter.sampling)
    return found


def _used(kernel: Kernel) -> list[str]:
    """Return the names that a kernel's textures depend on though its text may not name them twice."""
    used = set(_IDENTIFIER.findall(f"{kernel.count} {kernel.instances} {kernel.stride} {kernel.at_once}"))
    if kernel.kind == "draw":
        used |= set(mesh_parameters(kernel.registry))
    if kernel.kind == "source":
        used |= {parameter.name for parameter in kernel.parameters}
    if kernel.dialect:  # what its tool declares is not in its text
        used |= {p.name for p in kernel.parameters if kernel.reads(p.name)}
    return sorted(used)


def _refuse(kernel: Kernel) -> None:
    """Raise ``SketchError`` for a kernel that WebGL2 cannot run."""
    if kernel.kind in ("compute", "plain_compute"):
        raise kernel.error(f"{_name(kernel)} is a compute shader, which no web page can run")
    if kernel.kind == "source":
        return
    if name := lacking(kernel.source.code):
        raise kernel.error(f"{_name(kernel)} names {name}, which the GLSL of web pages has not")
    if kernel.over:
        raise kernel.error(f"{_name(kernel)} draws over the pixels of another draw, which no web page does")
    if kernel.blend != "none" and any(split_format(o.format)[1] == "f4" for o in kernel.outputs):
        raise kernel.error(f"{_name(kernel)} blends 32-bit floats, which many browsers cannot; 16f can")
    names = [declared.name for declared in kernel.inputs]
    names += [parameter.name for parameter in kernel.file_parameters]
    names += [o.name for o in kernel.outputs if kernel.reads(previous_name(kernel, o))]
    if len(names) > UNITS:
        raise kernel.error(
            f"{_name(kernel)} reads {len(names)} textures; a web page has {UNITS} at a time for certain"
        )
