"""Shaders of a page are notified of the pointer what the window tells them: see ``Session.hover``."""

from __future__ import annotations

import random
from types import SimpleNamespace
from typing import Any

import pytest

from playground.studio.session import Session

from ...cases import each
from .node import Node

SIZE = (200, 100)  # [pixels] of the picture
BOX = {"left": 10, "bottom": 70, "width": 100, "height": 50}  # [CSS pixels] of the element
FOLLOWED = """async (box, size, playing, turns, load) => {
  const { followPointer } = await load("steering.js"), element = new EventTarget();
  element.getBoundingClientRect = () => box;
  const clock = performance.now;
  let changes = 0, now = 10_000;
  performance.now = () => now;
  const pointer = followPointer(element, () => { changes++; });
  const told = turns.map(({ events, after = 100 }) => {
    changes = 0;
    now += after;
    for (const [type, clientX, clientY, pointerId = 1, button = 0] of events)
      element.dispatchEvent(Object.assign(new Event(type), { clientX, clientY, pointerId, button }));
    const live = pointer.live(size, playing);
    return { ...live, changes, again: pointer.drawn() };
  });
  performance.now = clock;
  return told;
}"""


def followed(node: Node, *turns: Any, playing: bool = False) -> list[dict[str, Any]]:
    """Return what each picture is told, after its events; a turn may say the ms since the one before."""
    said = [turn if isinstance(turn, dict) else {"events": turn} for turn in turns]
    values = node.run(FOLLOWED, BOX, SIZE, playing, said)
    assert isinstance(values, list)
    return values


def test_the_pointer_is_told_as_in_a_window(node: Node):
    chance, down, turns, expected = random.Random(7), False, [], []
    runner = SimpleNamespace(hover=(0.0, 0.0), drag=(0.0, 0.0, 0.0, 0.0))
    window: Any = SimpleNamespace(engine=SimpleNamespace(runner=runner), sketch=None)
    position = (0.0, 0.0)
    for _ in range(60):
        event = chance.choice(["pointermove", "pointerup" if down else "pointerdown", ""])
        if event:
            x, y = chance.randint(10, 110), chance.randint(20, 70)
            position = (2.0 * (x - 10), 2.0 * (70 - y))
            turns.append([(event, x, y)])
        else:
            turns.append([])
        held = down  # where it lets go, it has been moved before
        down = event == "pointerdown" or (down and event != "pointerup")
        if held and event == "pointerup":
            Session.hover(window, position, pressed=True, clicked=False)
        Session.hover(window, position, pressed=down, clicked=event == "pointerdown")
        expected.append((runner.hover, runner.drag))
    for message, (hover, drag) in zip(followed(node, *turns), expected, strict=True):
        assert message["hover"] == pytest.approx(hover)
        assert message.get("drag", [0.0] * 4) == pytest.approx(drag)


def test_a_press_is_new_for_one_picture_which_asks_for_another(node: Node):
    """Also one that was let go of before any picture saw it."""
    for events in ([("pointerdown", 60, 45)], [("pointerdown", 60, 45), ("pointerup", 60, 45)]):
        first, second, third = followed(node, events, [], [])
        held = len(events) == 1
        assert first["drag"] == [100, 50, 100, 50] and first["again"]
        assert second["drag"] == [100, 50, 100 if held else -100, -50] and not second["again"]
        assert third["drag"] == second["drag"]
        assert first["mouse"] == [100, 50, 100, 50]


def test_a_pointer_that_was_never_pressed_hovers_only(node: Node):
    [message] = followed(node, [("pointermove", 35, 70)])
    assert message["hover"] == [50, 0] and message["changes"] == 1
    assert "drag" not in message and "mouse" not in message


@each("other", [("pointerdown", 20, 30, 2), ("pointermove", 20, 30, 2), ("pointerup", 20, 30, 2)])
def test_a_second_finger_changes_nothing(node: Node, other: tuple[Any, ...]):
    pressed, message = followed(node, [("pointerdown", 60, 45)], [other])
    assert message["changes"] == 0
    assert message["drag"] == [*pressed["drag"][:3], -50] and message["hover"] == pressed["hover"]


def test_the_right_button_presses_nothing(node: Node):
    [message] = followed(node, [("pointerdown", 60, 45, 1, 2)])
    assert message["changes"] == 0 and "drag" not in message


def test_frame_delta_is_sent_while_playing_except_after_pauses(node: Node):
    turns = [{"events": [], "after": after} for after in (5000, 20, 50, 3000, 10)]
    message = [value.get("delta") for value in followed(node, *turns, playing=True)]
    assert message == [None, pytest.approx(0.02), pytest.approx(0.05), None, pytest.approx(0.01)]
    assert all("delta" not in value for value in followed(node, *turns))


@each(("usual", "reads"), [([["iMouse", "drag"]], True), ([["t", "time"], ["m", "hover_share"]], True),
                       ([["iTime", "time"]], False), (None, False)])  # fmt: skip
def test_what_reads_the_pointer(node: Node, usual: list[list[str]] | None, reads: bool):
    kernels = [{}, {"usual": usual} if usual else {}]
    assert node.call("steering.js", "readsPointer", {"kernels": kernels}) is reads


def test_the_date_is_local_and_its_seconds_those_of_the_day(node: Node):
    script = """async (load) => (await load("steering.js")).dateOf(new Date(2026, 1, 28, 13, 5, 6, 250))"""
    assert node.run(script) == [2026, 1, 28, 13 * 3600 + 5 * 60 + 6.25]
