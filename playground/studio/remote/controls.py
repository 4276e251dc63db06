"""Do to a session what a remote asks: set values, time and presets, undo, take the picture.

Values are checked as ``--set`` checks them, with the same messages. What is set is collected, the
last of each parameter, and done at once by ``flush``: a stream of values costs a frame no more
than one of each. The window's history takes it in as it takes in what the panel sets, so each
change can be undone.

Requests of other threads are handed to the thread that draws, and done between two frames. What a session
shows, its parameters, its state and what has changed since the last look, is described as plain data for
JSON.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from pathlib import Path, PureWindowsPath
from typing import Any

from playground.engine.frame import Frame
from playground.errors import ContextError, ParameterError, PlaygroundError, SketchError, nearest
from playground.shader.parameter import expected, shortest, spell, write
from playground.sketch.assign import (
    Shown,
    check_value,
    described,
    find_targets,
    range_of,
    value_of,
    values_of,
)
from playground.sketch.model import Parameter, Sketch, Value
from playground.studio.bench import Workbench
from playground.studio.edits.edits import Draft, leaves
from playground.studio.panel.parameter_list import Item, Values, items_of, shown_values
from playground.studio.problems.problems import Problems
from playground.studio.session import Session

# ── calls of other threads ────────────────────────────────────────────────────


MAX_WAITING = 1024
"""Requests that may wait."""
BUDGET = 0.008
"""[s] that a frame spends on requests; one that takes longer is done alone."""


class Busy(PlaygroundError):
    """More is asked than the window can do."""


class Calls:
    """A queue of functions that the drawing thread runs; ``wake`` ends its sleep."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self.wake = wake
        self._lock = threading.Lock()
        self._waiting: deque[tuple[Callable[[], Any], Future[Any]]] = deque()
        self._closed = False

    def __len__(self) -> int:
        return len(self._waiting)

    def ask(self, function: Callable[[], Any]) -> Future[Any]:
        """Have a function run between two frames; return its answer to come. For any thread.

        Raises ``Busy`` where too many wait, or the window is closed.
        """
        future: Future[Any] = Future()
        with self._lock:
            if self._closed:
                raise Busy("the window is closed")
            if len(self._waiting) >= MAX_WAITING:
                raise Busy(f"more than {MAX_WAITING} requests wait for the window")
            first = not self._waiting
            self._waiting.append((function, future))
        if first:
            self.wake()
        return future

    def run(self, budget: float = BUDGET) -> bool:
        """Run what waits, for about ``budget`` [s]; return whether anything ran. For the drawing thread."""
        end, count = time.perf_counter() + budget, 0
        while self._waiting and (not count or time.perf_counter() < end):
            count += 1
            with self._lock:
                function, future = self._waiting.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(function())
            except BaseException as error:
                future.set_exception(error)
                if not isinstance(error, Exception):
                    raise
        return bool(count)

    def close(self) -> None:
        """Take no more requests, and refuse those that wait."""
        with self._lock:
            self._closed = True
            waiting, self._waiting = self._waiting, deque()
        for _, future in waiting:
            if future.set_running_or_notify_cancel():
                future.set_exception(Busy("the window is closed"))


# ── descriptions ──────────────────────────────────────────────────────────────


def parameters_of(session: Session) -> list[dict[str, Any]]:
    """Return every parameter with its value, range, unit and group, in the panel's order."""
    draft = session.shown
    values = shown_values(draft) if draft is not None else None
    return [_described(item, values) for item in items_of(draft).values()] if values is not None else []


def plain(parameter: Parameter, value: Value) -> Any:
    """Return a value for JSON: a menu's choice by its name, a colour as ``#rrggbb`` where that is exact."""
    if parameter.widget.kind in ("menu", "colour"):
        text = write(parameter, value)
        if parameter.widget.kind == "menu" or text.startswith("#"):
            return text
    shortest_value = shortest(value)
    return list(shortest_value) if isinstance(shortest_value, tuple) else shortest_value


def state_of(bench: Workbench) -> dict[str, Any]:
    """Return what is shown, its time, its presets and what is wrong with it."""
    session, clock = bench.session, bench.session.clock
    sketch = session.sketch
    return {
        "sketch": session.drafts.shown_path.name,
        "title": sketch.title if sketch is not None else "",
        "time": clock.time,
        "playing": clock.playing,
        "speed": clock.speed,
        "moves": session.animated,
        "presets": [preset.name for preset in sketch.presets] if sketch is not None else [],
        "can_undo": bench.undo.can_undo,
        "can_redo": bench.undo.can_redo,
        "errors": errors_of(bench.problems),
    }


