"""Read a fenced block of a lesson: its first word is its kind, its second its name, its lines TOML."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

from playground.errors import PlaygroundError, SketchError, nearest
from playground.lessons import model
from playground.lessons.document import texts_in
from playground.lessons.markdown import Piece
from playground.lessons.measures import MEASURES
from playground.lessons.scenes import FRAME, PICTURE, STATE, Sketches, read_scene, with_steps, with_value
from playground.paths import GLSL
from playground.sketch.assign import check_value, resolve
from playground.sketch.model import Value
from playground.sketch.toml_table import TomlFile
from playground.sketch.values import spell

B = TypeVar("B", bound=model.Named)

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
_RENAMED = {"mend": "fix", "turns": "iterations"}  # keys of older lessons


@dataclass(frozen=True)
class Fence:
    """A fenced block, opened: its kind, its name, and its lines as TOML."""

    kind: str
    name: str
    piece: Piece
    line: int  # in the file, from 1
    file: TomlFile
    sketches: Sketches

    def only(self, kind: type[model.Named], *own: str) -> None:
        """Raise ``SketchError`` for a key that is neither a text of such a block nor one of ``own``."""
        self.file.only(self.file.table, [*own, *map(model.key_of, model.translated_fields(kind))])

    def take(self, key: str, kind: type, default: Any) -> Any:
        """Return what a key has, checked to be of a kind."""
        return self.file.take(self.file.table, key, kind, default)

    def markdown(self, key: str, *, needed: bool = True) -> str:
        """Return the text that a key has; raise ``SketchError`` if it is needed and not there."""
        found: str = self.take(key, str, "")
        if needed and not found.strip():
            raise self.error(f'a {self.kind} block needs {key} = "…"')
        return found.strip()

    def texts(self, key: str) -> tuple[str, ...]:
        """Return the list of texts that a key has."""
        return tuple(item.strip() for item in texts_in(self.file, key))

    def block(self, kind: type[B], **fields: Any) -> B:
        """Return the block with these fields; its line, its name and its texts are read."""
        for text in model.translated_fields(kind):
            key, meaning = model.key_of(text), text.metadata
            if text.name not in fields:
                fields[text.name] = (
                    self.texts(key) if "listed" in meaning else self.markdown(key, needed=meaning["needed"])
                )
        return kind(line=self.line, text=self.piece.text, name=self.name, **fields)

    @property
    def state(self) -> dict[str, Any]:
        """Its keys that describe a picture."""
        return {key: value for key, value in self.file.table.items() if key in STATE}

    def scene(self, pixels: tuple[int, int] = PICTURE) -> model.Scene:
        """Return the picture that the block's own keys describe."""
        return read_scene(self.file, self.state, (), self.sketches, pixels)

    def error(self, message: str, *place: str | int) -> SketchError:
        """Return an error at a place in the block."""
        return self.file.error(message, *place)


def open_fence(piece: Piece, path: Path, line: int, sketches: Sketches) -> Fence:
    """Return the fence that a piece of a file is; raise ``SketchError`` if its head or its TOML is wrong."""
    kind, _, name = piece.info.partition(" ")
    if kind not in READERS:
        hint = nearest(kind, READERS)
        raise SketchError(f"no block of a lesson is called '{kind}'{hint}", file=path, line=line)
    if not _NAME.fullmatch(name):
        message = f"{kind} '{name}': behind its kind a block has a name of small letters, digits and -"
        raise SketchError(message, file=path, line=line)
    file = TomlFile(path, GLSL / "sketches", piece.inside, line)
    file.table = {_RENAMED.get(key, key): value for key, value in file.table.items()}
    return Fence(kind, name, piece, line, file, sketches)


def read_fence(fence: Fence) -> model.Named:
    """Build the block that a fence describes; raise ``SketchError`` at the key that is wrong."""
    return READERS[fence.kind](fence)


