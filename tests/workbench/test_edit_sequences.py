"""Random sequences of saves, choices, edits and undo, with checks that pass and fail: none is lost."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from playground.workbench.reload_stages import ReloadStage

from .checked_desk import BAD, ELEVATION, GOOD, LEVEL, Desk

TECHNIQUES = ("./hills", "./dunes", "generation/white_noise")


class Player:
    """Does one random thing after another, and knows what was chosen last."""

    def __init__(self, desk: Desk, seed: int) -> None:
        self.desk, self.random, self.done = desk, random.Random(seed), list[str]()
        self.size, self.technique, self.elevation = 9, TECHNIQUES[0], "a.npy"
        self.acts: list[Callable[[], object]] = [
            *(self.save, self.choose, self.choose_file, self.edit, self.desk.frame, self.preset),
            *(desk.drafts.reload, self.unset, desk.bench.undo.undo, desk.bench.undo.redo),
            *(self.pass_check, self.fail_check),
        ]

    def play(self, count: int) -> None:
        for _ in range(count):
            act = self.random.choice(self.acts)
            act()
            self.desk.bench.undo.record()
            self.done.append(act.__name__)

    def save(self) -> None:
        before, self.size = self.size, self.random.choice((9, 17, 33))
        self.desk.save(f"size = {before}\n", f"size = {self.size}\n")

    def choose(self) -> None:
        self.technique = self.random.choice(TECHNIQUES)
        self.desk.drafts.choose("height", self.technique)

    def choose_file(self) -> None:
        self.elevation = self.random.choice(("a.npy", "b.npy"))
        self.desk.drafts.set(ELEVATION, self.desk.file(self.elevation))

    def edit(self) -> None:
        self.desk.drafts.set(LEVEL, self.random.random())

    def preset(self) -> None:
        self.desk.bench.commands.set_all("Preset", {LEVEL: 0.5})

    def unset(self) -> None:
        self.desk.drafts.unset(LEVEL)

    def pass_check(self) -> None:
        self.desk.answer(GOOD)

    def fail_check(self) -> None:
        self.desk.answer(BAD)

    def settle(self) -> None:
        """Let every check pass until nothing is coming."""
        for _ in range(4):
            self.pass_check()
        assert self.desk.drafts.stage is ReloadStage.NONE and self.desk.session.error is None, self.done


@pytest.mark.parametrize("seed", range(24))
def test_what_was_chosen_last_is_shown_and_all_of_it_can_be_undone(desk: Desk, seed: int) -> None:
    player, undo = Player(desk, seed), desk.bench.undo
    player.play(player.random.choice((3, 6, 12)))
    desk.drafts.reload()
    player.settle()
    assert desk.size == player.size, player.done
    if not {"undo", "redo", "fail_check"} & set(player.done):
        assert (desk.technique, desk.elevation) == (player.technique, player.elevation), player.done
    while undo.history.can_undo:
        left = undo.history.done - 1
        undo.undo()
        player.settle()
        assert undo.history.done == left, player.done
    assert (desk.technique, desk.elevation, desk.size) == ("./hills", "a.npy", player.size), player.done
