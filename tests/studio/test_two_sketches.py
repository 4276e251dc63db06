"""Random sequences of edits, checks and openings of two sketches: each keeps what was set in it."""

from __future__ import annotations

import pytest

from .session_desk import LEVEL, Harness, RandomPlayer

SHOWN, OTHER = "one", "two"


class Player(RandomPlayer):
    """Does one random thing after another, and knows what was set last in each sketch."""

    def __init__(self, harness: Harness, seed: int) -> None:
        super().__init__(harness, seed)
        self.level = dict.fromkeys((SHOWN, OTHER), 0.25)
        self.steps: dict[str, dict[str, int]] = {SHOWN: {}, OTHER: {}}
        self.opened = SHOWN
        self.acts = [
            *(self.edit, self.edit, self.stop, self.choose, self.open_one, self.open_two),
            *(self.pass_check, self.pass_check, self.fail_check, harness.frame, harness.drafts.reload),
        ]

    def edit(self) -> None:
        self.level[self.harness.name] = level = self.random.random()
        self.harness.drafts.set(LEVEL, level)

    def stop(self) -> None:
        self.steps[self.harness.name] = {"height": (step := self.random.choice((1, 2)))}
        self.harness.session.stop_at("height", step)

    def choose(self) -> None:
        self.harness.drafts.choose("height", self.random.choice(("./hills", "./dunes")))

    def open_one(self) -> None:
        self.open(SHOWN)

    def open_two(self) -> None:
        self.open(OTHER)

    def open(self, name: str) -> None:
        self.harness.bench.commands.open(self.harness.folder / name)
        self.opened = name

    def check(self) -> None:
        """Compare what is shown with what was set in it last."""
        name = self.harness.name
        result = self.harness.level, dict(self.harness.session.view.steps)
        assert result == (pytest.approx(self.level[name]), self.steps[name]), self.done

    def close(self) -> None:
        """Close the window; open one on each sketch, and compare it with what was set."""
        self.harness.close()
        for name in (SHOWN, OTHER):
            self.harness.start(name)
            self.harness.frame()
            self.check()
            self.harness.close()


@pytest.mark.parametrize("seed", range(24))
def test_each_of_two_sketches_keeps_what_was_set_in_it(harness: Harness, seed: int) -> None:
    player = Player(harness, seed)
    player.play(player.random.choice((4, 8, 14)))
    harness.drafts.reload()
    for _ in range(4):
        player.pass_check()
    assert harness.session.error is None and harness.name == player.opened, player.done
    player.check()
    player.close()


@pytest.mark.parametrize("seed", range(24))
def test_window_closed_at_any_moment_remembers_both_sketches(harness: Harness, seed: int) -> None:
    player = Player(harness, seed)
    player.play(player.random.choice((2, 5, 9)))
    harness.frame()
    player.close()
