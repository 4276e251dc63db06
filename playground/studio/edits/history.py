"""Undo and redo: what each step changed, from what to what.

Edits need not be reported to it. It gets the state at the end of every frame and
keeps what differs from the frame before, so that all that can be set can be undone. A
step holds only the things that it changed: undoing it leaves all else alone, also
after the files have been reloaded in between.

What changes while a mouse button is held is one step, and so is what goes on changing
in the same way within a moment, as the wheel does. A reload is no step: what it takes
away, it says. Saving moves values into the file: for the steps before it, "as the file
says" then means what the file set before.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Protocol, cast

from playground.sketch.model import Camera, Value
from playground.studio.edits.edits import Edits
from playground.studio.language import counted, numeral, tr

MOMENT = 0.7
"""[s] within which a change of the same things belongs to the step before."""
MAX_ENTRIES = 200
"""Steps that are stored; the oldest go first."""

TEXT = "text"

Key = tuple[str, str]
"""What can change: ("value", path), ("technique", pass), ("channel", path), ("lock", path), ("step", path),
("camera", ""), ("text", path of a file) or ("time", "")."""
CHECKED = ("technique", "channel")
"""The kinds that are shown only once they have proved good."""
State = Mapping[Key, object]
"""What is set, by what it is; what is as the file says is not in it."""


@dataclass(frozen=True)
class TextChange:
    """What a step makes of a file, for one way; None: there is no such file."""

    of: bytes | None
    to: bytes | None


@dataclass(frozen=True)
class Step:
    """What one action changed."""

    before: State  # of each thing that changed; None: as in the file
    after: State
    name: str = ""  # in words, where one was given
    at: float = 0.0  # [s] when it last went on


def state_of(edits: Edits, steps: Mapping[str, int]) -> dict[Key, object]:
    """Return everything that is edited."""
    state: dict[Key, object] = {("value", path): value for path, value in edits.values}
    state |= {("technique", name): use for name, use in edits.techniques}
    state |= {("channel", path): source for path, source in edits.channels}
    state |= {("lock", path): True for path in edits.locked}
    state |= {("step", path): step for path, step in steps.items()}
    if edits.camera is not None:
        state["camera", ""] = edits.camera
    return state


def edits_of(state: State) -> Edits:
    """Return the edits that a state holds."""
    return Edits(
        tuple((path, cast(Value, value)) for (kind, path), value in state.items() if kind == "value"),
        tuple((name, cast(str, use)) for (kind, name), use in state.items() if kind == "technique"),
        cast("Camera | None", state.get(("camera", ""))),
        tuple(path for (kind, path), _ in state.items() if kind == "lock"),
        tuple((path, cast(str, source)) for (kind, path), source in state.items() if kind == "channel"),
    )


def steps_of(state: State) -> dict[str, int]:
    """Return the repeats that a state stops early."""
    return {path: cast(int, step) for (kind, path), step in state.items() if kind == "step"}


class Typed(Protocol):
    """A text that is typed, with steps of its own."""

    def time(self, by: int) -> float | None:
        """Return when what is undone (-1) or redone (1) next was typed; None for nothing.

        What the window wrote itself has the time of what was typed before; it is redone last.
        """

    def go(self, by: int) -> None:
        """Undo (-1) or redo (1) what was typed last."""


class History:
    """The steps so far, oldest first, and how many of them are done."""

    def __init__(self, most: int = MAX_ENTRIES) -> None:
        self.steps: list[Step] = []
        self.done = 0  # the first so many are; the others can be done again
        self._most = most
        self._latest: object = None  # edits and steps of the last ``look``, compared first
        self._state: dict[Key, object] | None = None
        self._of = 0  # how often the files had been read
        self._due: dict[Key, object] = {}  # what an undo has requested and is not there yet
        self._open = False  # the last step goes on while the button is held
        self._name = ""

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return self.done > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to do again."""
        return self.done < len(self.steps)

    def time(self, by: int) -> float | None:
        """Return when the step went on last that is undone (-1) or redone (1) next; None for no step."""
        at = self.done if by > 0 else self.done - 1
        return self.steps[at].at if 0 <= at < len(self.steps) else None

    def call(self, name: str) -> None:
        """Give the next change a name, for one that its parts would not explain."""
        self._name = name

    def look(
        self,
        edits: Edits,
        steps: Mapping[str, int],
        of: int,
        *,
        held: bool,
        now: float,
        read: State | None = None,
        is_idle: bool = False,
    ) -> None:
        """Take in the state at the end of a frame.

        ``of`` counts how often the files were read: another number is a reload, which alone changed
        ``read`` of the edits; all that differs where that is not known. ``held``: a mouse button is
        down. ``now``: seconds of any clock. ``is_idle``: nothing is being checked, so that an undo which
        has not come by now never will: it is no longer done.
        """
        if self._open and not held:
            self._close()
        latest = edits, tuple(steps.items())
        before, self._state = self._state, self._state if latest == self._latest else state_of(edits, steps)
        assert self._state is not None
        self._latest = latest
        if before is not None and of != self._of:
            before = state_of(edits, steps) if read is None else applied(before, read)
        self._of = of
        if before is None:
            return
        changed = {key for key in {*before, *self._state} if before.get(key) != self._state.get(key)}
        for key in list(changed):
            if key in self._due and self._due[key] == self._state.get(key):
                del self._due[key]
                changed.discard(key)
        if is_idle and self._due:
            missed = {key: value for key, value in self._due.items() if self._state.get(key) != value}
            self._due = {}
            if any(kind in CHECKED for kind, _ in missed):
                before = {**before, **missed}
                changed |= missed.keys()
        if changed:
            after = {key: self._state.get(key) for key in changed}
            self._add({key: before.get(key) for key in changed}, after, held=held, now=now)

    def jump(self, before: float, after: float, *, held: bool, now: float) -> None:
        """Take in that time was set, from one moment [s] to another."""
        self._add({("time", ""): before}, {("time", ""): after}, held=held, now=now)

    def record(self, before: State, after: State, name: str, *, now: float) -> None:
        """Take in a step that is more than what is edited; ``settle`` takes in the state after it.

        It is a step of its own, however soon after another.
        """
        self._close()
        self._name = name
        self._add(before, after, held=False, now=now, joins=False)

    def go(self, by: int, apply: Callable[[State], bool]) -> bool:
        """Undo (-1) or redo (1) a step: ``apply`` sets what it changed, None for what the file says.

        A text comes as a ``TextChange``. Where there is no step, or ``apply`` returns False, nothing is
        done, and False is returned.
        """
        if not (self.can_redo if by > 0 else self.can_undo):
            return False
        step = self.steps[self.done if by > 0 else self.done - 1]
        values, others = (step.after, step.before) if by > 0 else (step.before, step.after)
        texts = {
            key: TextChange(cast("bytes | None", others[key]), cast("bytes | None", value))
            for key, value in values.items()
            if key[0] == TEXT
        }
        if not apply({**values, **texts}):
            return False
        self.done, self._open = self.done + by, False
        left_out = (TEXT, "time")
        self._due |= {key: value for key, value in values.items() if key[0] not in left_out}
        return True

    def saved(self, before: State) -> None:
        """Take in that these are in the file from now on, and what the file set before."""
        self.steps = [
            replace(step, before=_filled(step.before, before), after=_filled(step.after, before))
            for step in self.steps
        ]

    def settle(self, edits: Edits, steps: Mapping[str, int]) -> None:
        """Take in a state that an undo has made: it is no step, nor is what is still to come of it."""
        self._latest, self._state = (edits, tuple(steps.items())), state_of(edits, steps)
        there = self._state
        self._due = {key: value for key, value in self._due.items() if there.get(key) != value}

    def _close(self) -> None:
        """End the step that went on while a button was held; one that came back to where it began is none."""
        self._open = False
        if self.done == len(self.steps) and self.steps and not self.steps[-1].after:
            del self.steps[-1]
            self.done -= 1

    def _add(self, before: State, after: State, *, held: bool, now: float, joins: bool = True) -> None:
        name, self._name = self._name, ""
        last = self.steps[self.done - 1] if self.done else None
        again = (
            joins
            and last is not None
            and self.done == len(self.steps)
            and last.name == name
            and (self._open or (before.keys() == last.before.keys() and now - last.at < MOMENT))
        )
        if again and last is not None:
            first, latest = {**before, **last.before}, {**last.after, **after}
            moved = [key for key in first if first[key] != latest[key]]
            self.steps[-1] = Step({k: first[k] for k in moved}, {k: latest[k] for k in moved}, name, now)
        else:
            self.steps = [*self.steps[: self.done], Step(before, after, name, now)][-self._most :]
        self.done, self._open = len(self.steps), True
        if not held:
            self._close()


