"""A session under any sequence of saves, mistakes, choices, edits, undo, restarts and lost contexts.

The oracle is a fresh load of the files with the edits that the model counts applied to it, drawn by an
engine of its own. Between the checks the edits that are shown are those of the model, after every action.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, seed, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.model import Camera, Sketch
from playground.sketch.replace_technique import with_technique
from playground.studio.edits.history import state_of
from playground.studio.reload.stages import ReloadStage

from ..loading import load
from ..spread import git
from .session_desk import BAD, ELEVATION, GOOD, LEVEL, SIZE, SKETCH, Harness

FILE_LEVEL = 0.25
TECHNIQUES = ("./hills", "./dunes", "generation/white_noise")
PRESET = {LEVEL: 0.5}
VALUE, FILE, TECHNIQUE, CAMERA = (
    ("value", LEVEL),
    ("value", ELEVATION),
    ("technique", "height"),
    ("camera", ""),
)
LOCK, STEP = ("lock", LEVEL), ("step", "height")
State = dict[tuple[str, str], Any]


def changes(before: State, after: State) -> dict[tuple[str, str], tuple[Any, Any]]:
    """Return what two states say of each thing that differs."""
    keys = [key for key in {*before, *after} if before.get(key) != after.get(key)]
    return {key: (before.get(key), after.get(key)) for key in keys}


def changed(state: State, values: State) -> State:
    """Return a state with values set; None resets one to the file's."""
    return {key: value for key, value in {**state, **values}.items() if value is not None}


@dataclass
class Model:
    """One sketch: what its file says, what is edited, and the steps that can be undone."""

    size: int = 9  # in the file
    level: float = FILE_LEVEL  # in the file
    drawn_level: float = FILE_LEVEL  # in the file as it was shown last
    state: State = field(default_factory=dict)
    recorded: State = field(default_factory=dict)  # the state of the frame before
    steps: list[dict[tuple[str, str], tuple[Any, Any]]] = field(default_factory=list)
    done: int = 0
    due: State = field(default_factory=dict)  # what an undo has requested and is not there yet

    def give_way(self) -> set[tuple[str, str]]:
        """Return the edits that a reading of the file takes away; one without its parameter waits."""
        return {VALUE} & set(self.state) if self.level != self.drawn_level and self.has_level else set()

    @property
    def has_level(self) -> bool:
        """Whether the technique that is shown has the value."""
        return self.state.get(TECHNIQUE) != "generation/white_noise"

    def record(self, is_idle: bool) -> None:
        """Take in the state at the end of a frame: what has changed is a step, unless an undo did it."""
        difference = changes(self.recorded, self.state)
        for key in [key for key in difference if key in self.due and self.due[key] == self.state.get(key)]:
            del self.due[key], difference[key]
        if is_idle:
            missed = {k: v for k, v in self.due.items() if self.state.get(k) != v and k == TECHNIQUE}
            difference |= {key: (value, self.state.get(key)) for key, value in missed.items()}
            self.due = {}
        if difference:
            self.steps[self.done :] = [difference]
            self.done += 1
        self.recorded = dict(self.state)

    def begin(self) -> None:
        """Begin without steps: the sketch was opened."""
        self.recorded, self.steps, self.done, self.due = dict(self.state), [], 0, {}


