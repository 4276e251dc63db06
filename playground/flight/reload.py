"""Follow saves in flight: read the sketch again, try it in a process of its own, hand over what is good.

What is wrong is stored as ``error``, and the last good sketch is flown over until it is fixed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType

from playground.allowed_files import Signature, noting_places
from playground.engine.sandbox import TrySketch
from playground.errors import PlaygroundError
from playground.sketch.load import load
from playground.sketch.model import Sketch
from playground.studio.reload.dependencies import watched
from playground.studio.reload.stages import Sandbox, explained, refusal
from playground.studio.reload.watcher import Watcher


class SaveFollower:
    """One sketch's; use it with ``with``.

    ``values`` are set over what its files say, ``shown`` is the sketch that is flown over,
    ``wake`` is called from another thread when something was saved.
    """

    def __init__(
        self,
        path: Path,
        shown: Sketch,
        values: Mapping[str, object],
        sandbox: Sandbox,
        driver: str,
        wake: Callable[[], None],
    ) -> None:
        self.error: PlaygroundError | None = None
        self._path = path
        self._shown = shown
        self._values = dict(values)
        self._sandbox = sandbox
        self._driver = driver
        self._checked: Sketch | None = None  # waits for the sandbox's answer
        self._watcher = Watcher(wake)
        self._places: Mapping[Path, Signature | None] = {}
        self._follow(time.time())

    def __enter__(self) -> SaveFollower:
        self._watcher.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._watcher.stop()

    @property
    def waits(self) -> bool:
        """Whether an answer of the sandbox is awaited."""
        return self._checked is not None

    def update(self) -> Sketch | None:
        """Take in what was saved; return a sketch that has proved good and is another than the one shown."""
        if self._watcher.take():
            self._read()
        if self._checked is None:
            return None
        report = self._sandbox.poll()
        if report is None:
            return None
        good, self._checked, self.error = self._checked, None, refusal(report)
        if self.error is not None:
            self._follow(time.time())
            return None
        self._shown = good
        return good

    def refuse(self, error: Exception) -> None:
        """Say that the sketch returned last cannot be flown over after all."""
        self.error = explained(error, self._path)

    def _read(self) -> None:
        read_at = time.time()
        self._checked = None
        try:
            with noting_places() as self._places:
                sketch = load(self._path).plainly(self._shown.plain).with_values(self._values)
        except Exception as error:
            self.error = explained(error, self._path)
        else:
            # One that was refused is tried again: what it depends on may have changed.
            if sketch == self._shown and self.error is None:
                return
            self._checked = sketch
            self._sandbox.submit(TrySketch(sketch, drivers=(self._driver,)))
        self._follow(read_at)

    def _follow(self, read_at: float) -> None:
        sketches = [sketch for sketch in (self._shown, self._checked) if sketch is not None]
        errors = [self.error] if self.error is not None else []
        files = watched(self._path, sketches, errors, self._places)
        self._watcher.follow(files, read_at=read_at, read=self._places)
