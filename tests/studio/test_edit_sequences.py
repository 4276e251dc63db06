"""Random sequences of saves, choices, edits and undo, with checks that pass and fail: none is lost."""

from __future__ import annotations

import pytest

from playground.studio.reload.stages import ReloadStage

from .session_desk import ELEVATION, LEVEL, Harness, RandomPlayer

TECHNIQUES = ("./hills", "./dunes", "generation/white_noise")


class Player(RandomPlayer):
    """Does one random thing after another, and knows what was chosen last."""

    def __init__(self, harness: Harness, seed: int) -> None:
        super().__init__(harness, seed)
        self.size, self.technique, self.elevation = 9, TECHNIQUES[0], "a.npy"
        self.acts = [
            *(self.save, self.choose, self.choose_file, self.edit, self.harness.frame, self.preset),
            *(harness.drafts.reload, self.unset, harness.bench.undo.undo, harness.bench.undo.redo),
            *(self.pass_check, self.fail_check),
        ]

    def save(self) -> None:
        before, self.size = self.size, self.random.choice((9, 17, 33))
        self.harness.save(f"size = {before}\n", f"size = {self.size}\n")

    def choose(self) -> None:
        self.technique = self.random.choice(TECHNIQUES)
        self.harness.drafts.choose("height", self.technique)

    def choose_file(self) -> None:
        self.elevation = self.random.choice(("a.npy", "b.npy"))
        self.harness.drafts.set(ELEVATION, self.harness.file(self.elevation))

    def edit(self) -> None:
        self.harness.drafts.set(LEVEL, self.random.random())

    def preset(self) -> None:
        self.harness.bench.commands.set_all("Preset", {LEVEL: 0.5})

    def unset(self) -> None:
        self.harness.drafts.unset(LEVEL)

    def settle(self) -> None:
        """Let every check pass until nothing is coming."""
        for _ in range(4):
            self.pass_check()
        assert self.harness.drafts.stage is ReloadStage.NONE and self.harness.session.error is None, self.done


@pytest.mark.parametrize("seed", range(12))
def test_latest_choice_is_shown_and_all_edits_can_be_undone(harness: Harness, seed: int) -> None:
    check(harness, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12, 212))
def test_latest_choice_is_shown_and_edits_undone_for_many_seeds(harness: Harness, seed: int) -> None:
    check(harness, seed)


def check(harness: Harness, seed: int) -> None:
    player, undo = Player(harness, seed), harness.bench.undo
    player.play(player.random.choice((3, 6, 12)))
    harness.drafts.reload()
    player.settle()
    assert harness.size == player.size, player.done
    if not {"undo", "redo", "fail_check"} & set(player.done):
        assert (harness.technique, harness.elevation) == (player.technique, player.elevation), player.done
    while undo.history.can_undo:
        left = undo.history.done - 1
        undo.undo()
        player.settle()
        assert undo.history.done == left, player.done
    assert (harness.technique, harness.elevation, harness.size) == ("./hills", "a.npy", player.size), (
        player.done
    )
