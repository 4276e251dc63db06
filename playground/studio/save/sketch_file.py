"""Write into the sketch's file; where it is read-only, offer a copy instead.

Keyframes are written into its own TOML: a ``[[keyframe]]`` with the comments right above it is a block.
What changes in a block is written over in its place; a block that moves in time takes its comments along to
its new place among the others; a new one comes after the last, or at the end of the file.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from difflib import SequenceMatcher
from itertools import pairwise
from operator import attrgetter
from pathlib import Path

from playground.errors import DataError, PlaygroundError, SketchError
from playground.files import partial_file, read_regular, reason, writing
from playground.paths import GLSL, shown
from playground.shader.parameter import shortest
from playground.sketch.keyframes import EASES
from playground.sketch.model import Camera, Keyframe, Sketch, Value
from playground.sketch.save import (
    ReadOnlySketch,
    says_same_as,
    write_over,
    written_number,
    written_so_far,
    written_value,
)
from playground.sketch.toml_text import KeyPath, append, blocks, drop, newline_of, put, text_of
from playground.studio.edits.history import TextChange
from playground.studio.language import tr
from playground.studio.notices import Notices
from playground.studio.session import Session


def save_keyframes(file: Sketch, keyframes: Sequence[Keyframe]) -> None:
    """Write keyframes into the file that ``file`` was loaded from, in place of those that it has.

    They are written by time. Raises ``ReadOnlySketch`` and ``SketchError`` as ``save``
    does; of times that are the same, and of keyframes that do not fit each other, too.
    """
    in_order = tuple(sorted(keyframes, key=lambda keyframe: keyframe.time))
    for earlier, later in pairwise(in_order):
        if earlier.time == later.time:
            raise SketchError(f"there is a keyframe at {earlier.time:g} s already", file=shown(file.file))
    says_the_rest = says_same_as(file)

    def is_right(reloaded: Sketch) -> bool:
        shots = [replace(shot, line=0) for shot in file.shots]
        return (
            _without_lines(reloaded.keyframes) == _without_lines(in_order)
            and says_the_rest(reloaded)
            and reloaded.presets == file.presets
            and [replace(shot, line=0) for shot in reloaded.shots] == shots
        )

    write_over(Path(file.file), file, lambda text: with_keyframes(text, file, in_order), is_right)


def with_keyframes(text: str, file: Sketch, keyframes: Sequence[Keyframe]) -> str:
    """Return a sketch's text, which says what ``file`` does, with these keyframes; they are by time."""
    if len(blocks(text, "keyframe")) != len(file.keyframes):
        message = "its keyframes are written as one list; write each as a [[keyframe]] to change them here"
        raise SketchError(message, file=shown(file.file))
    before = _matched(file.keyframes, keyframes)
    for keyframe, index in zip(keyframes, before, strict=True):
        if index is not None:
            text = _changed(text, file, ("keyframe", index), file.keyframes[index], keyframe)
    spans = blocks(text, "keyframe")
    written = [text[start:end] for start, end in spans]
    newline = newline_of(text)
    made = [
        written[index] if index is not None else _new_block(file, keyframe, newline)
        for keyframe, index in zip(keyframes, before, strict=True)
    ]
    if spans:
        return _placed(text, spans, made, newline)
    for block in made:
        text = append(text, block.splitlines())
    return text


def with_presets(text: str, file: Sketch, order: Sequence[int]) -> str:
    """Return a sketch's text with its presets in another order, without those that are not in ``order``."""
    spans = blocks(text, "preset")
    if len(spans) != len(file.presets):
        message = "its presets are written as one list; write each as a [[preset]] to change them here"
        raise SketchError(message, file=shown(file.file))
    return _placed(text, spans, [text[slice(*spans[index])] for index in order], newline_of(text))


def save_presets(file: Sketch, order: Sequence[int]) -> None:
    """Write the presets of the file that ``file`` was loaded from in another order, or fewer of them.

    ``order`` has places in ``file.presets``. Raises ``ReadOnlySketch`` and ``SketchError`` as ``save`` does.
    """
    wanted = tuple(file.presets[index] for index in order)
    says_the_rest = says_same_as(file)

    def is_right(reloaded: Sketch) -> bool:
        return (
            reloaded.presets == wanted
            and says_the_rest(reloaded)
            and _without_lines(reloaded.keyframes) == _without_lines(file.keyframes)
            and [replace(shot, line=0) for shot in reloaded.shots]
            == [replace(shot, line=0) for shot in file.shots]
        )

    write_over(Path(file.file), file, lambda text: with_presets(text, file, order), is_right)


