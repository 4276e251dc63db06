"""From a frame to what came of it: which references judge it, what it says, and what is left to look at."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import ContextError, OpenGLFault
from playground.sketch.model import Graph, Shot, Sketch
from playground.verify.shots.judge import OTHER_BUILD, OTHER_RENDERER, SAME_BUILD
from playground.verify.shots.references import fingerprint_of, read_reference, reference_path, write_reference
from playground.verify.shots.suite import (
    Outcome,
    RenderedShot,
    ShotCase,
    check,
    images_of,
    render_shot,
    shots_of,
)

from ...sketch_texts import map_of_height
from .conftest import WORDS_FOR_PICTURES

LLVMPIPE = ContextInfo(450, "llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa/X.org", "4.5 Mesa 22.3.6", 4)
NEWER = ContextInfo(450, "llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa", "4.5 Mesa 25.0.7", 4)
CARD = ContextInfo(460, "NVIDIA H200/PCIe/SSE2", "NVIDIA Corporation", "4.6.0 NVIDIA 570.86", 32)
OTHER_CARD = ContextInfo(460, "AMD Radeon RX 6800 (radeonsi, navi21)", "AMD", "4.6 Mesa 24.0.2", 8)


UPSIDE_DOWN = -1  # in place of a number of levels


@pytest.fixture
def case(tmp_path: Path) -> ShotCase:
    file = tmp_path / "hills.toml"
    file.touch()
    sketch = Sketch("hills", str(file), str(tmp_path), Graph("hills", str(file), ()), shots=(Shot("dawn"),))
    return ShotCase(sketch, sketch.shots[0])


def smooth(by: int = 0) -> np.ndarray:
    """Return a gentle slope, of which ``by`` levels more at one pixel are no defect that anyone sees."""
    array = np.zeros((60, 80, 4), np.uint8)
    array[..., 0] = np.arange(80) * 2
    array[..., 1] = (np.arange(60) * 3)[:, None]
    array[..., 2], array[..., 3] = 60, 255
    array[30, 40, :3] += by if by != UPSIDE_DOWN else 0
    return np.ascontiguousarray(array[::-1]) if by == UPSIDE_DOWN else array


def taken(pixels: np.ndarray, **more: str) -> RenderedShot:
    return RenderedShot(pixels, "hills", **{"drawn": "ab12", **more})


def checked(case: ShotCase, pixels: np.ndarray, renderer: ContextInfo, **more: str) -> Outcome:
    outcome = check(case, taken(pixels, **more), renderer)
    assert outcome.word in WORDS_FOR_PICTURES
    assert outcome.message.startswith(outcome.word)
    assert outcome.ok is (outcome.word == "same")
    return outcome


CHANGED = "the drawn content has changed: the sketch, its shot, a kernel, a value or a file"
VERSIONS = "OpenGL version: 4.5 Mesa 25.0.7; the reference's: 4.5 Mesa 22.3.6"
VERDICTS = [  # the references: who drew them, and pixels; who draws, and pixels; word, tier; whose one judged
    ([], LLVMPIPE, 0, "missing", "", None),
    ([], CARD, 0, "missing", "", None),
    ([(LLVMPIPE, 0)], LLVMPIPE, 1, "same", SAME_BUILD, LLVMPIPE),
    ([(LLVMPIPE, 0)], LLVMPIPE, 2, "differs", SAME_BUILD, LLVMPIPE),
    ([(LLVMPIPE, 0)], NEWER, 3, "same", OTHER_BUILD, LLVMPIPE),
    ([(LLVMPIPE, 0)], NEWER, 4, "differs", OTHER_BUILD, LLVMPIPE),
    ([(LLVMPIPE, 0)], CARD, 40, "same", OTHER_RENDERER, LLVMPIPE),
    ([(LLVMPIPE, 0)], CARD, UPSIDE_DOWN, "structure", OTHER_RENDERER, LLVMPIPE),
    ([(LLVMPIPE, 0), (CARD, 40)], CARD, 40, "same", SAME_BUILD, CARD),
    ([(LLVMPIPE, 0), (CARD, 40)], CARD, 0, "differs", SAME_BUILD, CARD),
    ([(LLVMPIPE, 0), (CARD, 40)], LLVMPIPE, 0, "same", SAME_BUILD, LLVMPIPE),
    ([(CARD, 0)], LLVMPIPE, 0, "missing", "", None),
    ([(CARD, 0)], OTHER_CARD, 0, "missing", "", None),
]


@pytest.mark.parametrize(("references", "renderer", "by", "word", "tier", "judged"), VERDICTS)
def test_a_picture_is_judged_by_its_renderers_references(
    case: ShotCase,
    references: list[tuple[ContextInfo, int]],
    renderer: ContextInfo,
    by: int,
    word: str,
    tier: str,
    judged: ContextInfo | None,
) -> None:
    """Without one, by those of the reference renderer, which no other renderer's replace."""
    for drawn_by, there in references:
        write_reference(case.sketch, "dawn", drawn_by, smooth(there), "ab12")
    result = checked(case, smooth(by), renderer)
    assert (result.word, result.tier, result.reference is None) == (word, tier, judged is None)
    assert result.own_path == reference_path(case.sketch, "dawn", renderer.slug)
    assert result.path == reference_path(case.sketch, "dawn", (judged or renderer).slug)
    assert (VERSIONS in result.differences) is (renderer is NEWER)
    assert result.differences or renderer is not CARD or judged is not LLVMPIPE


