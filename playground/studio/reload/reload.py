"""Keep a session and its files together: what is saved is read, and what it depends on is watched."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from playground.studio.reload.watcher import Watcher
from playground.studio.session import Session


class Follower:
    """A session, and the watcher that follows its files."""

    def __init__(self, session: Session, watcher: Watcher) -> None:
        self.session = session
        self.watcher = watcher
        self._followed: tuple[object, ...] = ()  # what decided which files are watched

    def take(self, own: Iterable[Path] = ()) -> bool:
        """Have the session read its files again if any was saved by others; say whether it did.

        ``own`` are files that this process writes itself and shows already.
        """
        changed = self.watcher.take() - set(own)
        changed_files = changed & self.session.drafts.files if changed else changed
        if not changed or not (self.session.error or changed_files):
            return False
        self.session.drafts.reload(changed_files)
        return True

    def follow(self) -> None:
        """Watch the files that the session depends on now."""
        session = self.session
        now = (session.shown, session.drafts.coming, session.error, session.drafts.places)
        before = self._followed
        if len(before) == len(now) and all(a is b for a, b in zip(now, before, strict=True)):
            return
        self._followed = now
        self.watcher.follow(session.drafts.files, read_at=session.drafts.read_at, read=session.drafts.places)