class SessionMachine(RuleBasedStateMachine):
    """Two sketches, a window on one of them, and a sandbox that answers when a rule says so."""

    ctx: moderngl.Context
    folder: Path

    def __init__(self) -> None:
        super().__init__()
        self.engines = [Engine(self.ctx)]  # its own: what one has cached needs no check
        set_level = 'use = "./hills"\nset = { level = 0.25 }\n'
        sketch = SKETCH.replace('use = "./hills"\n', set_level)
        self.harness = Harness(Path(tempfile.mkdtemp(dir=self.folder)), self.engines[0], sketch)
        self.models = {"one": Model(), "two": Model()}
        self.shown = self.opened = "one"
        self.pending: list[State] = []  # choices that are checked, in order
        self.gives_way: set[tuple[str, str]] = set()  # once what was saved is shown
        self.is_broken = False  # the sketch that is open
        self.is_lost = False

    # ── what is known ────────────────────────────────────────────────────────

    @property
    def model(self) -> Model:
        return self.models[self.shown]

    @property
    def is_opening(self) -> bool:
        return self.shown != self.opened

    @property
    def is_checking(self) -> bool:
        return self.harness.drafts.testing

    def frame(self) -> None:
        """Let a frame pass; a check that no driver needs to see ends in it."""
        waits = self.harness.drafts.stage is ReloadStage.DRAW
        self.harness.frame()
        if waits:
            self.passed()
        self.record()

    def record(self) -> None:
        self.model.record(self.harness.drafts.stage in (ReloadStage.NONE, ReloadStage.FAILED))

    def passed(self) -> None:
        """Take in that what was coming is shown."""
        if self.is_opening:
            self.shown = self.opened
            self.model.begin()
        model = self.model
        for key in self.gives_way:
            model.state.pop(key, None)
            model.recorded.pop(key, None)
        for choice in self.pending:
            model.state = changed(model.state, choice)
        if not self.is_broken:
            model.drawn_level = model.level
        self.pending, self.gives_way = [], set()

    def reloaded(self) -> None:
        """Take in that the files were read."""
        self.gives_way = set() if self.is_broken else self.models[self.opened].give_way()
        if self.is_opening:
            self.models[self.opened].begin()

    def file_technique(self) -> str:
        return self.harness.session.shown.file.graph.find("height").use  # type: ignore[union-attr]

    def edit_now(self, values: State) -> None:
        """Take in an edit that needs no check."""
        self.model.state = changed(self.model.state, values)
        for choice in self.pending:
            for key in values:
                choice.pop(key, None)
        if not self.is_opening:  # else what gives way is of the other sketch
            self.gives_way -= set(values)
        self.is_lost = False

    # ── files ────────────────────────────────────────────────────────────────

    def save(self, old: str, new: str) -> None:
        self.harness.save(old, new, f"{self.opened}/sketch.toml")
        self.reloaded()
        self.frame()

    @precondition(lambda self: not self.is_broken)
    @rule(size=st.sampled_from((9, 17, 33)))
    def save_size(self, size: int) -> None:
        model = self.models[self.opened]
        before, model.size = model.size, size
        self.save(f"size = {before}\n", f"size = {size}\n")

    @precondition(lambda self: not self.is_broken and LOCK not in self.models[self.opened].state)
    @rule(level=st.sampled_from((0.25, 0.5)))
    def save_level(self, level: float) -> None:
        """The file's word goes before what was set, unless that is set again."""
        model = self.models[self.opened]
        before, model.level = model.level, level
        self.save(f"level = {before}", f"level = {level}")

    @precondition(lambda self: not self.is_broken)
    @rule()
    def break_file(self) -> None:
        self.is_broken = True
        self.save("[view]", "[view")
        assert self.harness.session.error is not None

    @precondition(lambda self: self.is_broken)
    @rule()
    def fix_file(self) -> None:
        self.is_broken = False
        self.save("[view\n", "[view]\n")

    def read_again(self) -> None:
        self.harness.drafts.reload()
        self.reloaded()
        self.frame()

    # ── edits ────────────────────────────────────────────────────────────────

    @rule(level=st.sampled_from((0.125, 0.375, 0.625, 0.875)))
    def edit(self, level: float) -> None:
        self.set_level(level)
        self.frame()

    def set_level(self, level: float) -> None:
        """Set a value; a technique without such a parameter does not take it."""
        self.harness.drafts.set(LEVEL, level)
        if self.model.has_level:
            self.edit_now({VALUE: level})

    @rule(
        edit=st.sampled_from(("unset", "turn", "turn", "lock", "unlock", "preset", "stop", "stop")),
        number=st.integers(0, 2),
    )
    def edit_otherwise(self, edit: str, number: int) -> None:
        if edit == "turn":
            self.turn((None, 10.0, 80.0)[number])
        elif edit.endswith("lock"):
            self.lock(edit == "lock")
        elif edit == "stop":
            self.stop((1, 2, 9)[number])
        else:
            self.unset() if edit == "unset" else self.preset()

    def unset(self) -> None:
        self.harness.drafts.unset(LEVEL)
        self.edit_now({VALUE: None})
        self.frame()

    def turn(self, azimuth: float | None) -> None:
        camera = None if azimuth is None else Camera(azimuth=azimuth)
        self.harness.drafts.set_camera(camera)
        self.edit_now({CAMERA: camera})
        self.frame()

    def lock(self, locked: bool) -> None:
        if self.model.level != self.model.drawn_level:
            return  # what the file says next would be kept away
        self.harness.drafts.lock(LEVEL, locked)
        self.edit_now({LOCK: locked or None})
        self.frame()

    def preset(self) -> None:
        self.harness.bench.actions.set_all("Preset", PRESET)
        if self.model.has_level and LOCK not in self.model.state:
            self.edit_now({VALUE: PRESET[LEVEL]})
        self.frame()

    def stop(self, step: int) -> None:
        self.harness.session.stop_at("height", step)
        last = self.harness.session.repeats.get("height", 0)
        self.model.state = changed(self.model.state, {STEP: step if step < last else None})
        self.frame()

    @rule(use=st.sampled_from(TECHNIQUES), is_taken_back=st.booleans())
    def choose(self, use: str, is_taken_back: bool = False) -> None:
        before = self.model.state.get(TECHNIQUE, self.file_technique())
        self.choose_technique(use)
        if is_taken_back:
            self.choose_technique(before)

    @precondition(lambda self: not self.is_broken and not self.is_opening)
    @rule(order=st.permutations(("save", "technique", "data")), count=st.integers(2, 3))
    def meet(self, order: list[str], count: int) -> None:
        """Save and choose before anything of it is checked."""
        for what in order[:count]:
            if what == "save":
                self.save_size(17 if self.model.size == 9 else 9)
            elif what == "technique":
                self.choose_technique("./dunes")
            else:
                self.choose_file("b.npy")

    def choose_technique(self, use: str) -> None:
        self.harness.drafts.choose("height", use)
        self.propose({TECHNIQUE: None if use == self.file_technique() else use})
        self.frame()

    @precondition(lambda self: not self.is_opening)
    @rule(name=st.sampled_from(("a.npy", "b.npy")))
    def choose_file(self, name: str) -> None:
        path = str(self.harness.folder / self.shown / name)
        self.harness.drafts.set(ELEVATION, path)
        if self.harness.session.shown.edits.has(ELEVATION) and self.shown_state().get(FILE) == path:
            self.edit_now({FILE: path})
        else:
            self.propose({FILE: path})
        self.frame()

    def propose(self, values: State) -> bool:
        """Take in a change that is checked where it is new; return whether it is taken."""
        if all(self.model.state.get(key) == value for key, value in values.items()):
            self.edit_now(values)
            return True
        if self.is_opening:
            return False
        self.pending.append(dict(values))
        return True

    # ── undo ─────────────────────────────────────────────────────────────────

    @rule(by=st.sampled_from((-1, -1, 1)))
    def undo(self, by: int) -> None:
        model = self.model
        (self.harness.bench.undo.undo if by < 0 else self.harness.bench.undo.redo)()
        if 0 <= model.done + by <= len(model.steps):
            step = model.steps[model.done - 1 if by < 0 else model.done]
            values = {key: pair[0 if by < 0 else 1] for key, pair in step.items()}
            self.go(by, values)
        self.frame()

    def go(self, by: int, values: State) -> None:
        model = self.model
        stops = {key: value for key, value in values.items() if key == STEP}
        edits = {key: value for key, value in values.items() if key != STEP}
        needs_check = any(
            key in (TECHNIQUE, FILE) and self.shown_state().get(key) != value for key, value in edits.items()
        )
        if edits and needs_check:
            if not self.propose(edits):
                return
        elif edits:
            self.edit_now(edits)
        model.state = changed(model.state, stops)
        model.done += by
        model.due |= values
        model.recorded = dict(model.state)
        model.due = {key: value for key, value in model.due.items() if model.state.get(key) != value}

    # ── the sandbox, windows, contexts ───────────────────────────────────────

    @rule(level=st.sampled_from((None, None, 0.75)))
    def pass_check(self, level: float | None) -> None:
        """``level``: an edit in the very frame."""
        if not self.is_checking:
            self.frame()
            return
        if level is not None:
            self.set_level(level)
            self.record() if self.is_opening else None
        self.harness.answer(GOOD)
        self.passed()
        self.record()

    @rule()
    def fail_check(self) -> None:
        if not self.is_checking:
            self.frame()
            return
        chosen = [choice for choice in self.pending if {TECHNIQUE, FILE} & choice.keys()]
        if chosen:  # the latest that is not taken back
            self.pending = [choice for choice in self.pending if choice is not chosen[-1]]
        self.harness.answer(BAD)
        if self.harness.drafts.stage is ReloadStage.NONE:
            self.passed()  # the rest is drawn already: it needs no check
        self.record()

    @rule(name=st.sampled_from(("one", "two")), dropped=st.booleans())
    def open(self, name: str, dropped: bool) -> None:
        if self.is_broken:
            self.fix_file()
        path = self.harness.folder / name
        if dropped:
            self.harness.drops.take([path / "sketch.toml"])
        else:
            self.harness.bench.actions.open(path)
        self.opened = name
        if self.is_opening:
            self.pending = []
        self.reloaded()
        self.frame()

    @precondition(lambda self: not self.is_broken and not self.is_opening)
    @rule(level=st.sampled_from((None, 0.75)), how=st.sampled_from(("back", "restart", "close")))
    def visit_the_other(self, level: float | None, how: str) -> None:
        """``level``: an edit of the sketch that is left, in the frame in which the other is shown.

        ``how``: come back, after a restart, or as the window is closed before the other is shown.
        """
        left = self.shown
        self.open("two" if left == "one" else "one", how == "back")
        if how == "close":
            self.edit(level or 0.375)
        else:
            self.pass_check(level)
        if how == "back":
            self.open(left, True)
            self.pass_check(None)
        else:
            self.restart(left, False)

    @precondition(lambda self: not self.is_broken)
    @rule(name=st.sampled_from(("one", "two")), crashes=st.booleans())
    def restart(self, name: str, crashes: bool) -> None:
        (self.harness.crash if crashes else self.harness.close)()
        self.harness.start(name)
        self.shown = self.opened = name
        self.pending, self.gives_way = [], self.model.give_way()
        self.passed()
        self.model.begin()

    @precondition(lambda self: not self.is_lost)
    @rule()
    def lose_the_context(self) -> None:
        session = self.harness.session
        is_idle, before = self.harness.drafts.stage is ReloadStage.NONE, session.read()
        self.engines.append(Engine(self.ctx))
        session.rebuild(self.engines[-1])
        self.is_lost = True
        self.frame()
        after = session.read()
        if is_idle:
            np.testing.assert_array_equal(after.array, before.array)

    # ── truth ────────────────────────────────────────────────────────────────

    def shown_state(self) -> State:
        session = self.harness.session
        return state_of(session.shown.edits, session.view.steps)

    @invariant()
    def edits_are_those_of_the_model(self) -> None:
        assert self.harness.name == self.shown
        assert self.shown_state() == self.model.state
        history = self.harness.bench.undo.history
        assert (history.done, len(history.steps)) == (self.model.done, len(self.model.steps))

    @rule()
    def settle(self) -> None:
        """Let every check pass, and compare what is shown with a fresh load."""
        if self.is_broken:
            self.fix_file()
        self.read_again()
        for _ in range(4):
            if self.is_checking:
                self.pass_check(None)
            else:
                self.frame()
        session = self.harness.session
        assert session.error is None and self.harness.drafts.stage is ReloadStage.NONE
        assert self.shown == self.opened and session.sketch is not None
        expected = self.fresh()
        assert values_of(session.sketch) == values_of(expected)
        assert (session.sketch.terrain, session.sketch.camera) == (expected.terrain, expected.camera)
        stops = {path: step for (kind, path), step in self.model.state.items() if kind == "step"}
        frame = session.read()
        stops = {path: step for path, step in stops.items() if path in session.repeats}
        with Engine(self.ctx) as fresh:
            picture = fresh.render(expected, size=SIZE, steps=stops).array
        np.testing.assert_array_equal(frame.array[..., :3], picture[..., :3])
        self.edits_are_those_of_the_model()

    def fresh(self) -> Sketch:
        """Return the files with the edits of the model."""
        sketch, state = load(self.harness.folder / self.shown), self.model.state
        assert sketch.terrain.size == (self.model.size, self.model.size)
        if TECHNIQUE in state:
            sketch = with_technique(sketch, "height", state[TECHNIQUE])
        known = values_of(sketch)
        values = {path: value for (kind, path), value in state.items() if kind == "value" and path in known}
        sketch = sketch.with_values(values)
        return sketch.with_camera(state[CAMERA]) if CAMERA in state else sketch

    def teardown(self) -> None:
        try:
            if sys.exc_info()[0] is None:
                self.undo_everything()
        finally:
            self.harness.close()
            for session in self.harness.sessions:
                session.release()
            for engine in self.engines:
                engine.release()

    def undo_everything(self) -> None:
        self.settle()
        while self.model.done:  # everything is undone, however it was made
            left = self.model.done - 1
            self.undo(-1)
            self.settle()
            assert self.model.done == left


def check(ctx: moderngl.Context, folder: Path, examples: int, steps: int, number: str) -> None:
    machine = type("Machine", (SessionMachine,), {"ctx": ctx, "folder": folder})
    chosen = settings(
        max_examples=examples,
        stateful_step_count=steps,
        deadline=None,
        database=None,
        report_multiple_bugs=False,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    seed(int(sha256(number.encode()).hexdigest(), 16))(machine)
    run_state_machine_as_test(machine, settings=chosen)


def test_a_session_shows_the_files_with_the_edits(ctx: moderngl.Context, tmp_path: Path) -> None:
    check(ctx, tmp_path, 32, 14, "every day")


@pytest.mark.slow
def test_a_session_shows_the_files_under_many_sequences(
    ctx: moderngl.Context, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    check(ctx, tmp_path, 40, 25, pytestconfig.getoption("--seed") or git("rev-parse", "HEAD"))