def _figure(fence: Fence) -> model.Figure:
    fence.only(model.Figure, *STATE, "sliders")
    scene, sliders = fence.scene(), fence.texts("sliders")
    for path in sliders:
        _check_path(fence, scene, path, "sliders")
    return fence.block(model.Figure, scene=scene, sliders=sliders)


def _steps(fence: Fence) -> model.Steps:
    from playground.engine.planner import repeated_in, repeats_of  # it needs what is loaded by then only

    fence.only(model.Steps, *STATE, "passes", "iterations")
    scene = fence.scene(FRAME)
    passes = fence.texts("passes")
    if not passes:
        raise fence.error('a step block needs passes = ["…"]: the repeated passes that it stops')
    try:
        repeated = [repeated_in(scene.sketch, path) for path in passes]
        most = min(repeats_of(scene.sketch, frame_size=scene.pixels, time=scene.time)[p] for p in repeated)
    except PlaygroundError as error:
        raise fence.error(error.diagnostics[0].message, "passes") from None
    given = fence.take("iterations", list, list(range(most + 1)))
    if not given or not all(type(one) is int and 0 <= one <= most for one in given):
        message = f"iterations = {spell(given)}: expected whole numbers from 0 to {most}"
        raise fence.error(message, "iterations")
    captions = fence.texts("captions")
    if captions and len(captions) != len(given):
        raise fence.error(f"captions: {len(captions)} for {len(given)} iterations", "captions")
    scenes = tuple(with_steps(scene, dict.fromkeys(passes, one)) for one in given)
    return fence.block(model.Steps, scenes=scenes, passes=passes, iterations=tuple(given))


def _slider(fence: Fence) -> model.Slider:
    fence.only(model.Slider, *STATE, "parameter", "values", "from", "to", "frames")
    scene = fence.scene(FRAME)
    parameter = fence.markdown("parameter")
    _check_path(fence, scene, parameter, "parameter")
    values = _swept(fence, scene, parameter)
    scenes = tuple(with_value(scene, parameter, value) for value in values)
    return fence.block(model.Slider, scenes=scenes, parameter=parameter, values=values)


def _swept(fence: Fence, scene: model.Scene, parameter: str) -> tuple[Value, ...]:
    given = fence.take("values", list, None)
    if given is None:
        low, high = (fence.take(key, float, None) for key in ("from", "to"))
        frames = fence.take("frames", int, 9)
        if low is None or high is None or low == high or not 2 <= frames <= 64:
            raise fence.error("a slider needs values = […], or from, to and frames (2 to 64)")
        whole = resolve(scene.sketch.graph, parameter)[0].parameter.type in ("int", "uint")
        given = [low + (high - low) * i / (frames - 1) for i in range(frames)]
        given = [round(v) if whole else float(f"{v:.6g}") for v in given]
    if len(given) < 2:
        raise fence.error("values: a slider has two or more", "values")
    try:
        return tuple(check_value(scene.sketch, parameter, value) for value in given)
    except PlaygroundError as error:
        raise fence.error(error.diagnostics[0].message, "values") from None


def _compare(fence: Fence) -> model.Compare:
    fence.only(model.Compare, *STATE, "variant")
    tables = fence.file.tables("variant")
    if len(tables) < 2:
        raise fence.error("a compare block has two or more [[variant]]")
    scenes = []
    for index, table in enumerate(tables):
        place = ("variant", index)
        fence.file.only(table, STATE, *place)
        scenes.append(read_scene(fence.file, table, place, fence.sketches, under=fence.state))
    labels = fence.texts("labels")
    if len(labels) != len(scenes):
        raise fence.error(f"labels: {len(labels)} for {len(scenes)} variants", "labels")
    if len({scene.pixels for scene in scenes}) > 1:
        raise fence.error("pictures that are compared have one size: set pixels")
    return fence.block(model.Compare, scenes=tuple(scenes))


def _code(fence: Fence) -> model.Code:
    fence.only(model.Code, "file", "anchor")
    return fence.block(model.Code, file=_shader(fence), anchor=fence.markdown("anchor"))


