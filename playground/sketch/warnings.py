"""Warn of what in a sketch's texts has no effect, another one than its author can see, or a former name."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

from playground.errors import Diagnostic, PlaygroundError
from playground.paths import GLSL
from playground.regular_file import read_regular
from playground.sketch.expressions import names_in
from playground.sketch.model import Graph, Kernel, Sketch, kernels_of
from playground.sketch.uniforms import unfed_samplers


def warnings_of_kernel(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return warnings of what has no effect: parameters that nothing reads, and ``unheeded``."""
    return (*unread(kernel), *unheeded(kernel))


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``#line``."""
    is_plain = kernel.kind.startswith("plain") and not kernel.dialect
    found = [*(unfed_samplers(kernel.source) if is_plain else ())]
    found += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(found))


def unread(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each parameter and input of a kernel that nothing reads.

    Included declarations count, at their own file and line. What a fast variant, a pragma or a macro
    reads counts as read, and so does what a size or a repeat of the technique around it names. Sources
    and draws are left alone: the engine reads their uniforms.
    """
    if kernel.kind in ("source", "draw"):
        return ()
    variants = [inner for v in kernel.variants for _, inner in kernels_of(v.technique)]
    texts = [each.source for each in (kernel, *variants)]
    code = "\n".join([text.code for text in texts] + [line.pragma for text in texts for line in text.lines])
    found = []
    for name in [*(p.name for p in kernel.parameters), *(i.name for i in kernel.inputs)]:
        declared = rf"\buniform\b[^;\n]*?\b{re.escape(name)}\s*(?:=[^;\n]*)?;"
        rest = re.sub(declared, "", code)
        if re.search(rf"\b(?:\w+_)?{re.escape(name)}\b", rest):
            continue
        if name in _counted(Path(kernel.path)):
            continue
        for line in kernel.source.lines:
            if match := re.search(declared, line.code):
                column = match.start() + match[0].index(name) + 1
                found.append(
                    line.diagnostic(f"nothing reads '{name}', so it has no effect", column, "warning")
                )
                break
    return tuple(found)


def _counted(path: Path) -> frozenset[str]:
    """Return the parameters of a kernel that sizes and repeats name in the techniques of its folder.

    These are the technique that the folder is of, and those in it. A name is followed to what it exports.
    """
    folder = path.parent
    found: set[str] = set()
    for file in (folder.with_suffix(".toml"), *sorted(folder.glob("*.toml"))):
        try:
            table = tomllib.loads(read_regular(file).decode())
            exports = table.get("parameters", {})
            uses = {each["name"]: each["use"].rpartition("/")[2] for each in table.get("pass", [])}
            counts = [each.get(key, "") for each in table.get("pass", []) for key in ("size", "repeat")]
            both = [text for count in counts for text in (count if isinstance(count, list) else [count])]
            for name in {name for text in both if text for name in names_in(str(text))}:
                targets = exports.get(name, name)
                for target in [targets] if isinstance(targets, str) else targets:
                    used = uses.get(target.partition(".")[0], path.stem)
                    # Of a technique in the technique any pass may be the kernel's.
                    if used == path.stem or not (folder / f"{used}.glsl").is_file():
                        found.add(target.rpartition(".")[2])
        except (OSError, ValueError, AttributeError, KeyError, TypeError, PlaygroundError):
            continue  # it is not there, or reading the technique itself says what is wrong with it
    return frozenset(found)


def former_names_used(sketch: Sketch) -> tuple[Diagnostic, ...]:
    """Return a warning for each former name in a sketch, in its own techniques or in what is set over it."""
    return tuple(dict.fromkeys([*sketch.warnings, *_of_graph(sketch.graph)]))


def _of_graph(graph: Graph) -> Iterator[Diagnostic]:
    if not Path(graph.path).is_relative_to(GLSL):
        yield from graph.warnings
    for spec in graph.passes:
        if isinstance(spec.technique, Graph):
            yield from _of_graph(spec.technique)
