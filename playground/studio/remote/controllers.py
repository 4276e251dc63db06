"""MIDI controllers that set parameters: learned by moving them, remembered next to the sketch.

A control goes over the range of its parameter's widget. It takes over softly: a value
does not jump to where the knob happens to be, but follows once the knob has passed it. A menu or a
checkbox has no such place between, and follows at once; a button is pressed where the control comes
to 64. A note switches a checkbox, presses a button, goes to a menu's next choice, and sets a number
by how hard it is struck.

The bindings are in a file next to the sketch, readable TOML: ``hills/sketch.toml`` has
``hills/sketch.controllers``, ``shader.frag`` has ``shader.controllers``. A sketch is shared without it,
unless its owner adds it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from playground.errors import ParameterError, PlaygroundError, SketchError, nearest
from playground.files import write_file
from playground.paths import GLSL, shown
from playground.shader.parameter import part_names
from playground.sketch.model import Parameter, Value
from playground.sketch.toml_table import FORMAT, TomlFile
from playground.studio.language import tr
from playground.studio.notices import Notices
from playground.studio.panel.parameter_list import items_of, shown_values
from playground.studio.panel.values import HALF, check_range, is_switch, value_fraction, with_fraction
from playground.studio.session import Session

# ── the file ──────────────────────────────────────────────────────────────────


ENDING = ".controllers"
KINDS = ("control", "note")
_MAX_BYTES = 2**16  # [bytes]
_KEYS = ("parameter", "part", "channel", *KINDS, "fine")


@dataclass(frozen=True, order=True)
class Source:
    """A knob, fader, key or button of a MIDI device; which device is not looked at."""

    channel: int  # 1 to 16
    kind: str  # one of KINDS
    number: int  # 0 to 127

    def __str__(self) -> str:
        return tr(
            "{kind} {number} of channel {channel}",
            kind=tr(self.kind),
            number=self.number,
            channel=self.channel,
        )


@dataclass(frozen=True)
class Binding:
    """A parameter, or one part of a vector, that a controller sets."""

    path: str
    part: str  # "": all of it
    source: Source
    fine: bool = False  # 14 bits: the control 32 higher has the lower seven

    @property
    def target(self) -> str:
        """What it sets, in a word."""
        return f"{self.path}, {self.part}" if self.part else self.path


def file_of(sketch: Path) -> Path:
    """Return the file for a sketch's."""
    return sketch.with_suffix(ENDING)


def read_bindings(path: Path) -> tuple[Binding, ...]:
    """Return what a file says, nothing where there is none; raise ``SketchError`` with the line."""
    try:
        if not path.is_file():
            return ()
        size = path.stat().st_size
    except OSError as error:
        raise SketchError(f"cannot be read: {error.strerror or error}", file=path) from None
    if size > _MAX_BYTES:
        raise SketchError(f"larger than {_MAX_BYTES // 1024} KiB: no list of controllers is", file=path)
    file = TomlFile(path, path.parent)
    file.only(file.table, ("format", "controller"))
    file.version(required=False)
    return tuple(_binding(file, table, at) for at, table in enumerate(file.tables("controller")))


def write_bindings(path: Path, bindings: Iterable[Binding]) -> None:
    """Write a file, whole or not at all; remove it where there is nothing to say. Raise ``DataError``."""
    parts = [_text(binding) for binding in bindings]
    if not parts:
        path.unlink(missing_ok=True)
        return
    head = "# MIDI controllers of the sketch next to this file; playground live writes it.\n"
    write_file(path, head + f"format = {FORMAT}\n" + "".join(parts))


def _text(binding: Binding) -> str:
    lines = [f"parameter = {json.dumps(binding.path)}"]
    lines += [f"part = {json.dumps(binding.part)}"] if binding.part else []
    lines += [f"channel = {binding.source.channel}", f"{binding.source.kind} = {binding.source.number}"]
    lines += ["fine = true"] if binding.fine else []
    return "\n[[controller]]\n" + "\n".join(lines) + "\n"


def _binding(file: TomlFile, table: dict[str, Any], at: int) -> Binding:
    key_path = "controller", at
    file.only(table, _KEYS, *key_path)
    path = file.take(table, "parameter", str, "", *key_path)
    if not path:
        raise file.error('a controller has a parameter, as parameter = "light.sun"', *key_path)
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        raise file.error("a controller has a control or a note, as control = 21", *key_path)
    number = _within(file, table, kinds[0], 0, 127, at)
    fine = file.take(table, "fine", bool, False, *key_path)
    if fine and not (kinds[0] == "control" and number < 32):
        raise file.error("fine = true: only the controls 0 to 31 have 14 bits", *key_path, "fine")
    source = Source(_within(file, table, "channel", 1, 16, at), kinds[0], number)
    return Binding(path, file.take(table, "part", str, "", *key_path), source, fine)


def _within(file: TomlFile, table: dict[str, Any], key: str, low: int, high: int, at: int) -> int:
    number: int = file.take(table, key, int, low if key == "channel" else None, "controller", at)
    if not low <= number <= high:
        raise file.error(f"{key} = {number}: expected {low} to {high}", "controller", at, key)
    return number