def changes_between(before: Edits, after: Edits) -> tuple[dict[Key, object], dict[Key, object]]:
    """Return what two edits say of each thing that differs."""
    old, new = state_of(before, {}), state_of(after, {})
    changed = [key for key in {*old, *new} if old.get(key) != new.get(key)]
    return {key: old.get(key) for key in changed}, {key: new.get(key) for key in changed}


def applied(state: State, changes: State) -> dict[Key, object]:
    """Return a state with changes made to it; None takes a thing out."""
    state_now = {**state, **changes}
    return {key: value for key, value in state_now.items() if value is not None}


def step_label(step: Step, name_of: Callable[[str], str], write: Callable[[str, object], str]) -> str:
    """Return a step's name.

    ``name_of`` gives a parameter's label from its path, ``write`` its value as text.
    """
    if step.name:
        return step.name
    kinds = {kind for kind, _ in step.after}
    if "channel" in kinds:  # what else changed belongs to what feeds it
        fed = next((path, source) for (kind, path), source in step.after.items() if kind == "channel")
        return tr(
            "{path}: {value}",
            path=fed[0],
            value=fed[1] if fed[1] is not None else tr("what the file feeds it"),
        )
    if len(step.after) != 1:
        return counted(len(step.after), "parameter" if kinds == {"value"} else "thing")
    ((kind, path), after), before = next(iter(step.after.items())), next(iter(step.before.values()))
    if kind == "camera":
        return tr("Camera") if after is not None else tr("Camera back to the file's")
    if kind == "time":
        return tr("Time {before} to {after}", before=_seconds(before), after=_seconds(after))
    if kind == "technique":
        value = after if after is not None else tr("the file's technique")
        return tr("{path}: {value}", path=path, value=value)
    if kind == "lock":
        template = tr("Lock {name}") if after else tr("Unlock {name}")
        return template.format(name=name_of(path))
    if kind == "step":
        value = tr("step {number}", number=after) if after is not None else tr("all steps")
        return tr("{path}: {value}", path=path, value=value)
    return tr(
        "{name}: {before} to {after}",
        name=name_of(path),
        before=write(path, before),
        after=write(path, after),
    )


def _filled(state: State, before: State) -> State:
    return {key: before.get(key) if value is None else value for key, value in state.items()}


def _seconds(value: object) -> str:
    return f"{numeral(value, '.2f')} s" if isinstance(value, float) else "0 s"
