"""A key of the window and its meaning: a row of the tables of keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from playground.studio.bench import Workbench


@dataclass(frozen=True)
class Key:
    """A key and its meaning."""

    key: imgui.Key
    name: str
    meaning: str
    act: Callable[[Workbench], None]
    ctrl: bool = False
    shift: bool = False
    sign: str = ""  # "+" or "-", with Ctrl: on the keypad, and wherever else the keyboard has it
    brief: str = ""  # in the panel's last line; empty: not there
    letter: str = ""  # what it types, for one that is elsewhere on every keyboard
    brush: bool = False  # only while the brush is taken
