"""Write what is known of a name as the Markdown that an editor shows."""

from __future__ import annotations

from pathlib import Path

from playground.commands.entries import Choice
from playground.paths import shown
from playground.shader.outline import Declared
from playground.shader.parameter import expected, write
from playground.shader.widgets import WIDGETS
from playground.sketch.model import Kernel, Parameter, Technique
from playground.sketch.suggestions import Suggestion
from playground.sketch.wiring import input_names, output_names


def code(text: str, language: str = "glsl") -> str:
    """Return a block of code."""
    return f"```{language}\n{text}\n```"


def declared(declaration: Declared, path: Path) -> str:
    """Return a declaration with its comment and its file."""
    parts = [code(declaration.signature), declaration.comment, f"*{shown(path)}*"]
    return "\n\n".join(filter(None, parts))


def parameter(item: Parameter) -> str:
    """Return what a parameter is: type, default, range, tooltip, where it is declared."""
    choice = Choice(item.name, item, item.default, exported=True)
    unit = f" {item.unit}" if item.unit else ""
    facts = [f"default `{write(item, item.default)}`{unit}"] if item.widget.kind != "file" else []
    if choice.range:
        facts.append(choice.range + unit)
    parts = [
        code(f"uniform {item.type} {item.name}"),
        f"**{item.title}**: {item.widget.kind}; {'; '.join(facts) or expected(item)}",
        item.tooltip,
        f"*{shown(item.file)}:{item.line}*" if item.file else "",
    ]
    return "\n\n".join(filter(None, parts))


def widget(name: str) -> str:
    """Return what a widget is: what it takes in brackets, what it is for, the types that may have it."""
    kind = WIDGETS[name]
    types = ", ".join(f"`{glsl_type}`" for glsl_type in kind.types)
    return f"{code(f'//! {name}')}\n\n{kind.about}\n\nin brackets: {kind.takes or 'nothing'}; for {types}"


def technique(use: str, item: Technique) -> str:
    """Return what a technique is: title, inputs, outputs, parameters."""
    kind = f"{item.kind}" if isinstance(item, Kernel) else "several passes"
    names = ", ".join(f"`{p.name}`" for p in item.parameters)
    parts = [
        f"**{item.title or use}** ({kind})",
        f"inputs: {', '.join(f'`{name}`' for name in input_names(item)) or 'none'}",
        f"outputs: {', '.join(f'`{name}`' for name in output_names(item))}",
        f"parameters: {names or 'none'}",
        f"*{shown(item.path)}*",
    ]
    return "\n\n".join(parts)


def suggestion(known: Suggestion) -> str:
    """Return what is known of a name, by what it stands for."""
    match known.origin:
        case (Path() as path, Declared() as declaration):
            return declared(declaration, path)
        case Parameter() as item:
            return parameter(item)
        case None:
            return known.about
        case item:
            return technique(known.label, item)
