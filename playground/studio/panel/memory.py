"""What the panel remembers between two frames: what is searched for, typed, open."""

from __future__ import annotations

from dataclasses import dataclass, field

from playground.sketch.model import Value
from playground.studio.panel.parameter_list import Filter, Listing


@dataclass
class Memory:
    """The state of one panel between frames."""

    listing: Listing = field(default_factory=Listing)
    filter: Filter = field(default_factory=Filter)
    focus_search: bool = False  # the search gets the keys in the next frame
    entry: str = ""  # the label of the parameter whose value is typed
    entry_text: str = ""
    entry_opens: bool = False  # its field is to get the keys
    clicked: tuple[str, bool, Value] = (
        "",
        False,
        0,
    )  # last clicked on: path, edited, value before
    menu: str = ""  # the label of the parameter whose menu is open
    menu_opens: bool = False
    heights: dict[tuple[str, float], float] = field(default_factory=dict)  # of each row, by path and scale
    seed: int = 1  # of the next random values
    strength: float = 0.1  # of a mutation
    everything: bool = False  # random values are for every parameter, not the shape's alone
    preset: str = ""  # the one last chosen
    preset_name: str = ""  # of one to be saved
