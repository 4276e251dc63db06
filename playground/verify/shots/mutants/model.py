"""What a mutant is: a name, what a person would have broken, and how it is broken."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
"""A picture, (height, width, 4), top row first, sRGB and alpha."""


class DoesNotApply(Exception):
    """A mutant breaks something that a sketch does not have; the message says what."""


@dataclass(frozen=True)
class Edit:
    """A change of one text."""

    file: str  # in ``glsl/``, or "./x.glsl" in the sketch's folder
    find: str  # occurs there exactly once
    put: str


@dataclass(frozen=True, kw_only=True)
class Rendering:
    """A mutant that the engine draws: something is broken in the sketch."""

    name: str
    broke: str  # one message
    edits: tuple[Edit, ...] = ()
    values: tuple[tuple[str, object], ...] = ()  # parameter path → value
    plus: tuple[tuple[str, object], ...] = ()  # path of a parameter or "camera.…" → what is added
    times: tuple[tuple[str, float], ...] = ()  # likewise → what it is multiplied with
    wires: tuple[tuple[str, str], ...] = ()  # path of an input → the pass that it is wired to
    samples: int | None = None
    later: float = 0.0  # [s] it is drawn so much later
    steps: int = 0  # added to the iterations of what repeats
    shot: str = ""  # the shot that shows it, if the sketch has one of that name

    kind = "rendering"
    exempt = False


@dataclass(frozen=True)
class Finished:
    """A mutant that is made of the finished picture: something is broken on its way out."""

    name: str
    broke: str  # one message
    change: Callable[[Picture], Picture]
    exempt: bool = False  # it is no defect: the same build must let it pass

    kind = "picture"
    later = 0.0
    shot = ""


Mutant = Rendering | Finished
