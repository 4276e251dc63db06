"""Read a fenced block of a lesson: its first word is its kind, its second its name, its lines TOML."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from playground.course import model
from playground.course.document import Fence, check_path, measure_of, shader
from playground.course.markdown import Piece
from playground.course.scenes import FRAME, STATE, Sketches, read_scene, with_steps, with_value
from playground.course.task_fences import read_challenge, read_exercise
from playground.errors import PlaygroundError, SketchError, nearest
from playground.paths import GLSL
from playground.shader.parameter import spell
from playground.sketch.assign import check_value, resolve
from playground.sketch.model import Value
from playground.sketch.toml_table import TomlFile

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


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
    return Fence(kind, name, piece, line, file, sketches)


def read_fence(fence: Fence) -> model.Named:
    """Build the block that a fence describes; raise ``SketchError`` at the key that is wrong."""
    return READERS[fence.kind](fence)


def _figure(fence: Fence) -> model.Figure:
    fence.only(model.Figure, *STATE, "sliders")
    scene, sliders = fence.scene(), fence.texts("sliders")
    for path in sliders:
        check_path(fence, scene, path, "sliders")
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
    iterations = fence.take("iterations", list, list(range(most + 1)))
    if not iterations or not all(type(picture) is int and 0 <= picture <= most for picture in iterations):
        message = f"iterations = {spell(iterations)}: expected whole numbers from 0 to {most}"
        raise fence.error(message, "iterations")
    captions = fence.texts("captions")
    if captions and len(captions) != len(iterations):
        raise fence.error(f"captions: {len(captions)} for {len(iterations)} iterations", "captions")
    scenes = tuple(with_steps(scene, dict.fromkeys(passes, picture)) for picture in iterations)
    return fence.block(model.Steps, scenes=scenes, passes=passes, iterations=tuple(iterations))


def _slider(fence: Fence) -> model.Slider:
    fence.only(model.Slider, *STATE, "parameter", "values", "from", "to", "frames")
    scene = fence.scene(FRAME)
    parameter = fence.markdown("parameter")
    check_path(fence, scene, parameter, "parameter")
    values = _swept(fence, scene, parameter)
    scenes = tuple(with_value(scene, parameter, value) for value in values)
    return fence.block(model.Slider, scenes=scenes, parameter=parameter, values=values)


def _swept(fence: Fence, scene: model.Scene, parameter: str) -> tuple[Value, ...]:
    values = fence.take("values", list, None)
    if values is None:
        low, high = (fence.take(key, float, None) for key in ("from", "to"))
        frames = fence.take("frames", int, 9)
        if low is None or high is None or low == high or not 2 <= frames <= 64:
            raise fence.error("a slider needs values = […], or from, to and frames (2 to 64)")
        whole = resolve(scene.sketch.graph, parameter)[0].parameter.type in ("int", "uint")
        values = [low + (high - low) * i / (frames - 1) for i in range(frames)]
        values = [round(v) if whole else float(f"{v:.6g}") for v in values]
    if len(values) < 2:
        raise fence.error("values: a slider has two or more", "values")
    try:
        return tuple(check_value(scene.sketch, parameter, value) for value in values)
    except PlaygroundError as error:
        raise fence.error(error.diagnostics[0].message, "values") from None


def _compare(fence: Fence) -> model.Compare:
    fence.only(model.Compare, *STATE, "variant")
    tables = fence.file.tables("variant")
    if len(tables) < 2:
        raise fence.error("a compare block has two or more [[variant]]")
    scenes = []
    for index, table in enumerate(tables):
        site = ("variant", index)
        fence.file.only(table, STATE, *site)
        scenes.append(read_scene(fence.file, table, site, fence.sketches, under=fence.state))
    labels = fence.texts("labels")
    if len(labels) != len(scenes):
        raise fence.error(f"labels: {len(labels)} for {len(scenes)} variants", "labels")
    if len({scene.pixels for scene in scenes}) > 1:
        raise fence.error("pictures that are compared have one size: set pixels")
    return fence.block(model.Compare, scenes=tuple(scenes))


def _code(fence: Fence) -> model.Code:
    fence.only(model.Code, "file", "anchor")
    return fence.block(model.Code, file=shader(fence), anchor=fence.markdown("anchor"))


def _break(fence: Fence) -> model.Break:
    fence.only(model.Break, *STATE, "file", "find", "put")
    find, put = (fence.take(key, str, "") for key in ("find", "put"))
    return fence.block(model.Break, scene=fence.scene(), file=shader(fence), find=find, put=put)


def _question(fence: Fence) -> model.Question:
    fence.only(model.Question, "right")
    choices, right = fence.texts("choices"), fence.take("right", int, -1)
    if choices and not 0 <= right < len(choices):
        raise fence.error(f"right = {right}: expected the place of a choice, 0 to {len(choices) - 1}")
    if right >= 0 and not choices:
        raise fence.error("right: there are no choices", "right")
    return fence.block(model.Question, right=right)


def _measure(fence: Fence) -> model.Measure:
    fence.only(model.Measure, *STATE, "of", "what", "with", "over", "digits", "unit", "between")
    what, arguments, between = measure_of(fence, fence.file.table)
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
        arguments=arguments,
        digits=digits,
        unit=fence.take("unit", str, ""),
        between=between,
    )


READERS: dict[str, Callable[[Fence], model.Named]] = {
    "figure": _figure,
    "step": _steps,
    "slider": _slider,
    "compare": _compare,
    "code": _code,
    "break": _break,
    "question": _question,
    "exercise": read_exercise,
    "challenge": read_challenge,
    "measure": _measure,
}
"""What reads each kind of block."""
