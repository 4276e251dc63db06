"""Write what the window shows as JSON lines, for a test or another program that follows it.

Switched on by the environment variable ``PLAYGROUND_STATUS``, which names the file. A
line is added whenever one of its fields changes.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

from playground.engine.non_finite import NotFinite
from playground.studio.bench import Workbench
from playground.studio.code.open_files import unsaved
from playground.studio.code.panel import typing
from playground.studio.keys import open_layers
from playground.studio.overlay import PATIENCE
from playground.studio.session import Session

VARIABLE = "PLAYGROUND_STATUS"


def status_file() -> Path | None:
    """Return the file that the environment names; None where it names none."""
    return Path(os.environ[VARIABLE]) if os.environ.get(VARIABLE) else None


def add_line(path: Path, line: Mapping[str, object]) -> None:
    """Append a line of JSON."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


class Status:
    """Follows the session in the file of the environment; does nothing without one."""

    def __init__(self) -> None:
        self.path = status_file()
        self._last: dict[str, Any] = {}
        self._hashed = (-1, "")  # the draw that was hashed, and its hash

    def write(self, bench: Workbench, not_finite: Sequence[NotFinite] = ()) -> None:
        """Add a line if anything is new."""
        if self.path is None:
            return
        session = bench.session
        checking = session.drafts.checking or ("", 0.0)
        now = {
            "draws": session.draws,
            "picture": self._hash(bench.session),
            "error": str(session.error) if session.error else "",
            "stage": session.drafts.stage.name,
            "notices": [n.text for n in bench.notices.items],
            "playing": session.clock.playing,
            "typing": typing(bench.files),
            "takes_text": imgui.get_io().want_text_input,
            "unsaved": unsaved(bench.files.editing),
            "map": session.view.map.ref if session.view.map else "",
            "steps": dict(session.view.steps),
            "saved": str(bench.actions.saved_picture or ""),
            "reload_ms": round(session.last_reload.seconds * 1e3, 1) if session.last_reload else 0.0,
            "not_finite": [str(number) for number in not_finite],
            "runs": dict(session.engine.runs),
            "edited": dict(session.shown.edits.values) if session.shown else {},
            "trying": checking[0] if checking[1] >= PATIENCE else "",
            "layers": open_layers(bench),
            "trace": bench.tracing.status(),
            "versions": [version.name for version in bench.versions.items],
            "looked": bench.versions.is_looking,
        }
        for addition in bench.additions:
            now |= addition.status()
        if now != self._last:
            self._last = now
            add_line(self.path, now)

    def _hash(self, session: Session) -> str:
        draws = session.draws
        if self._hashed[0] != draws and session.catch_up.behind is None:  # to read it would run to the end
            frame = session.read()
            digest = hashlib.blake2b(frame.array.tobytes(), digest_size=8).hexdigest() if frame else ""
            self._hashed = (draws, digest)
        return self._hashed[1]
