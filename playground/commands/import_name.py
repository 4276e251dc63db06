"""Say so where another package is imported as ``playground``, or has overwritten parts of this one.

A name to import is nobody's own: two distributions with a module ``playground`` in one environment
write into one folder, and what the last one wrote is what there is.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from playground.errors import PlaygroundError, counted
from playground.extras import DISTRIBUTION, reinstall_command

NAME = "playground"
_OF_OURS = "_HOMES"  # a name in our own __init__.py, which another package's has not


def check_package() -> None:
    """Raise ``PlaygroundError`` where ``import playground`` gives another package.

    One look at a module that is loaded: what is installed is read only where something is wrong.
    """
    package = import_module(NAME)
    if not hasattr(package, _OF_OURS):
        raise PlaygroundError(_sentence(package, other_owners()))


def other_owners() -> list[str]:
    """Return the installed distributions, but this one, that have a module ``playground``."""
    from importlib.metadata import packages_distributions

    return sorted(set(packages_distributions().get(NAME, [])) - {DISTRIBUTION})


def repair(others: list[str]) -> str:
    """Return the commands that leave this distribution alone in the environment."""
    again = reinstall_command()
    return f"python -m pip uninstall {' '.join(others)}, then {again}" if others else again


def explained(others: list[str]) -> str:
    """Return what it means that others have a module of this name, and what to do."""
    verb = "has" if len(others) == 1 else "have"
    count = counted(len(others), "other package")
    return f"{count} here, {', '.join(others)}, {verb} a module '{NAME}' too: {repair(others)}"


def _sentence(package: ModuleType, others: list[str]) -> str:
    location = getattr(package, "__file__", None) or ", ".join(package.__path__)
    owner = f" but to {' and '.join(others)}" if others else ""
    return f"'import {NAME}' gives {location}, which belongs not to {DISTRIBUTION}{owner}: {repair(others)}"