def _placed(text: str, spans: list[tuple[int, int]], made: list[str], newline: str) -> str:
    """Return the text with blocks in the places of its own: one each, what is left after the last."""
    text_placed, at = "", 0
    for number, (start, end) in enumerate(spans):
        text_placed += text[at:start]
        at = end
        here = made[number:] if number == len(spans) - 1 else made[number : number + 1]
        for further, block in enumerate(here):
            text_placed += newline if further else ""
            text_placed += block if block.endswith("\n") else block + newline
        if not here and text_placed.endswith(newline * 2):
            # No two empty lines where a block was, and none at the end.
            if text[at:].startswith(newline):
                at += len(newline)
            elif not text[at:].strip():
                text_placed = text_placed[: -len(newline)]
    return text_placed + text[at:]


def _matched(keyframes_in_file: Sequence[Keyframe], keyframes: Sequence[Keyframe]) -> list[int | None]:
    """Return which known keyframe each wanted one was: the same, else at its time, else with its values."""
    left = dict(enumerate(_without_lines(keyframes_in_file)))
    matches: list[int | None] = [None] * len(keyframes)
    for names in (["time", "camera", "values", "ease"], ["time"], ["camera", "values"]):
        key = attrgetter(*names)
        for number, keyframe in enumerate(_without_lines(keyframes)):
            if matches[number] is None:
                hit = next((i for i, other in left.items() if key(other) == key(keyframe)), None)
                if hit is not None:
                    matches[number] = hit
                    del left[hit]
    return matches


def _without_lines(keyframes: Sequence[Keyframe]) -> list[Keyframe]:
    """Return keyframes without their lines, camera fields and values in one order."""

    def values(keyframe: Keyframe) -> tuple[tuple[str, Value], ...]:
        return tuple(sorted(((p, shortest(v)) for p, v in keyframe.values), key=lambda v: v[0]))

    return [replace(k, line=0, camera=tuple(sorted(k.camera)), values=values(k)) for k in keyframes]


def _changed(text: str, file: Sketch, key_path: KeyPath, was: Keyframe, now: Keyframe) -> str:
    """Return the text with what differs between two keyframes written over in the first one's table."""
    if now.time != was.time:
        text = put(text, key_path, "time", repr(float(now.time)))
    cameras, values = dict(was.camera), dict(was.values)
    order = [part.name for part in fields(Camera)]
    for name, number in sorted(now.camera, key=lambda pair: order.index(pair[0])):
        if name not in cameras or cameras[name] != number:
            text = put(text, (*key_path, "camera"), name, written_number(number))
    for name, value in now.values:
        if name not in values or values[name] != value:
            table = (*key_path, "set")
            text = put(text, table, name, written_value(file, name, value, written_so_far(text, table, name)))
    for name in cameras.keys() - dict(now.camera).keys():
        text = drop(text, (*key_path, "camera"), name)
    for name in values.keys() - dict(now.values).keys():
        text = drop(text, (*key_path, "set"), name)
    return text if now.ease == was.ease else put(text, key_path, "ease", text_of(now.ease))


def _new_block(file: Sketch, keyframe: Keyframe, newline: str) -> str:
    """Return a new keyframe as TOML writes it."""
    empty = Keyframe(-1.0, ease=EASES[0])
    return _changed(f"[[keyframe]]{newline}", file, ("keyframe", 0), empty, keyframe)