def errors_of(problems: Problems) -> list[dict[str, Any]]:
    """Return what is wrong with the files just now, each with its place."""
    return [
        {"file": d.file, "line": d.line, "column": d.column, "message": d.message} for d in problems.errors
    ]


def _described(item: Item, values: Values) -> dict[str, Any]:
    parameter = item.parameter
    value, ends = values.of[item.path], range_of(parameter)
    return described(Shown(item.path, parameter, item.exported)) | {
        "label": item.title,
        "value": plain(parameter, value),
        "text": write(parameter, value),
        "default": plain(parameter, parameter.default),
        "file": plain(parameter, values.in_file[item.path]),
        "low": ends[0] if ends else None,
        "high": ends[1] if ends else None,
        "takes": expected(parameter),
        "changed": item.path in values.changed,
        "locked": item.path in values.locked,
        "raw": parameter.widget.raw,
    }


# ── changes ───────────────────────────────────────────────────────────────────


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
        values = shown_values(draft)
        is_new, self._base = draft.base is not self._base, draft.base
        before, self.values = self.values, dict(values.of)
        self.changed = {path: value for path, value in self.values.items() if before.get(path) != value}
        events: list[dict[str, Any]] = []
        if is_new:
            events.append({"event": "sketch", "sketch": session.drafts.shown_path.name})
        if self.changed:
            items = items_of(draft)
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


# ── controls ──────────────────────────────────────────────────────────────────


MAX_REMOTE_SIDE = 4096
"""Pixels that a side of a picture for a remote may have."""
MAX_SPEED = 100.0
"""Seconds of the sketch in a second that a remote may ask for, forward or back."""
_MAX_TIME = 1e9  # [s] that time may be set to


class PictureNotReady(SketchError):
    """The window computes the frames before its picture: to draw that at once would hold it up."""


