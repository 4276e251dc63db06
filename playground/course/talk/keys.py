"""The keys of a presentation: one table, which its help shows as well. A clicker sends some of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from imgui_bundle import imgui

from playground.course.talk.presenter import Presenter
from playground.live.text_field import letters

_K = imgui.Key


class Keyed(Protocol):
    """What keys act on: a ``Stage``."""

    presenter: Presenter

    def quit(self) -> None:
        """Quit the program."""

    def enter(self) -> None:
        """Go to the beat whose number was typed."""

    def type(self, digit: str) -> None:
        """Take a digit."""

    def slide(self, by: float) -> None:
        """Move a slider."""

    def toggle_laser(self) -> None:
        """Show a spot at the mouse, or no longer."""

    def toggle_pen(self) -> None:
        """Take the pen, or put it down."""

    def toggle_full(self) -> None:
        """Fill the screen, or no longer."""

    def toggle_help(self) -> None:
        """Show the keys, or no longer."""

    def say_address(self) -> None:
        """Show where the notes are."""


@dataclass(frozen=True)
class PresentKey:
    """Keys that do one thing, and what that is in each language."""

    keys: tuple[imgui.Key, ...]
    name: tuple[str, str] | str  # in both languages; one text where they are the same
    meaning: tuple[str, str]  # English, French
    act: Callable[[Keyed], None]
    typed: str = ""  # letters that do it too, wherever the keyboard has them
    repeats: bool = False


KEYS: tuple[PresentKey, ...] = (
    PresentKey(
        (_K.right_arrow, _K.space, _K.page_down),
        ("→  Space  PgDn  click", "→  Espace  PgSuiv  clic"),
        ("next", "suivant"),
        lambda stage: stage.presenter.next(),
    ),
    PresentKey(
        (_K.left_arrow, _K.page_up, _K.backspace),
        ("←  PgUp  Backspace", "←  PgPréc  Retour arrière"),
        ("back", "précédent"),
        lambda stage: stage.presenter.back(),
    ),
    PresentKey((_K.home,), ("Home", "Début"), ("first", "premier"), lambda stage: stage.presenter.go(0)),
    PresentKey(
        (_K.end,),
        ("End", "Fin"),
        ("last", "dernier"),
        lambda stage: stage.presenter.go(len(stage.presenter.beats)),
    ),
    PresentKey(
        (_K.enter, _K.keypad_enter),
        ("number, Enter", "numéro, Entrée"),
        ("go to that one", "aller à ce numéro"),
        lambda stage: stage.enter(),
    ),
    PresentKey(
        (_K.b, _K.period),
        ".  B",
        ("black screen", "écran noir"),
        lambda stage: stage.presenter.cover("black"),
        typed=".",
    ),
    PresentKey((_K.w,), "W", ("white screen", "écran blanc"), lambda stage: stage.presenter.cover("white")),
    PresentKey(
        (_K.up_arrow,),
        ("1–9, then ↑ ↓ or wheel", "1–9, puis ↑ ↓ ou molette"),
        ("choose a slider, move it", "choisir un curseur, le déplacer"),
        lambda stage: stage.slide(1.0),
        repeats=True,
    ),
    PresentKey((_K.down_arrow,), "", ("", ""), lambda stage: stage.slide(-1.0), repeats=True),
    PresentKey((_K.p,), "P", ("spot at the mouse", "point lumineux"), lambda stage: stage.toggle_laser()),
    PresentKey((_K.d,), "D", ("draw with the mouse", "dessiner à la souris"), lambda s: s.toggle_pen()),
    PresentKey((_K.e,), "E", ("erase", "effacer"), lambda stage: stage.presenter.erase()),
    PresentKey((_K.n,), "N", ("address of the notes", "adresse des notes"), lambda s: s.say_address()),
    PresentKey((_K.f, _K.f11), "F", ("full screen", "plein écran"), lambda stage: stage.toggle_full()),
    PresentKey((_K.h,), "?  H", ("these keys", "ces touches"), lambda stage: stage.toggle_help(), typed="?"),
    PresentKey(
        (_K.escape,), ("Esc", "Échap"), ("leave the presentation", "quitter la présentation"),
        lambda stage: stage.presenter.escape(),
    ),
)  # fmt: skip


def help_rows(language: str) -> tuple[tuple[str, str], ...]:
    """Return the keys and their meanings, in a language."""
    which = 1 if language == "fr" else 0
    rows = ((key.name if isinstance(key.name, str) else key.name[which], key) for key in KEYS)
    return tuple((name, key.meaning[which]) for name, key in rows if name)


def act_on_presentation_keys(stage: Keyed) -> None:
    """Act on the keys pressed since the last frame."""
    io = imgui.get_io()
    if (io.key_ctrl or io.key_super) and imgui.is_key_pressed(_K.q, repeat=False):
        stage.quit()
        return
    if io.key_ctrl or io.key_alt or io.key_super:
        return
    typed = letters()
    for digit in filter(str.isdecimal, typed):
        stage.type(digit)
    for key in KEYS:
        pressed = any(imgui.is_key_pressed(key_code, repeat=key.repeats) for key_code in key.keys)
        if pressed or (key.typed and key.typed in typed):
            key.act(stage)
            if not stage.presenter.on:
                return
