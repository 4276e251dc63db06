"""Which pictures pass: each tier's two sides, alpha, crowds at any place, and what no reference excuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.verify.shots.judge import (
    CROWD,
    OTHER_BUILD,
    OTHER_RENDERER,
    SAME_BUILD,
    STRUCTURE_ONLY,
    WORDS,
    Judgement,
    judge,
    most_crowded,
    unreadable,
)
from playground.verify.shots.references import Fingerprint, Reference, reference_texts

from .conftest import OURS

SCREENSHOTS = Path(__file__).resolve().parent.parent.parent.parent / "screenshots"
SIZE = (200, 100)  # pixels; 0.5 % of them are 100
NEWER = replace(OURS, version="4.5 Mesa 25.0.7", vendor="Mesa", mesa="25.0.7")
CARD = Fingerprint(
    renderer="NVIDIA H200/PCIe/SSE2", version="4.6.0 NVIDIA 570.86", vendor="NVIDIA Corporation", drawn="ab12"
)


def picture(seed: int = 7) -> np.ndarray:
    return np.random.default_rng(seed).integers(10, 246, (SIZE[1], SIZE[0], 4), dtype=np.uint8)


def changed(base: np.ndarray, places: object, by: int, channel: int = 1) -> np.ndarray:
    array = base.copy()
    for x, y in places:  # type: ignore[attr-defined]
        array[y, x, channel] = int(array[y, x, channel]) + by
    return array


def scattered(count: int) -> list[tuple[int, int]]:
    """Return places far from each other."""
    return [(x, y) for y in range(2, 100, 9) for x in range(3, 200, 20)][:count]


def block(count: int, x: int = 60, y: int = 40, width: int = 8) -> list[tuple[int, int]]:
    return [(x + i % width, y + i // width) for i in range(count)]


def reference(pixels: np.ndarray, fingerprint: Fingerprint, name: str = "dawn.png") -> Reference:
    return Reference(Path(name), pixels, reference_texts(fingerprint, "hills", "dawn"))


def by(actual: np.ndarray, expected: np.ndarray, drawn_by: Fingerprint, **wrong: str) -> Judgement:
    judgement, _ = judge(actual, OURS, [reference(expected, drawn_by)], **wrong)
    assert judgement.word in WORDS
    assert judgement.sentence.startswith(judgement.word)
    assert judgement.ok == (judgement.word == "same") == judgement.comparison.ok or judgement.word in (
        "nan",
        "gl-error",
    )
    return judgement


# ── the same build ───────────────────────────────────────────────────────────


@pytest.mark.parametrize("channel", range(4))
@pytest.mark.parametrize("step", [-1, 1])
def test_of_the_same_build_one_level_passes_everywhere(channel: int, step: int) -> None:
    base = picture()
    everywhere = [(x, y) for y in range(SIZE[1]) for x in range(SIZE[0])]
    judgement = by(changed(base, everywhere, step, channel), base, OURS)
    assert (judgement.word, judgement.tier, judgement.differences) == ("same", SAME_BUILD, ())


@pytest.mark.parametrize("channel", range(4))
@pytest.mark.parametrize("step", [-2, 2])
def test_of_the_same_build_two_levels_fail_at_one_pixel(channel: int, step: int) -> None:
    base = picture()
    judgement = by(changed(base, [(199, 99)], step, channel), base, OURS)
    assert (judgement.word, judgement.tier) == ("differs", SAME_BUILD)


@pytest.mark.parametrize(
    "reference_says",
    [
        replace(OURS, drawn="cd34"),
        replace(OURS, tool="tool 2"),
        replace(OURS, vendor="Mesa"),
        replace(OURS, drawn="", cpu="", simd=""),
        Fingerprint(),
    ],
    ids=["another sketch", "another tool", "another vendor's name", "says little", "says nothing"],
)
def test_nothing_but_another_build_makes_it_less_strict(reference_says: Fingerprint) -> None:
    base = picture()
    assert by(base, base, reference_says).ok
    judgement = by(changed(base, [(5, 5)], 2), base, reference_says)
    assert (judgement.word, judgement.tier) == ("differs", SAME_BUILD)
    assert judgement.differences


# ── another build ────────────────────────────────────────────────────────────

OTHERS = {
    "version": NEWER,
    "processor": replace(OURS, cpu="AuthenticAMD"),
    "instructions": replace(OURS, simd="avx"),
    "vectors": replace(OURS, renderer="llvmpipe (LLVM 15.0.6, 128 bits)"),
}


@pytest.mark.parametrize("other", OTHERS)
@pytest.mark.parametrize("channel", range(4))
def test_of_another_build_three_levels_pass_at_few_pixels(other: str, channel: int) -> None:
    base = picture()
    judgement = by(changed(base, scattered(20), 3, channel), base, OTHERS[other])
    assert (judgement.word, judgement.tier) == ("same", OTHER_BUILD)
    assert judgement.differences
    assert judgement.crowd is not None
    assert "another build" in judgement.sentence


@pytest.mark.parametrize("channel", range(4))
def test_of_another_build_four_levels_fail_at_one_pixel(channel: int) -> None:
    base = picture()
    judgement = by(changed(base, [(17, 80)], -4, channel), base, NEWER)
    assert (judgement.word, judgement.tier) == ("differs", OTHER_BUILD)
    assert "of another build, 3 may" in judgement.sentence


@pytest.mark.parametrize(("count", "word"), [(100, "same"), (101, "differs")])
def test_other_build_may_differ_in_half_percent_of_pixels(count: int, word: str) -> None:
    base = picture()
    judgement = by(changed(base, scattered(count), 2), base, NEWER)
    assert (judgement.word, judgement.comparison.over) == (word, count)
    if word == "differs":
        assert "0.5 % may be" in judgement.sentence


@pytest.mark.parametrize(("count", "word"), [(CROWD, "same"), (CROWD + 1, "crowded")])
@pytest.mark.parametrize("channel", [0, 3])
def test_of_another_build_pixels_may_not_crowd(count: int, word: str, channel: int) -> None:
    base = picture()
    judgement = by(changed(base, block(count), 2, channel), base, NEWER)
    assert (judgement.word, judgement.tier) == (word, OTHER_BUILD)
    assert judgement.crowd is not None
    assert judgement.crowd.count == count


@pytest.mark.parametrize(("x", "y"), [(0, 0), (28, 28), (60, 60), (192, 93), (92, 91)])
def test_a_crowd_is_found_wherever_it_lies(x: int, y: int) -> None:
    base = picture()
    judgement = by(changed(base, block(56, x, y), 2), base, NEWER)
    assert judgement.word == "crowded"
    assert judgement.crowd is not None
    left, top = judgement.crowd.place
    assert left <= x and x + 8 <= left + 32
    assert top <= y and y + 7 <= top + 32
    assert f"x = {left}, y = {top}" in judgement.sentence


def test_levels_of_one_do_not_crowd() -> None:
    base = picture()
    everywhere = [(x, y) for y in range(SIZE[1]) for x in range(SIZE[0])]
    judgement = by(changed(changed(base, everywhere, 1), scattered(10), 2), base, NEWER)
    assert (judgement.word, judgement.comparison.over) == ("same", 10)


@pytest.mark.parametrize("size", [(40, 50), (33, 32), (32, 32), (9, 70), (5, 4), (1, 1)])
@pytest.mark.parametrize("share", [0.0, 0.02, 0.6])
def test_the_worst_window_is_the_worst_of_all_places(size: tuple[int, int], share: float) -> None:
    over = np.random.default_rng(size[0]).random(size[::-1]) < share
    width, height = min(32, size[0]), min(32, size[1])
    counts = {
        (x, y): int(over[y : y + height, x : x + width].sum())
        for y in range(size[1] - height + 1)
        for x in range(size[0] - width + 1)
    }
    crowd = most_crowded(over)
    assert crowd.count == max(counts.values()) == counts[crowd.place]
    assert crowd.size == (width, height)


# ── several accepted ones ────────────────────────────────────────────────────


def test_same_build_reference_is_not_loosened_by_other_builds() -> None:
    base = picture()
    actual = changed(base, [(5, 5)], 2)
    references = [reference(base, OURS), reference(base, NEWER, "dawn.2.png")]
    result, nearest = judge(actual, OURS, references)
    assert not result.ok
    assert judge(actual, OURS, references[1:])[0].ok
    assert nearest is not None


def test_accepted_other_build_picture_passes_within_one_level() -> None:
    base = picture()
    actual = changed(base, block(64), 9)
    references = [reference(base, OURS), reference(actual, NEWER, "dawn.2.png")]
    for shift, ok in ((1, True), (2, False)):
        result, nearest = judge(changed(actual, [(0, 0)], shift), OURS, references)
        assert result.ok is ok
        assert nearest is references[1]


def test_any_other_build_may_match_else_nearest_is_reported() -> None:
    base = picture()
    far, near = changed(base, block(80), 9), changed(base, scattered(12), 3)
    references = [reference(far, NEWER), reference(near, OTHERS["processor"], "dawn.2.png")]
    result, nearest = judge(base, OURS, references)
    assert (result.ok, nearest) == (True, references[1])
    result, nearest = judge(changed(base, [(1, 1)], 9), OURS, references)
    assert (result.word, nearest) == ("differs", references[1])


# ── another renderer ─────────────────────────────────────────────────────────


def shot(name: str) -> np.ndarray:
    sketch, taken = name.split("/")
    return read_png(SCREENSHOTS / sketch / "llvmpipe" / f"{taken}.png")[0]


def by_eye(actual: np.ndarray, expected: np.ndarray) -> Judgement:
    judgement, nearest = judge(actual, CARD, [], [reference(expected, OURS)])
    assert nearest is not None
    assert judgement.word in WORDS
    return judgement


def softened(base: np.ndarray) -> np.ndarray:
    """Return a picture as another way to smooth edges might leave it."""
    around = base.astype(np.float64)
    around[:, 1:] = 0.75 * around[:, 1:] + 0.25 * base[:, :-1]
    return np.round(around).astype(np.uint8)


SHIPPED = ["jacksboro/morning", "splat/near", "contours/over-the-land"]


@pytest.mark.parametrize("name", SHIPPED)
def test_other_renderer_passes_on_structure_and_reports_it(name: str) -> None:
    base = shot(name)
    judgement = by_eye(softened(base), base)
    assert judgement.comparison.most > 20
    assert (judgement.word, judgement.tier) == ("same", OTHER_RENDERER)
    assert judgement.sentence.startswith("same in structure: ")
    assert STRUCTURE_ONLY in judgement.sentence
    assert any("renderer" in line for line in judgement.differences)


def squared(base: np.ndarray) -> np.ndarray:
    array = base.copy()
    array[200:232, 300:332] = (255, 0, 255, 255)
    return array


def unsealed(base: np.ndarray) -> np.ndarray:
    array = base.copy()
    array[..., 3] = 0
    return array


def half_as_bright(base: np.ndarray) -> np.ndarray:
    return base // np.array([2, 2, 2, 1], np.uint8)


DEFECTS = {
    "a magenta square": squared,
    "no alpha": unsealed,
    "half as bright": half_as_bright,
    "upside down": lambda base: base[::-1],
    "red and blue swapped": lambda base: base[..., [2, 1, 0, 3]],
    "ten pixels aside": lambda base: np.roll(base, 10, axis=1),
}


@pytest.mark.parametrize("defect", DEFECTS)
def test_structural_defects_fail_on_another_renderer(defect: str) -> None:
    base = shot("jacksboro/morning")
    judgement = by_eye(np.ascontiguousarray(DEFECTS[defect](base)), base)
    assert (judgement.word, judgement.tier) == ("structure", OTHER_RENDERER)
    assert judgement.perceived is not None
    assert judgement.sentence.startswith("structure: FLIP ")


def test_other_renderer_within_one_level_is_simply_same() -> None:
    base = picture()
    judgement = by_eye(changed(base, scattered(99), 1), base)
    assert (judgement.word, judgement.tier, judgement.perceived) == ("same", OTHER_RENDERER, None)


def test_other_renderer_reference_is_ignored_if_own_exists() -> None:
    base, other = shot("jacksboro/morning"), shot("jacksboro/evening")
    result, nearest = judge(base, CARD, [reference(other, CARD)], [reference(base, OURS)])
    assert (result.word, result.tier) == ("differs", SAME_BUILD)
    assert nearest is not None and nearest.pixels is other


# ── for any reference ───────────────────────────────────────────────────────


@pytest.mark.parametrize("drawn_by", [OURS, NEWER])
def test_gl_error_or_nan_fails_even_identical_picture(drawn_by: Fingerprint) -> None:
    base = picture()
    judgement = by(base, base, drawn_by, not_finite="pass 'light', output 'light': NaN at texel (1, 2)")
    assert (judgement.word, judgement.sentence) == (
        "nan",
        "nan: pass 'light', output 'light': NaN at texel (1, 2)",
    )
    both = by(base, base, drawn_by, not_finite="NaN", gl_error="GL_INVALID_OPERATION")
    assert both.word == "gl-error"
    assert "GL_INVALID_OPERATION" in both.sentence
    blank = by(np.zeros_like(base), base, drawn_by, not_finite="NaN")
    assert blank.word == "nan"  # it says more than that nothing is to be seen


@pytest.mark.parametrize("noise", [0, 1])
def test_a_picture_of_one_colour_fails_in_every_tier(noise: int) -> None:
    blank = np.full((SIZE[1], SIZE[0], 4), 90, np.uint8)
    blank += np.random.default_rng(1).integers(0, 1 + noise, blank.shape, dtype=np.uint8)
    same = reference(blank, OURS)
    for references, others in (([same], []), ([reference(blank, NEWER)], []), ([], [same]), ([], [])):
        result, _ = judge(blank, OURS, references, others)
        assert (result.word, result.tier) == ("blank", "")


def test_another_size_is_its_own_word_in_every_tier() -> None:
    base = picture()
    for references, others in (([base[:-1]], []), ([], [base[:, 1:]])):
        result, _ = judge(
            base, OURS, [reference(r, OURS) for r in references], [reference(o, OURS) for o in others]
        )
        assert (result.word, result.tier) == ("size", "")


def test_without_a_reference_it_is_missing() -> None:
    result, nearest = judge(picture(), OURS, [])
    assert (result.word, result.tier, nearest) == ("missing", "", None)


def test_a_reference_that_cannot_be_read_is_its_own_word() -> None:
    result = unreadable(picture(), OURS, "dawn.png: the file is damaged")
    assert (result.word, result.ok, result.sentence) == (
        "unreadable",
        False,
        "unreadable: dawn.png: the file is damaged",
    )