def _break(fence: Fence) -> model.Break:
    fence.only(model.Break, *STATE, "file", "find", "put")
    find, put = (fence.take(key, str, "") for key in ("find", "put"))
    return fence.block(model.Break, scene=fence.scene(), file=_shader(fence), find=find, put=put)


def _question(fence: Fence) -> model.Question:
    fence.only(model.Question, "right")
    choices, right = fence.texts("choices"), fence.take("right", int, -1)
    if choices and not 0 <= right < len(choices):
        raise fence.error(f"right = {right}: expected the place of a choice, 0 to {len(choices) - 1}")
    if right >= 0 and not choices:
        raise fence.error("right: there are no choices", "right")
    return fence.block(model.Question, right=right)


def _exercise(fence: Fence) -> model.Exercise:
    fence.only(model.Exercise, *STATE)
    drawn = "sketch" in fence.file.table
    alt = fence.markdown("alt", needed=drawn)
    return fence.block(model.Exercise, scene=fence.scene() if drawn else None, alt=alt)


def _measure(fence: Fence) -> model.Measure:
    fence.only(model.Measure, *STATE, "of", "what", "with", "over", "digits", "unit", "between")
    what = fence.markdown("what")
    what = _RENAMED.get(what, what)
    if what not in MEASURES:
        raise fence.error(f"what = '{what}': there is no such measure{nearest(what, MEASURES)}", "what")
    over = fence.take("over", dict, None)
    if over is not None:
        fence.file.only(over, STATE, "over")
        over = read_scene(fence.file, over, ("over",), fence.sketches, under=fence.state)
    digits = fence.take("digits", int, 3)
    if not 1 <= digits <= 7:
        raise fence.error(f"digits = {digits}: expected 1 to 7", "digits")
    return fence.block(
        model.Measure,
        scene=fence.scene(),
        over=over,
        of=fence.take("of", str, "height"),
        what=what,
        arguments=_arguments(fence, what),
        digits=digits,
        unit=fence.take("unit", str, ""),
        between=_between(fence),
    )


def _arguments(fence: Fence, what: str) -> tuple[tuple[str, float], ...]:
    given: Mapping[str, Any] = fence.take("with", dict, {})
    wanted = MEASURES[what].arguments
    fence.file.only(given, wanted, "with")
    missing = [name for name in wanted if name not in given]
    if missing:
        raise fence.error(f"{what} needs with = {{ {', '.join(f'{name} = …' for name in wanted)} }}")
    return tuple((name, float(fence.file.take(given, name, float, 0.0, "with"))) for name in wanted)


def _between(fence: Fence) -> tuple[float, float] | None:
    given = fence.take("between", list, None)
    if given is None:
        return None
    numbers = all(type(v) in (int, float) for v in given)
    if len(given) != 2 or not numbers or any(b < a for a, b in pairwise(given)):
        raise fence.error(f"between = {spell(given)}: expected [lowest, highest]", "between")
    return float(given[0]), float(given[1])


def _shader(fence: Fence) -> str:
    file = fence.markdown("file")
    path = (GLSL / file).resolve()
    if not path.is_relative_to(GLSL.resolve()) or not path.is_file():
        names = [p.relative_to(GLSL).as_posix() for p in GLSL.rglob("*") if p.suffix in (".glsl", ".comp")]
        raise fence.error(f"file = '{file}': not in glsl/{nearest(file, names)}", "file")
    return file


def _check_path(fence: Fence, scene: model.Scene, path: str, key: str) -> None:
    try:
        resolve(scene.sketch.graph, path)
    except PlaygroundError as error:
        raise fence.error(error.diagnostics[0].message, key) from None


READERS: dict[str, Callable[[Fence], model.Named]] = {
    "figure": _figure,
    "step": _steps,
    "slider": _slider,
    "compare": _compare,
    "code": _code,
    "break": _break,
    "question": _question,
    "exercise": _exercise,
    "measure": _measure,
}
"""What reads each kind of block."""
