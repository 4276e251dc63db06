"""The mouse as other tools' shaders know it: where it is, and Shadertoy's four numbers of a press."""

from __future__ import annotations

from types import SimpleNamespace

from playground.studio.session import Session


def test_a_press_has_four_numbers_whose_signs_are_its_state():
    runner = SimpleNamespace(hover=(0.0, 0.0), drag=(0.0, 0.0, 0.0, 0.0))
    session = SimpleNamespace(engine=SimpleNamespace(runner=runner), sketch=None)

    def after(x: float, y: float, *, pressed: bool = False, clicked: bool = False) -> tuple[float, ...]:
        Session.hover(session, (x, y), pressed=pressed, clicked=clicked)
        assert runner.hover == (x, y)
        return runner.drag

    assert after(3.0, 4.0) == (0.0, 0.0, 0.0, 0.0), "it only hovers"
    assert after(5.0, 6.0, pressed=True, clicked=True) == (5.0, 6.0, 5.0, 6.0), "pressed in this frame"
    assert after(7.0, 8.0, pressed=True) == (7.0, 8.0, 5.0, -6.0), "and dragged"
    assert after(9.0, 9.0) == (7.0, 8.0, -5.0, -6.0), "released: where it was last"
    assert after(1.0, 2.0, pressed=True, clicked=True) == (1.0, 2.0, 1.0, 2.0), "pressed again"