def test_the_reference_renderer_is_an_option(case: ShotCase) -> None:
    write_reference(case.sketch, "dawn", CARD, smooth(), "ab12")
    result = check(case, taken(smooth()), LLVMPIPE, reference_renderer="nvidia-h200")
    assert (result.word, result.tier) == ("same", OTHER_RENDERER)


def test_origin_errors_and_what_there_is_to_look_at(case: ShotCase) -> None:
    """What was drawn excuses nothing; a further reference may match; a frame from elsewhere is judged too."""
    path, _ = write_reference(case.sketch, "dawn", LLVMPIPE, smooth(), "cd34")
    assert read_reference(path).fingerprint == fingerprint_of(LLVMPIPE, (80, 60), "cd34")
    result = checked(case, smooth(2), LLVMPIPE)
    assert (result.word, result.tier, result.differences) == ("differs", SAME_BUILD, (CHANGED,))
    for what, word in (("not_finite", "nan"), ("gl_error", "gl-error")):
        broken = checked(case, smooth(), LLVMPIPE, **{what: "GL_INVALID_VALUE"})
        assert broken.word == word and broken.reference is not None  # there is something to look at
    elsewhere = check(case, Frame(smooth()), LLVMPIPE)
    assert (elsewhere.ok, elsewhere.fingerprint.drawn, elsewhere.differences) == (True, "", ())
    images = images_of(checked(case, smooth(90), LLVMPIPE))
    assert list(images) == ["actual", "expected", "difference", "flip"]
    np.testing.assert_array_equal(images["actual"], smooth(90))
    assert images["flip"].shape == smooth().shape
    assert images["flip"][30, 40, 0] > 20 and tuple(images["flip"][5, 5]) == (0, 0, 4, 255)
    smaller = images_of(checked(case, np.ascontiguousarray(smooth()[:-1]), LLVMPIPE))
    assert list(smaller) == ["actual", "expected", "difference"]
    write_png(path.with_name("dawn.2.png"), smooth(90))
    result = checked(case, smooth(90), LLVMPIPE)
    assert (result.ok, result.path) == (True, path.with_name("dawn.2.png"))
    path.unlink()
    path.with_name("dawn.2.png").unlink()
    assert list(images_of(checked(case, smooth(), LLVMPIPE))) == ["actual"]


@pytest.mark.parametrize("damaged", ["dawn.png", "dawn.2.png"])
@pytest.mark.parametrize("renderer", [LLVMPIPE, CARD], ids=["own", "another"])
def test_one_that_cannot_be_read_is_never_passed_over(
    case: ShotCase, damaged: str, renderer: ContextInfo
) -> None:
    path, _ = write_reference(case.sketch, "dawn", LLVMPIPE, smooth(), "ab12")
    path.with_name(damaged).write_bytes(b"no picture")
    result = checked(case, smooth(), renderer)
    assert (result.word, result.path.name, result.reference) == ("unreadable", damaged, None)
    assert damaged in result.message


# ── taking ───────────────────────────────────────────────────────────────────


@pytest.fixture
def drawing(ctx: moderngl.Context) -> Iterator[Engine]:
    with Engine(ctx) as made:
        yield made


def slope(folder: Path) -> ShotCase:
    (folder / "terrain.glsl").write_text(
        '// terrain.glsl -- a slope.\n#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 texel) { return float(texel.x) / 16.0; }\n"
    )
    (folder / "slope.toml").write_text(
        "format = 1\nsize = 16\n" + map_of_height() + '[[shot]]\nname = "one"\nsize = [16, 16]\n'
    )
    return shots_of([folder / "slope.toml"])[0]


def test_a_shot_that_is_taken_knows_what_was_drawn(drawing: Engine, tmp_path: Path) -> None:
    case = slope(tmp_path)
    frame = render_shot(drawing, case)
    assert (frame.not_finite, frame.gl_error, frame.size) == ("", "", (16, 16))
    assert frame.drawn and frame.drawn == render_shot(drawing, case).drawn
    result = check(case, frame, drawing.info)
    assert result.word == "missing"
    write_reference(case.sketch, "one", drawing.info, frame.array, frame.drawn)
    result = check(case, render_shot(drawing, case), drawing.info)
    assert (result.ok, result.differences) == (True, ())


def test_an_opengl_error_left_behind_is_reported(
    drawing: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = slope(tmp_path)
    render_shot(drawing, case)
    render = drawing.render

    def careless(*arguments: object, **named: object) -> Frame:
        frame = render(*arguments, **named)  # type: ignore[arg-type]
        drawing.ctx.enable_direct(0xFFFF)  # no such capability
        return frame

    monkeypatch.setattr(drawing, "render", careless)
    frame = render_shot(drawing, case)
    assert frame.gl_error == "GL_INVALID_ENUM"
    assert check(case, frame, drawing.info).word == "gl-error"


def test_an_opengl_error_within_a_pass_has_its_own_kind(
    drawing: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = drawing.runner.run

    def careless(*arguments: object, **named: object) -> object:
        value = run(*arguments, **named)  # type: ignore[arg-type]
        drawing.ctx.enable_direct(0xFFFF)
        return value

    monkeypatch.setattr(drawing.runner, "run", careless)
    with pytest.raises(OpenGLFault, match="OpenGL reports GL_INVALID_ENUM") as caught:
        render_shot(drawing, slope(tmp_path))
    assert isinstance(caught.value, ContextError)
    assert drawing.ctx.error == "GL_NO_ERROR"
