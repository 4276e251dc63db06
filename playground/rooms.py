"""The rooms that can be removed, and the modules by which each adds to the rest.

Nothing else names such a room: without its folder, its tests and its line here, all else works as before.

    commands    ``add_to(app)`` adds its commands to the command line
    options     ``live_options`` reads the options that it adds to ``playground live``; ``LIVE_EXAMPLES``
    addition    ``open_addition(host)`` returns what it adds to a window; ``KEYS``, its keys;
                ``check_request(request)`` refuses a request before a window opens
    table       ``DIALECTS`` reads shaders of other tools (``playground/shader/dialect.py``)
    site        ``PAGES``: the pages that it adds to the documentation, by path; ``HOMES``: files of the
                checkout that are pages there
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

ROOMS: dict[str, tuple[str, ...]] = {
    "course": ("commands", "options", "addition", "site"),
    "dialects": ("table",),
    "flight": ("commands",),
    "lsp": ("commands",),
}


def modules(part: str) -> list[ModuleType]:
    """Import and return the modules of a name that rooms have, in the order of the rooms."""
    return [import_module(f"playground.{room}.{part}") for room, parts in ROOMS.items() if part in parts]
