"""Write what is known of a name as the Markdown that an editor shows."""

from __future__ import annotations

from pathlib import Path

from playground.paths import shown
from playground.shader.outline import Declared
from playground.shader.parameter import expected, write
from playground.sketch.catalogue import Choice
from playground.sketch.model import Kernel, Parameter, Technique
from playground.sketch.wiring import input_names, output_names


def code(text: str, language: str = "glsl") -> str:
    """Return a block of code."""
    return f"```{language}\n{text}\n```"


def declared(one: Declared, path: Path) -> str:
    """Return a declaration with its comment and its file."""
    parts = [code(one.signature), one.comment, f"*{shown(path)}*"]
    return "\n\n".join(filter(None, parts))


def parameter(one: Parameter) -> str:
    """Return what a parameter is: type, default, range, tooltip, where it is declared."""
    choice = Choice(one.name, one, one.default, exported=True)
    unit = f" {one.unit}" if one.unit else ""
    facts = [f"default `{write(one, one.default)}`{unit}"] if one.widget.kind != "file" else []
    if choice.range:
        facts.append(choice.range + unit)
    parts = [
        code(f"uniform {one.type} {one.name}"),
        f"**{one.title}**: {one.widget.kind}; {'; '.join(facts) or expected(one)}",
        one.tooltip,
        f"*{shown(one.file)}:{one.line}*" if one.file else "",
    ]
    return "\n\n".join(filter(None, parts))


def technique(use: str, one: Technique) -> str:
    """Return what a technique is: title, inputs, outputs, parameters."""
    kind = f"{one.kind}" if isinstance(one, Kernel) else "several passes"
    names = ", ".join(f"`{p.name}`" for p in one.parameters)
    parts = [
        f"**{one.title or use}** ({kind})",
        f"inputs: {', '.join(f'`{name}`' for name in input_names(one)) or 'none'}",
        f"outputs: {', '.join(f'`{name}`' for name in output_names(one))}",
        f"parameters: {names or 'none'}",
        f"*{shown(one.path)}*",
    ]
    return "\n\n".join(parts)
