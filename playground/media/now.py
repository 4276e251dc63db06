"""What a picture may depend on besides its sketch and its size: the time, and live inputs."""

from __future__ import annotations

from dataclasses import dataclass, field

from playground.media.live_inputs import LiveInputs


@dataclass(frozen=True)
class Now:
    """The moment that a picture shows."""

    time: float = 0.0  # [s]
    inputs: LiveInputs = field(default_factory=LiveInputs)
