"""Generate the reference of the Python API: every public name, in groups."""

from __future__ import annotations

import playground

_GROUPS = {
    "Open and draw": ("headless", "render", "load", "parameters"),
    "Values": ("Sketch", "Camera", "Parameter", "Shot", "Engine", "Frame"),
    "Files": ("export", "write_large", "render_video", "render_sequence", "render_sweep"),
    "Research": ("sweep",),
    "What ships": ("shipped_sketches", "shipped_techniques"),
}
_HEAD = """# Python API

`import playground` opens nothing: each name is imported when it is first used.
A sketch is a frozen value; to set a parameter gives a new one. Arrays have row 0 in the south.

"""


def groups() -> dict[str, list[str]]:
    """Return every public name of the package by group; errors and warnings are a group of their own."""
    named = {name for names in _GROUPS.values() for name in names}
    names = {title: list(names) for title, names in _GROUPS.items()}
    rest = [name for name in playground.__all__ if name not in named and name != "__version__"]
    kinds = [n for n in rest if isinstance(getattr(playground, n), type)]
    names["Errors and warnings"] = [n for n in kinds if issubclass(getattr(playground, n), Exception)]
    names["More"] = [n for n in rest if n not in names["Errors and warnings"]]
    return {title: names for title, names in names.items() if names}


def page() -> str:
    """Return the page that mkdocstrings fills."""
    parts = [_HEAD]
    for title, names in groups().items():
        parts.append(f"## {title}\n\n")
        parts += [f"::: playground.{name}\n\n" for name in names]
    parts.append("`playground.__version__` is the version, as text.\n")
    return "".join(parts)
