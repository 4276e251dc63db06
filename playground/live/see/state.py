"""What is shown beside the picture: what keys and buttons switch, without a screen."""

from __future__ import annotations

from dataclasses import dataclass, field

from playground.live.see.inspector import Inspector
from playground.live.session import Session


@dataclass
class See:
    """What one session shows of itself."""

    session: Session
    inspector: Inspector = field(init=False)

    def __post_init__(self) -> None:
        self.inspector = Inspector(self.session)

    def release(self) -> None:
        """Give back what was made in the engine's context; it is made again where it is needed."""
        self.inspector.release()
