"""Say which files have changed, whichever way an editor saves them, and have a session read them.

Folders are watched, not files, because a file that is renamed over or created again is
another file; a change counts only if the contents differ. Twice a second the thread
also looks for itself, so that a folder that vanished and came back is found again, and
a file system that reports no changes is followed all the same.
"""

from __future__ import annotations

import contextlib
import hashlib
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from watchfiles import watch

from playground.allowed_files import Signature, signature
from playground.files import NotRegularError, open_regular
from playground.studio.session import Session

STEP, DEBOUNCE = 5, 50  # [ms] quiet after which a batch is reported; longest batch
LOOK_EVERY = 500  # [ms]
_GRACE = 0.08  # [s] a deleted file may take to come back: editors delete and create
_JUST = 0.05  # [s] how far a file's times may lag behind the clock


class Watcher:
    """Watches a set of files in a thread of its own, once started.

    ``wake`` is called from that thread whenever there is something to ``take``.
    ``also`` are endings of files that are reported although they are not followed, where
    they lie next to one that is followed.
    """

    def __init__(self, wake: Callable[[], None] = lambda: None, also: Iterable[str] = ()) -> None:
        self._wake = wake
        self._also = tuple(also)
        self._lock = threading.Lock()
        self._followed: dict[Path, tuple[Signature | None, bytes]] = {}  # signature and hash when last seen
        self._real: dict[Path, Path] = {}  # where what is followed lies, links followed: asking costs much
        self._others: dict[Path, bytes] = {}  # hashes of what is not followed, once reported
        self._changed: dict[Path, bytes | None] = {}  # with the hash last taken, where that is known
        self._stop = threading.Event()
        self._again = threading.Event()  # set to have the folders read again
        self._thread: threading.Thread | None = None

    def __enter__(self) -> Watcher:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Begin to watch."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="watcher", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """Stop watching, and wait until the thread has ended."""
        self._stop.set()
        self._again.set()
        if self._thread is not None:
            self._thread.join(5.0)
            self._thread = None

    def follow(
        self,
        files: Iterable[Path],
        *,
        read_at: float | None = None,
        read: Mapping[Path, Signature | None] | None = None,
    ) -> None:
        """Follow these files, and no others.

        ``read_at`` is when they were read [s since the epoch], and ``read`` says what was there
        then. A file new to the set that changed after that is reported at once, and so is any
        whose reader saw what was never reported: so no save falls in between.
        """
        files_followed = set(files)
        read = read or {}
        with self._lock:
            folders = _folders(self._real) if files_followed != self._followed.keys() else None
            for path in self._followed.keys() - files_followed:
                del self._followed[path], self._real[path]
            for path in files_followed - self._followed.keys():
                now = signature(path)
                self._real[path] = path.resolve()
                self._followed[path] = (now, _hash(path))
                if read_at is not None and now is not None and now.latest / 1e9 > read_at - _JUST:
                    self._changed[path] = None
            for path in files_followed & read.keys():
                if read[path] == self._followed[path][0]:
                    continue
                now = signature(path)
                self._followed[path] = (now, _hash(path))
                if now != read[path] or (now is not None and now.latest / 1e9 > time.time() - _JUST):
                    self._changed[path] = None
            notify = bool(self._changed)
            if folders is not None and _folders(self._real) != folders:
                self._again.set()
        if notify:
            self._wake()

    def take(self) -> set[Path]:
        """Return the files that changed since the last call.

        One that changed and changed back, as a file does that is truncated and written
        again with the same text, is not among them.
        """
        with self._lock:
            changed, self._changed = self._changed, {}
            return {path for path, taken in changed.items() if taken is None or self._seen(path) != taken}

    def _seen(self, path: Path) -> bytes:
        """Return the hash of what was last seen of a file; empty when nothing was."""
        return self._followed[path][1] if path in self._followed else self._others.get(path, b"")

    def _run(self) -> None:
        while not self._stop.is_set():
            self._again.clear()
            with self._lock:
                folders = _folders(self._real)
            identities = _identities(folders)
            self._look()
            if not identities:
                self._again.wait(LOOK_EVERY / 1000)
                continue
            with contextlib.suppress(OSError, RuntimeError):  # a folder that vanishes just now
                self._watch(folders, identities)

    def _watch(self, folders: frozenset[Path], identities: dict[Path, int]) -> None:
        """Report changes until the folders to watch are no longer the same."""
        batches = watch(
            *identities,
            step=STEP,
            debounce=DEBOUNCE,
            rust_timeout=LOOK_EVERY,
            yield_on_timeout=True,
            stop_event=self._again,
            recursive=False,
            raise_interrupt=False,
            ignore_permission_denied=True,
            watch_filter=None,
        )
        for batch in batches:
            self._look({Path(path) for _, path in batch} or None)
            if self._stop.is_set() or _identities(folders) != identities:
                return

    def _look(self, paths: set[Path] | None = None) -> None:
        """Compare files with what was last seen of them: ``paths``, or all whose signature differs."""
        with self._lock:
            followed, real = dict(self._followed), dict(self._real)
        if paths is None:
            paths = {path for path, (before, _) in followed.items() if signature(path) != before}
        else:
            paths |= {path for path, where in real.items() if where in paths}
        if any(not path.exists() for path in paths if path in followed):
            self._stop.wait(_GRACE)
        seen = {path: (signature(path), _hash(path)) for path in paths if self._matters(path, followed)}
        notify = False
        with self._lock:
            for path, (now, digest) in seen.items():
                before = self._seen(path)
                if path in self._followed:
                    self._followed[path] = (now, digest)
                else:
                    self._others[path] = digest
                if digest != before:
                    self._changed.setdefault(path, before)
                    notify = True
        if notify:
            self._wake()

    def _matters(self, path: Path, followed: dict[Path, tuple[Signature | None, bytes]]) -> bool:
        return path in followed or path.suffix in self._also


def _folders(files: Mapping[Path, Path]) -> frozenset[Path]:
    """Return the folders to watch: those of the files, and of what links point at."""
    return frozenset(path.parent for pair in files.items() for path in pair)


def _identities(folders: Iterable[Path]) -> dict[Path, int]:
    """Return the inode of each folder that is there."""
    identities = {}
    for folder in folders:
        with contextlib.suppress(OSError):
            identities[folder] = folder.stat().st_ino
    return identities


def _hash(path: Path) -> bytes:
    """Return a hash of a file's contents, or what is there in its place; empty when it cannot be read."""
    for _ in range(3):
        try:
            with open_regular(path) as handle:
                return hashlib.file_digest(handle, "blake2b").digest()
        except FileNotFoundError:
            return b""
        except NotRegularError as error:
            return error.strerror.encode()
        except OSError:  # another program holds it just now (Windows)
            time.sleep(0.02)
    return b""


class Follower:
    """A session, and the watcher that follows its files; ``tell`` hears of those that others saved."""

    def __init__(
        self, session: Session, watcher: Watcher, tell: Callable[[set[Path]], None] = lambda changed: None
    ) -> None:
        self.session = session
        self.watcher = watcher
        self.tell = tell
        self._followed: tuple[object, ...] = ()  # what decided which files are watched

    def take(self, own: Iterable[Path] = ()) -> bool:
        """Have the session read its files again if any was saved by others; say whether it did.

        ``own`` are files that this process writes itself and shows already.
        """
        changed = self.watcher.take() - set(own)
        if changed:
            self.tell(changed)
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
