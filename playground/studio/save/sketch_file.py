"""Write into the sketch's file; where it is read-only, offer a copy instead."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from playground.errors import PlaygroundError
from playground.paths import shown
from playground.sketch.model import Keyframe
from playground.sketch.save import ReadOnlySketch
from playground.studio.keyframes.saved_keyframes import save_keyframes
from playground.studio.notices import Notices
from playground.studio.session import Session


@dataclass
class SketchFile:
    """The file of one session's sketch."""

    session: Session
    notices: Notices
    offer: str = ""  # why the sketch cannot be saved: a copy is offered
    asks: bool = False  # the offer is still to be shown

    def write(self, act: Callable[[], None]) -> bool:
        """Write, and read the sketch again; return whether that worked. Else offer a copy or say why."""
        drafts = self.session.drafts
        if drafts.opening:  # what is read again is the other
            name, other = shown(drafts.shown_path), shown(drafts.path)
            ways = f"open {name} again, or save a copy"
            self.notices.say(f"{name} is not saved while {other} is being opened: {ways}")
            return False
        try:
            act()
        except ReadOnlySketch as error:
            self.offer, self.asks = f"{str(error).rpartition(': ')[2].capitalize()}.", True
        except PlaygroundError as error:
            self.notices.say(str(error))
        else:
            drafts.reload()
            return True
        return False

    def write_keyframes(self, keyframes: Sequence[Keyframe]) -> bool:
        """Write keyframes into the file; return whether that worked."""
        draft = self.session.shown
        return draft is not None and self.write(lambda: save_keyframes(draft.file, keyframes))