class Controls:
    """What a remote may do to one session."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.session = bench.session
        self._waiting: dict[str, Value] = {}  # checked, and not done yet
        self._acts: dict[str, Callable[[Any], None]] = {
            "set": self.set,
            "reset": self.reset,
            "time": self.seek,
            "playing": self.play,
            "speed": self.speed,
            "preset": self.preset,
            "undo": lambda _: self.undo(),
            "redo": lambda _: self.redo(),
        }

    @property
    def names(self) -> list[str]:
        """What ``do`` takes."""
        return list(self._acts)

    def do(self, wishes: Mapping[str, Any]) -> None:
        """Do what is asked by name: ``{"set": {"light.sun": [135, 25]}, "playing": false}``.

        In the order of ``names``; what comes before one that is refused has been done. Raises
        ``ParameterError`` for an unknown name, and as the single ones do.
        """
        for name in wishes:
            if name not in self._acts:
                raise ParameterError(f"no remote command '{name}'{nearest(name, self._acts)}")
        for name, act in self._acts.items():
            if name in wishes:
                act(wishes[name])

    # ── values ───────────────────────────────────────────────────────────────

    def set(self, values: object) -> None:
        """Set parameters by path, all or none; raise ``ParameterError`` as ``--set`` does.

        Also for one that is locked in the window, and for a file outside the sketch's folder.
        """
        draft = self._shown()
        if not isinstance(values, Mapping):
            raise ParameterError(f"set = {spell(values)}: expected values by path, as light.sun: [135, 25]")
        values_checked = {path: _checked(draft, path, value) for path, value in values.items()}
        for path, value in self.session.without_buttons(values_checked).items():
            self._waiting.pop(path, None)  # what is set last comes last, and wins
            self._waiting[path] = value

    def value(self, path: str) -> Value:
        """Return what a parameter is set to, or will be by ``flush``; raise ``ParameterError``."""
        if path in self._waiting:
            return self._waiting[path]
        sketch = self._shown().sketch
        return value_of(sketch, path, values_of(sketch))

    def flush(self) -> None:
        """Do what was set."""
        waiting, self._waiting = self._waiting, {}
        if waiting:
            self.session.drafts.set_all(waiting)

    def reset(self, paths: object) -> None:
        """Reset parameters to the file's values: one path, or a list of them."""
        draft = self._shown()
        paths_reset = [paths] if isinstance(paths, str) else paths
        if not isinstance(paths_reset, list | tuple):
            raise ParameterError(f"reset = {spell(paths)}: expected a parameter's path, or a list of them")
        for path in paths_reset:
            check_free(draft, existing(draft.sketch, str(path)))
        self.flush()
        self.session.drafts.unset(*map(str, paths_reset))

    def preset(self, name: object) -> None:
        """Set a preset's values as one step; raise ``ParameterError`` where there is none of that name."""
        sketch = self._shown().sketch
        names = [preset.name for preset in sketch.presets]
        if name not in names:
            near = nearest(str(name), names) or "; this sketch has none"
            raise ParameterError(f"no preset {spell(name)}{near}")
        self.flush()
        self.bench.actions.apply_preset(str(name))

    def undo(self) -> None:
        """Undo the last step of the window's history."""
        self.flush()
        self.bench.undo.undo()

    def redo(self) -> None:
        """Redo the step that was undone last."""
        self.flush()
        self.bench.undo.redo()

    # ── time ─────────────────────────────────────────────────────────────────

    def seek(self, seconds: object) -> None:
        """Go to a moment [s], 0 or later."""
        self.bench.undo.seek(number_of("time", seconds, 0.0, _MAX_TIME))

    def play(self, playing: object) -> None:
        """Let time run, or pause it."""
        if not isinstance(playing, bool):
            raise ParameterError(f"playing = {spell(playing)}: expected true or false")
        self.session.clock.playing = playing

    def speed(self, speed: object) -> None:
        """Set how many seconds of the sketch pass in a second."""
        self.session.clock.speed = number_of("speed", speed, -MAX_SPEED, MAX_SPEED)

    # ── what there is ────────────────────────────────────────────────────────

    def parameters(self) -> list[dict[str, Any]]:
        """Return every parameter with its value, range, unit and group."""
        self.flush()
        return parameters_of(self.session)

    def state(self) -> dict[str, Any]:
        """Return what is shown, its time, its presets and its errors."""
        self.flush()
        self.bench.undo.record(held=self.bench.undo.held)
        return state_of(self.bench)

    def picture(self, size: tuple[int, int] | None = None) -> Frame:
        """Return the picture: the window's own, or drawn at another size [pixels].

        Raises ``SketchError`` before the first, ``ParameterError`` for a size that is too large, and
        ``PictureNotReady`` while frames before it are computed: ask again.
        """
        self.flush()
        session, sketch = self.session, self.session.sketch
        if session.catch_up.behind is not None:
            done, total = session.catch_up.behind
            source = session.catch_up.source
            what = (
                f"makes {source}, {done:,} of {total:,}"
                if source
                else f"computes frame {done:,} of {total:,}"
            )
            raise PictureNotReady(f"there is no picture yet: the window {what}")
        if size is None or sketch is None:
            frame = session.read()
            if frame is None:
                raise SketchError("there is no picture yet")
            return frame
        if not all(1 <= side <= MAX_REMOTE_SIDE for side in size):
            raise ParameterError(
                f"size = {size[0]}x{size[1]}: expected width and height, 1 to {MAX_REMOTE_SIDE} pixels"
            )
        if session.awaits_data:
            raise SketchError("a file that the sketch reads has changed and is being checked")
        view, now = session.view, session.clock.time
        try:
            return session.engine.render(
                view.map.of(sketch) if view.map is not None else sketch,
                size=size,
                time=now,
                steps=view.stops(sketch, now),
                interpolated=view.interpolated,
            )
        except PlaygroundError:
            raise
        except Exception as error:  # a driver raises what it likes
            raise ContextError(f"the picture cannot be drawn at {size[0]}x{size[1]}: {error}") from error

    def _shown(self) -> Draft:
        draft = self.session.shown
        if draft is None:
            raise SketchError(f"{self.session.path.name} is not shown yet")
        return draft


def existing(sketch: Sketch, path: str) -> str:
    """Return a parameter's path; raise ``ParameterError`` that names the nearest where there is none."""
    if not find_targets(sketch.graph, path):
        check_value(sketch, path, 0)  # one of the terrain's own, or an error
    return path


def check_free(draft: Draft, path: str) -> None:
    """Raise ``ParameterError`` for a parameter that is locked in the window."""
    locked = draft.edits.locked
    if locked and (path in locked or any(leaves(draft.base, path) & leaves(draft.base, p) for p in locked)):
        raise ParameterError(f"{path} is locked in the window, so only its own row there sets it")


def number_of(name: str, value: object, low: float, high: float) -> float:
    """Return a number between two bounds; raise ``ParameterError``."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not low <= value <= high:
        raise ParameterError(f"{name} = {spell(value)}: expected a number from {low:g} to {high:g}")
    return float(value)


def _checked(draft: Draft, path: str, raw: object) -> Value:
    value = check_value(draft.base, path, raw)
    check_free(draft, path)
    targets = find_targets(draft.base.graph, path)
    if targets and targets[0].parameter.widget.kind == "file":
        text = str(value)
        if Path(text).is_absolute() or PureWindowsPath(text).drive or ".." in PureWindowsPath(text).parts:
            raise ParameterError(f"{path} = {spell(text)}: expected a file of the sketch's own folder")
    return value
