"""What is drawn of a sketch: its own view or a map of a texture, repeats stopped early, the frame's sides."""

from __future__ import annotations

from collections.abc import Mapping

from playground.engine.planner import repeats_of
from playground.errors import PlaygroundError
from playground.sketch.map_sketch import Map
from playground.sketch.model import DEFAULT_PICTURE, Sketch, Value


class View:
    """What one session draws; ``revision`` counts the changes."""

    def __init__(self) -> None:
        self.map: Map | None = None  # drawn instead of the sketch's own view
        self.last_ref = ""  # the texture of the map shown last
        self.steps: dict[str, int] = {}  # repeats that are stopped early, by path
        self.interpolated = True  # what a stopped repeat has not reached is filled
        self.framed_for = DEFAULT_PICTURE  # [pixels] the image whose sides stay visible in a narrower window
        self.revision = 0
        self._next: tuple[dict[str, int], Map | None] | None = None  # for a sketch that is being opened

    def restore(self, steps: Mapping[str, int], shown: Map | None, *, later: bool = False) -> None:
        """Stop repeats after so many steps, and show a map or, with None, the sketch's own view.

        ``later``: once the sketch that is being opened is drawn.
        """
        if later:
            self._next = dict(steps), shown
            return
        self.steps.clear()
        self.steps.update(steps)
        self.map = shown
        self.revision += 1

    def take_next(self) -> None:
        """Show what was restored for the sketch that is drawn now for the first time."""
        if self._next is not None:
            (steps, shown), self._next = self._next, None
            self.restore(steps, shown)

    def forget_next(self) -> None:
        """Forget what was restored for a sketch that is not opened after all."""
        self._next = None

    @property
    def state(self) -> tuple[dict[str, int], Map | None]:
        """What ``restore`` takes to draw the sketch that is open so again, drawn already or not."""
        return self._next if self._next is not None else (dict(self.steps), self.map)

    def show(self, shown: Map | None) -> None:
        """Show a map or, with None, the sketch's own view."""
        self.map = shown
        self.revision += 1

    def set_map(self, name: str, value: Value) -> None:
        """Set a parameter of the map."""
        if self.map is not None:
            self.show(self.map.with_value(name, value))

    def stop_at(self, path: str, step: int | None) -> None:
        """Stop a repeat after so many steps; with None it runs to its end again."""
        self.revision += 1
        self.steps.pop(path, None)
        if step is not None:
            self.steps[path] = step

    def interpolate(self, on: bool) -> None:
        """Fill what stopped repeats have not reached, where their headers say how, or show it as it is."""
        self.revision += 1
        self.interpolated = on

    def stops(self, sketch: Sketch, time: float, *, coming: bool = False) -> dict[str, int]:
        """Return where to stop: a repeat that is gone, or has fewer steps by now, is not stopped.

        ``coming``: in a sketch that is being opened, where there is one.
        """
        steps = self._next[0] if coming and self._next is not None else self.steps
        repeats = steps_of_repeats(sketch, time) if steps else {}
        return {path: step for path, step in steps.items() if step < repeats.get(path, 0)}


def steps_of_repeats(sketch: Sketch, time: float) -> dict[str, int]:
    """Return how many steps every repeated kernel and loop takes, by path; nothing where that is an error."""
    try:
        return repeats_of(sketch, time=time)
    except PlaygroundError:  # it is reported when the sketch is drawn
        return {}