def contents_of(path: Path) -> bytes | None:
    """Return what a file holds, None where there is none; raise ``DataError`` where it cannot be read."""
    try:
        return read_regular(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise DataError(f"cannot be read: {reason(error)}", file=path) from None


def write_texts(changes: Mapping[Path, TextChange]) -> None:
    """Change all files, or none of them; a text keeps what else was edited in it since.

    Raises ``ReadOnlySketch`` for one that cannot be written or belongs to the playground itself,
    ``SketchError`` where the same lines have changed since, ``DataError`` where the system refuses.
    """
    before: dict[Path, bytes | None] = {}
    after: dict[Path, bytes | None] = {}
    for path, change in changes.items():
        file = path.resolve()
        if file.is_relative_to(GLSL.resolve()):
            raise ReadOnlySketch("this sketch belongs to the playground itself", file=path)
        if not os.access(file if file.exists() else file.parent, os.W_OK):
            raise ReadOnlySketch("this sketch cannot be written to", file=path)
        before[path] = contents_of(file)
        after[path] = merged(path, before[path], change)
    written: list[Path] = []
    try:
        for path, data in after.items():
            written.append(path)
            _replace(path, data)
    except PlaygroundError:
        for path in written:
            with suppress(PlaygroundError):
                _replace(path, before[path])
        raise


def _replace(path: Path, data: bytes | None) -> None:
    """Write a file, whole and with the rights that it has, or remove it."""
    file = path.resolve()  # a link stays a link
    with writing(file):
        if data is None:
            file.unlink(missing_ok=True)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        with partial_file(file) as partial:
            partial.handle.write(data)
            if file.exists():
                partial.path.chmod(stat.S_IMODE(file.stat().st_mode))
            partial.rename(file)


@dataclass
class SketchFile:
    """The file of one session's sketch."""

    session: Session
    notices: Notices
    offer: str = ""  # why the sketch cannot be saved: a copy is offered
    asks: bool = False  # the offer is still to be shown
    save_typed: Callable[[], None] = lambda: None  # saves what is typed in the sketch's file
    show_written: Callable[[Collection[Path]], None] = lambda paths: None  # in the code pane

    def write(self, act: Callable[[], None], *paths: Path) -> bool:
        """Write, and read the sketch again; return whether that worked. Else offer a copy or say why.

        ``paths``: the files that are written, besides the sketch's own.
        """
        drafts = self.session.drafts
        if drafts.opening:  # what is read again is the other
            name, other = shown(drafts.shown_path), shown(drafts.path)
            ways = tr("open {name} again, or save a copy", name=name)
            self.notices.say(
                tr(
                    "{name} is not saved while {other} is being opened: {ways}",
                    name=name,
                    other=other,
                    ways=ways,
                )
            )
            return False
        self.save_typed()
        try:
            act()
        except ReadOnlySketch as error:
            why = next((tr(words) for words in _READ_ONLY if str(error).endswith(words)), str(error))
            self.offer, self.asks = f"{why[0].upper()}{why[1:]}.", True
        except PlaygroundError as error:
            self.notices.say(str(error))
        else:
            drafts.reload()
            self.show_written({drafts.path, *paths})
            return True
        return False

    def change_texts(self, changes: Mapping[Path, TextChange]) -> bool:
        """Change several files, or none; return whether that worked."""
        return self.write(lambda: write_texts(changes), *changes)


_READ_ONLY = (
    "a shader opened alone has no sketch file to save into",
    "an elevation file opened alone has no sketch file to save into",
    "this sketch belongs to the playground itself",
    "this sketch cannot be written to",
)
"""Why a sketch is not written, as ``ReadOnlySketch`` says it."""


def merged(path: Path, data: bytes | None, change: TextChange) -> bytes | None:
    """Return what a file becomes by a change made to what it holds by now, ``data``.

    Raises ``SketchError`` where the same lines differ from what the change is of.
    """
    if data == change.of:
        return change.to
    words = "the same lines have changed meanwhile, so they stay as they are"
    if data is None or change.of is None or change.to is None:
        raise SketchError(words, file=shown(path))
    old = change.of.splitlines(keepends=True)
    edits: list[tuple[int, int, list[bytes]]] = []
    for new in (change.to.splitlines(keepends=True), data.splitlines(keepends=True)):
        codes = SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
        edits += [(i, j, new[a:b]) for kind, i, j, a, b in codes if kind != "equal"]
    edits.sort(key=lambda edit: edit[:2])
    if any(later[0] < earlier[1] or later[:1] == earlier[:1] for earlier, later in pairwise(edits)):
        raise SketchError(words, file=shown(path))
    for start, end, lines in reversed(edits):
        old[start:end] = lines
    return b"".join(old)
