"""The rooms that can be removed, and the modules by which each adds to the rest.

Nothing else names such a room, but ``playground/__init__.py`` the functions of ``publish``. Without its
folder, its tests and its line here, all else works as before, but for the rooms that need it. Each part is a
module of a fixed name:

    commands    ``add_to(app)`` adds its commands to the command line; ``open_default(renderer)``, what runs
                without a command, where it can
    options     ``live_options`` reads the options that it adds to ``playground live``; ``LIVE_EXAMPLES``
    addition    ``open_addition(host)`` returns what it adds to a window; ``KEYS``, its keys;
                ``check_request(request)`` refuses a request before a window opens. It and the folder
                ``window`` may import the studio, whether the room needs it or not: nothing else imports them
    measures    ``MEASURES`` and ``ROWS``: what it adds to ``playground bench``
    french.toml  the words of its windows in French, by the English ones (``playground/studio/language.py``)
    table       ``DIALECTS`` reads shaders of other tools (``playground/shader/dialect.py``)
    site        ``PAGES``: the pages that it adds to the documentation, by path; ``HOMES``: files of the
                checkout that are pages there
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import NamedTuple


class Room(NamedTuple):
    """A room's modules of fixed names, and the rooms that it imports from."""

    parts: tuple[str, ...]
    needs: tuple[str, ...] = ()


ROOMS: dict[str, Room] = {
    "studio": Room(("commands", "measures")),
    "publish": Room(("commands", "addition")),
    "verify": Room(("commands",)),
    "course": Room(("commands", "options", "addition", "site"), needs=("studio", "publish")),
    "dialects": Room(("table",)),
    "flight": Room(("commands",), needs=("studio",)),
    "lsp": Room(("commands",), needs=("verify",)),
}


def modules(part: str) -> list[ModuleType]:
    """Import and return the modules of a name that rooms have, in the order of the rooms."""
    return [import_module(f"playground.{name}.{part}") for name, room in ROOMS.items() if part in room.parts]
