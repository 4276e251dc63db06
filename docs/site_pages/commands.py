"""Generate the reference of the command line from its own declarations."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from playground.cli import command_line

from .markdown import code, escaped, fenced, table

_HEAD = """# Commands

This page is generated from the program itself: `playground --help` and `playground COMMAND --help`
say the same in a terminal. In a checkout, `./play` is `playground` in the project's own environment.

[Exit statuses and environment variables](configuration.md) are on a page of their own.

"""


def commands() -> Iterator[tuple[str, Any]]:
    """Yield every command with its whole name, groups before what is in them."""
    yield from _walk("playground", command_line())


def _walk(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    yield name, command
    for child, result in getattr(command, "commands", {}).items():
        if not result.hidden:
            yield from _walk(f"{name} {child}", result)


def page() -> str:
    """Return the page of all commands."""
    return _HEAD + "".join(_section(name, command) for name, command in commands())


def _section(name: str, command: Any) -> str:
    level = 2 if name.count(" ") < 2 else 3
    about, _, examples = (command.help or "").partition("\b\nExamples:\n")
    params = [p for p in command.params if not getattr(p, "hidden", False)]
    arguments = [p for p in params if p.param_type_name == "argument"]
    options = [p for p in params if p.param_type_name == "option"]
    parts = [f"{'#' * level} {name}\n\n"]
    parts += [escaped(paragraph) + "\n\n" for paragraph in about.split("\n\n") if paragraph.strip()]
    parts.append(fenced(_usage(name, command, arguments), "text"))
    parts.append(table(("Argument", "Meaning"), [(code(a.metavar or a.name), _help(a)) for a in arguments]))
    parts.append(table(("Option", "Value", "Meaning"), [_row(option) for option in options]))
    parts.append(fenced(re.sub(r"^  ", "", examples, flags=re.MULTILINE), "sh") if examples else "")
    return "".join(parts)


def _usage(name: str, command: Any, arguments: list[Any]) -> str:
    words = [name, "[OPTIONS]"]
    for argument in arguments:
        shown = (argument.metavar or argument.name.upper()).strip("[]{}")
        words.append(shown if argument.required else f"[{shown}]")
    if getattr(command, "commands", None):
        words.append("COMMAND")
    return " ".join(words)


def _row(option: Any) -> tuple[str, str, str]:
    names = [*option.opts, *option.secondary_opts]
    takes = "" if option.is_flag else (option.metavar or option.name.upper())
    return ", ".join(code(name) for name in names), code(takes), _help(option)


def _help(parameter: Any) -> str:
    text = escaped(getattr(parameter, "help", "") or "")
    default = getattr(parameter, "show_default", False) and parameter.default
    if default and not callable(default) and not isinstance(default, bool):
        text += f" Default: {code(str(default))}."
    return text.strip()
