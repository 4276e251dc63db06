"""What has changed in a session since the last look: values, time, saves, errors, the sketch itself."""

from __future__ import annotations

from typing import Any

from playground.sketch.model import Value
from playground.studio.bench import Workbench
from playground.studio.remote.described import errors_of, plain
from playground.studio.remote.items import items_of, values_of

_JUMP = 0.5  # [s] that time may differ from what its speed makes of it before that is news


class Changes:
    """Looks at a session after each frame; the first look finds nothing new."""

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self.values: dict[str, Value] = {}  # as they were at the last look, by path
        self.changed: dict[str, Value] = {}  # those that were otherwise at the look before
        self._base: object = None
        self._of: object = None
        self._clock: tuple[bool, float] | None = None
        self._time = 0.0
        self._at = 0.0
        self._reload: object = None
        self._errors: object = None
        self.started = False  # whether there was a look before the last
        self._looked = False

    def look(self) -> list[dict[str, Any]]:
        """Return what is new, as events for JSON; ``changed`` has the new values."""
        events = [*self._sketch_or_values(), *self._time_events(), *self._saves()]
        self.started, self._looked = self._looked, True
        return events if self.started else []

    def _sketch_or_values(self) -> list[dict[str, Any]]:
        session = self._bench.session
        draft, self.changed = session.shown, {}
        if draft is None or draft is self._of:
            return []
        self._of = draft
        values = values_of(session)
        assert values is not None
        is_new, self._base = draft.base is not self._base, draft.base
        before, self.values = self.values, dict(values.of)
        self.changed = {path: value for path, value in self.values.items() if before.get(path) != value}
        events: list[dict[str, Any]] = []
        if is_new:
            events.append({"event": "sketch", "sketch": session.drafts.shown_path.name})
        if self.changed:
            items = items_of(session)
            made = {path: plain(items[path].parameter, value) for path, value in self.changed.items()}
            events.append({"event": "values", "values": made})
        return events

    def _time_events(self) -> list[dict[str, Any]]:
        clock, now = self._bench.session.clock, self._bench.notices.now()
        expected = self._time + ((now - self._at) * clock.speed if clock.playing else 0.0)
        state = clock.playing, clock.speed
        jumped = clock.loop is None and self._bench.session.animated and abs(clock.time - expected) > _JUMP
        changed = state != self._clock or jumped or (not clock.playing and clock.time != self._time)
        self._clock, self._time, self._at = state, clock.time, now
        if not changed:
            return []
        return [{"event": "time", "time": clock.time, "playing": clock.playing, "speed": clock.speed}]

    def _saves(self) -> list[dict[str, Any]]:
        latest, errors = self._bench.session.last_reload, self._bench.problems.errors
        events: list[dict[str, Any]] = []
        if latest is not self._reload and latest is not None:
            events.append({"event": "reloaded", "milliseconds": round(latest.seconds * 1e3, 1)})
        if errors != self._errors:
            events.append({"event": "errors", "errors": errors_of(self._bench.problems)})
        self._reload, self._errors = latest, errors
        return events