# ── controllers ───────────────────────────────────────────────────────────────


SETTLES = 0.25
"""[s] after the first message of a knob that is learned: until then it shows whether it sends 14 bits."""
_ASKS = "MIDI: move a knob or press a button"
_LSB = 32  # the control that has the lower bits is so much higher

Move = tuple[Source, int]
"""A controller, and its position from 0 to 127; of a note how hard it is struck, 0 for let go."""


@dataclass
class _Knob:
    """What is known of a controller of one binding."""

    at: float | None = None  # the fraction that it was at last
    made: Value | None = None  # the value that it set last; while that stands, the knob has it


@dataclass
class _Learning:
    """What is being learned."""

    path: str
    part: str
    since: float | None = None  # [s] when the first message came
    seen: dict[Source, int] = field(default_factory=dict)  # how often each was moved


class Controllers:
    """The bindings of the sketch that is shown."""

    def __init__(self, session: Session, notices: Notices) -> None:
        self._session = session
        self._notices = notices
        self.listen: Callable[[], str] = lambda: tr("MIDI cannot be received here")  # returns why not, or ""
        self.learning: _Learning | None = None
        self._bindings: tuple[Binding, ...] = ()
        self._of: Path | None = None
        self._unreadable = False
        self._knobs: dict[Binding, _Knob] = {}
        self._positions: dict[Source, int] = {}
        self._said: set[str] = set()

    @property
    def bindings(self) -> tuple[Binding, ...]:
        """What is learned for the sketch that is shown."""
        path = self._session.drafts.shown_path
        if path != self._of and self._session.shown is not None:
            self._of, self.learning, self._knobs, self._said = path, None, {}, set()
            self._unreadable = False
            try:
                self._bindings = read_bindings(file_of(path))
            except PlaygroundError as error:
                self._bindings, self._unreadable = (), True
                self._notices.say(tr("MIDI: {error}", error=error))
        return self._bindings

    @property
    def settles(self) -> bool:
        """Whether what is being learned will be known in a moment."""
        return self.learning is not None and self.learning.since is not None

    def of(self, path: str) -> list[Binding]:
        """Return the bindings of a parameter."""
        return [binding for binding in self.bindings if binding.path == path]

    # ── learning ─────────────────────────────────────────────────────────────

    def learn(self, path: str, part: str = "") -> None:
        """Bind a parameter, or a part of a vector, to the controller that is moved next."""
        _ = self.bindings
        item = items_of(self._session.shown).get(path)
        if item is None:
            return
        try:
            check_range(item.parameter, path)
        except ParameterError as error:
            self._notices.say(str(error))
            return
        if why := self.listen():
            self._notices.say(why)
            return
        self.learning = _Learning(path, part)
        target = f"{path}, {part}" if part else path
        self._notices.say(tr("{asks} for {parameter}", asks=tr(_ASKS), parameter=target))

    def cancel(self) -> None:
        """Learn nothing after all."""
        self.learning = None

    def unlearn(self, path: str) -> None:
        """Forget the controllers of a parameter."""
        left = tuple(binding for binding in self.bindings if binding.path != path)
        if left != self._bindings:
            self._keep(left)
            self._notices.say(tr("MIDI: no controller sets {path} any more", path=path))

    def update(self) -> None:
        """Take in what was learned, once that is known. Call it in each frame."""
        learning = self.learning
        if learning is None or learning.since is None:
            return
        if self._notices.now() - learning.since < SETTLES and not _is_note(learning):
            return
        source, fine = _learned(learning.seen)
        self._notices.drop(tr(_ASKS))
        self.learning = None
        binding = Binding(learning.path, learning.part, source, fine)
        others = [b for b in self.bindings if (b.path, b.part) != (binding.path, binding.part)]
        self._keep((*others, binding))
        also = [b.target for b in others if b.source == source]
        more = tr("; it sets {join} as well", join=tr(" and ").join(also)) if also else ""
        self._notices.say(
            tr("MIDI: {source} sets {target}{more}", source=source, target=binding.target, more=more)
        )
        self._knobs[binding] = _Knob(self._fraction(binding))

    def _keep(self, bindings: tuple[Binding, ...]) -> None:
        self._bindings = bindings
        path = self._session.drafts.shown_path
        if path.is_relative_to(GLSL):
            self._say_once(
                "shipped", tr("MIDI: {stem} comes with the playground; a copy keeps this", stem=path.stem)
            )
            return
        if self._unreadable:
            self._say_once(
                "wrong", tr("MIDI: {file} has a mistake, and is not written", file=shown(file_of(path)))
            )
            return
        try:
            write_bindings(file_of(path), bindings)
        except (PlaygroundError, OSError) as error:
            self._notices.say(
                tr("MIDI: learned bindings last until the window is closed: {error}", error=error)
            )

    # ── moves ────────────────────────────────────────────────────────────────

    def take(self, moves: Iterable[Move]) -> None:
        """Set what the controllers say that were moved, in order."""
        touched: dict[Binding, None] = {}
        bindings = self.bindings
        for source, position in moves:
            self._positions[source] = position
            if self.learning is not None:
                self._listen_to(source, position)
                continue
            for binding in bindings:
                if binding.source == source and source.kind == "note":
                    self._strike(binding, position)
                elif _moves(binding, source):
                    touched[binding] = None
        for binding in touched:
            self._turn(binding)

    def _listen_to(self, source: Source, position: int) -> None:
        learning = self.learning
        assert learning is not None
        if source.kind == "note" and not position:
            return  # it is let go
        learning.since = self._notices.now() if learning.since is None else learning.since
        learning.seen[source] = learning.seen.get(source, 0) + 1

    def _turn(self, binding: Binding) -> None:
        """Set a parameter as a knob says, once the knob has taken it over."""
        value_now = self._value(binding)
        fraction = self._fraction(binding)
        if value_now is None or fraction is None:
            return
        parameter, value, part = value_now
        knob = self._knobs.setdefault(binding, _Knob())
        before, knob.at = knob.at, fraction
        if parameter.widget.kind == "button":
            if fraction >= HALF and (before is None or before < HALF):
                self._set(binding, True)
            return
        has_it = knob.made is not None and knob.made == value
        if not has_it and not is_switch(parameter):
            now = value_fraction(parameter, value, part)
            near = abs(fraction - now) <= (1.0 / 16383 if binding.fine else 1.0 / 127)
            if not near and not (before is not None and (before - now) * (fraction - now) <= 0):
                return
        self._set(binding, with_fraction(parameter, value, fraction, part))
        if (after := self._value(binding)) is not None:
            knob.made = after[1]

    def _strike(self, binding: Binding, strength: int) -> None:
        value_now = self._value(binding)
        if value_now is None or not strength:
            return
        parameter, value, part = value_now
        if parameter.type == "bool":
            self._set(binding, parameter.widget.kind == "button" or not value)
        elif parameter.widget.kind == "menu" and isinstance(value, int):
            self._set(binding, (value + 1) % len(parameter.widget.choices))
        else:
            self._set(binding, with_fraction(parameter, value, strength / 127, part))

    def _set(self, binding: Binding, value: Value) -> None:
        draft = self._session.shown
        if draft is not None and binding.path in draft.edits.locked:
            self._say_once(
                f"lock {binding.path}",
                tr("MIDI: {path} is locked: {source} sets nothing", path=binding.path, source=binding.source),
            )
            return
        for path, other in self._session.without_buttons({binding.path: value}).items():
            self._session.drafts.set(path, other)

    def _value(self, binding: Binding) -> tuple[Parameter, Value, int] | None:
        """Return a binding's parameter, its value, and which part; None, and a notice, where it is gone."""
        draft = self._session.shown
        items = items_of(draft)
        item = items.get(binding.path)
        if item is None or draft is None:
            near = nearest(binding.path, items)
            self._say_once(
                binding.path,
                tr(
                    "MIDI: {source} sets no parameter '{path}'{near}",
                    source=binding.source,
                    path=binding.path,
                    near=near,
                ),
            )
            return None
        names = part_names(item.parameter)
        if bool(names) != bool(binding.part) or (names and binding.part not in names):
            near = nearest(binding.part, names) or tr("; it has no parts")
            self._say_once(
                binding.target,
                tr(
                    "MIDI: {path} has no part '{part}'{near}", path=binding.path, part=binding.part, near=near
                ),
            )
            return None
        part = names.index(binding.part) if names else 0
        return item.parameter, shown_values(draft).of[binding.path], part

    def _fraction(self, binding: Binding) -> float | None:
        """Return the fraction that a controller is at; None before it has moved."""
        source = binding.source
        position = self._positions.get(source)
        if position is None:
            return None
        if not binding.fine:
            return position / 127
        lower = self._positions.get(Source(source.channel, source.kind, source.number + _LSB), 0)
        return (position * 128 + lower) / 16383

    def _say_once(self, kind: str, message: str) -> None:
        if kind not in self._said:
            self._said.add(kind)
            self._notices.say(message)


def _moves(binding: Binding, source: Source) -> bool:
    mine = binding.source
    if source.kind != "control" or mine.kind != "control" or source.channel != mine.channel:
        return False
    return source.number == mine.number or (binding.fine and source.number == mine.number + _LSB)


def _is_note(learning: _Learning) -> bool:
    return any(source.kind == "note" for source in learning.seen)


def _learned(seen: dict[Source, int]) -> tuple[Source, bool]:
    """Return the controller that was moved most, and whether it sends 14 bits."""
    notes = [source for source in seen if source.kind == "note"]
    if notes:
        return notes[0], False
    most = max(seen, key=lambda source: seen[source])
    for source in seen:
        if source.number < _LSB and Source(source.channel, "control", source.number + _LSB) in seen:
            return source, True
    return most, False
