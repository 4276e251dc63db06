"""Random sequences of saves, choices, edits and undo, with checks that pass and fail: none is lost."""

from __future__ import annotations

import pytest

from playground.workbench.reload_stages import ReloadStage

from .checked_desk import ELEVATION, LEVEL, Desk, RandomPlayer

TECHNIQUES = ("./hills", "./dunes", "generation/white_noise")


class Player(RandomPlayer):
    """Does one random thing after another, and knows what was chosen last."""

    def __init__(self, desk: Desk, seed: int) -> None:
        super().__init__(desk, seed)
        self.size, self.technique, self.elevation = 9, TECHNIQUES[0], "a.npy"
        self.acts = [
            *(self.save, self.choose, self.choose_file, self.edit, self.desk.frame, self.preset),
            *(desk.drafts.reload, self.unset, desk.bench.undo.undo, desk.bench.undo.redo),
            *(self.pass_check, self.fail_check),
        ]

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

    def settle(self) -> None:
        """Let every check pass until nothing is coming."""
        for _ in range(4):
            self.pass_check()
        assert self.desk.drafts.stage is ReloadStage.NONE and self.desk.session.error is None, self.done


@pytest.mark.parametrize("seed", range(12))
def test_what_was_chosen_last_is_shown_and_all_of_it_can_be_undone(desk: Desk, seed: int) -> None:
    check(desk, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12, 212))
def test_what_was_chosen_last_is_shown_and_all_of_it_can_be_undone_again_and_again(
    desk: Desk, seed: int
) -> None:
    check(desk, seed)


def check(desk: Desk, seed: int) -> None:
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
