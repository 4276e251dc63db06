"""Which pictures pass: each tier's two sides, alpha, crowds at any place, and what no reference excuses."""

from __future__ import annotations

from collections.abc import Iterable
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
    Judgement,
    judge,
    most_crowded,
    unreadable,
)
from playground.verify.shots.references import Fingerprint, Reference, reference_texts

from ...cases import each
from .conftest import OURS, WORDS_FOR_PICTURES

SCREENSHOTS = Path(__file__).resolve().parent.parent.parent.parent / "screenshots"
SIZE = (200, 100)  # pixels; 0.5 % of them are 100
NEWER = replace(OURS, version="4.5 Mesa 25.0.7", vendor="Mesa", mesa="25.0.7")
CARD = Fingerprint(
    renderer="NVIDIA H200/PCIe/SSE2", version="4.6.0 NVIDIA 570.86", vendor="NVIDIA Corporation", drawn="ab12"
)
Places = Iterable[tuple[int, int]]
BASE = np.random.default_rng(7).integers(10, 246, (SIZE[1], SIZE[0], 4), dtype=np.uint8)
EVERYWHERE = [(x, y) for y in range(SIZE[1]) for x in range(SIZE[0])]


def changed(places: Places, by: int, channel: int = 1, base: np.ndarray = BASE) -> np.ndarray:
    array = base.copy()
    for x, y in places:
        array[y, x, channel] = int(array[y, x, channel]) + by
    return array


def scattered(count: int) -> list[tuple[int, int]]:
    """Return places far from each other."""
    return [(x, y) for y in range(2, 100, 9) for x in range(3, 200, 20)][:count]


def block(count: int, x: int = 60, y: int = 40, width: int = 8) -> list[tuple[int, int]]:
    return [(x + i % width, y + i // width) for i in range(count)]


def reference(pixels: np.ndarray, fingerprint: Fingerprint, name: str = "dawn.png") -> Reference:
    return Reference(Path(name), pixels, reference_texts(fingerprint, "hills", "dawn"))


def by(actual: np.ndarray, drawn_by: Fingerprint, expected: np.ndarray = BASE, **wrong: str) -> Judgement:
    judgement, _ = judge(actual, OURS, [reference(expected, drawn_by)], **wrong)
    assert judgement.word in WORDS_FOR_PICTURES
    assert judgement.message.startswith(judgement.word)
    broken = judgement.word in ("nan", "gl-error")
    assert judgement.ok == (judgement.word == "same") == judgement.comparison.ok or broken
    return judgement


# ── one reference of the same renderer ───────────────────────────────────────

SAYS_LESS = {
    "another sketch": replace(OURS, drawn="cd34"),
    "another tool": replace(OURS, tool="tool 2"),
    "another vendor's name": replace(OURS, vendor="Mesa"),
    "says little": replace(OURS, drawn="", cpu="", simd=""),
    "says nothing": Fingerprint(),
}
OTHERS = {
    "version": NEWER,
    "processor": replace(OURS, cpu="AuthenticAMD"),
    "instructions": replace(OURS, simd="avx"),
    "vectors": replace(OURS, renderer="llvmpipe (LLVM 15.0.6, 128 bits)"),
}
VERDICTS = [  # who drew the reference; where the picture differs, and by how much; the word
    *(("ours", EVERYWHERE, step, "same") for step in (-1, 1)),
    *(("ours", [(199, 99)], step, "differs") for step in (-2, 2)),
    *((name, [(5, 5)], 2, "differs") for name in SAYS_LESS),
    *((name, [], 0, "same") for name in (*SAYS_LESS, *OTHERS)),
    *((name, scattered(20), 3, "same") for name in OTHERS),
    ("version", [(17, 80)], -4, "differs"),
    ("version", scattered(100), 2, "same"),
    ("version", scattered(101), 2, "differs"),
    ("version", block(CROWD), 2, "same"),
    ("version", block(CROWD + 1), 2, "crowded"),
]


@each(("drawn_by", "places", "step", "word"), VERDICTS, ids=lambda case: f"{case[0]} {case[2]} {case[3]}")
@each("channel", range(4))
def test_a_tier_lets_pass_what_it_may_in_every_channel(
    drawn_by: str, places: list[tuple[int, int]], step: int, word: str, channel: int
) -> None:
    """Alpha counts as a colour; what was drawn, the tool, the vendor and silence make nothing less strict."""
    builds = {"ours": OURS} | SAYS_LESS | OTHERS
    judgement = by(changed(places, step, channel), builds[drawn_by])
    tier = OTHER_BUILD if drawn_by in OTHERS else SAME_BUILD
    assert (judgement.word, judgement.tier) == (word, tier)
    assert bool(judgement.differences) is (drawn_by != "ours")
    if tier == OTHER_BUILD and places:
        over = judgement.comparison.over
        assert over == len(places)
        limits = {"differs": "3 may" if abs(step) > 3 else "0.5 % may be", "crowded": f"at most {CROWD} may"}
        assert limits.get(word, "another build") in judgement.message
        if places[0] == block(1)[0]:
            assert judgement.crowd is not None and judgement.crowd.count == over


@pytest.mark.parametrize(("x", "y"), [(0, 0), (28, 28), (60, 60), (192, 93), (92, 91)])
def test_a_crowd_is_found_wherever_it_lies(x: int, y: int) -> None:
    judgement = by(changed(block(56, x, y), 2), NEWER)
    assert judgement.word == "crowded"
    assert judgement.crowd is not None
    left, top = judgement.crowd.place
    assert left <= x and x + 8 <= left + 32
    assert top <= y and y + 7 <= top + 32
    assert f"x = {left}, y = {top}" in judgement.message


def test_levels_of_one_do_not_crowd() -> None:
    judgement = by(changed(scattered(10), 2, base=changed(EVERYWHERE, 1)), NEWER)
    assert (judgement.word, judgement.comparison.over) == ("same", 10)


@each("size", [(40, 50), (33, 32), (32, 32), (9, 70), (5, 4), (1, 1)])
@each("share", [0.0, 0.02, 0.6])
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
    actual = changed([(5, 5)], 2)
    references = [reference(BASE, OURS), reference(BASE, NEWER, "dawn.2.png")]
    result, nearest = judge(actual, OURS, references)
    assert not result.ok and nearest is not None
    assert judge(actual, OURS, references[1:])[0].ok


def test_accepted_other_build_picture_passes_within_one_level() -> None:
    actual = changed(block(64), 9)
    references = [reference(BASE, OURS), reference(actual, NEWER, "dawn.2.png")]
    for shift, ok in ((1, True), (2, False)):
        result, nearest = judge(changed([(0, 0)], shift, base=actual), OURS, references)
        assert result.ok is ok
        assert nearest is references[1]


def test_any_other_build_may_match_else_nearest_is_reported() -> None:
    far, near = changed(block(80), 9), changed(scattered(12), 3)
    references = [reference(far, NEWER), reference(near, OTHERS["processor"], "dawn.2.png")]
    for actual, word in ((BASE, "same"), (changed([(1, 1)], 9), "differs")):
        result, nearest = judge(actual, OURS, references)
        assert (result.word, nearest) == (word, references[1])


# ── another renderer ─────────────────────────────────────────────────────────


def shot(name: str) -> np.ndarray:
    sketch, taken = name.split("/")
    return read_png(SCREENSHOTS / sketch / "llvmpipe" / f"{taken}.png")[0]


def by_eye(actual: np.ndarray, expected: np.ndarray) -> Judgement:
    judgement, nearest = judge(actual, CARD, [], [reference(expected, OURS)])
    assert nearest is not None
    assert judgement.word in WORDS_FOR_PICTURES
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
    assert judgement.message.startswith("same in structure: ")
    assert STRUCTURE_ONLY in judgement.message
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
    assert judgement.message.startswith("structure: FLIP ")


def test_other_renderer_within_one_level_is_simply_same() -> None:
    judgement = by_eye(changed(scattered(99), 1), BASE)
    assert (judgement.word, judgement.tier, judgement.perceived) == ("same", OTHER_RENDERER, None)


def test_other_renderer_reference_is_ignored_if_own_exists() -> None:
    base, other = shot("jacksboro/morning"), shot("jacksboro/evening")
    result, nearest = judge(base, CARD, [reference(other, CARD)], [reference(base, OURS)])
    assert (result.word, result.tier) == ("differs", SAME_BUILD)
    assert nearest is not None and nearest.pixels is other


# ── for any reference ───────────────────────────────────────────────────────


@pytest.mark.parametrize("drawn_by", [OURS, NEWER])
def test_gl_error_or_nan_fails_even_identical_picture(drawn_by: Fingerprint) -> None:
    judgement = by(BASE, drawn_by, not_finite="pass 'light': NaN at texel (1, 2)")
    assert (judgement.word, judgement.message) == ("nan", "nan: pass 'light': NaN at texel (1, 2)")
    both = by(BASE, drawn_by, not_finite="NaN", gl_error="GL_INVALID_OPERATION")
    assert both.word == "gl-error"
    assert "GL_INVALID_OPERATION" in both.message
    blank = by(np.zeros_like(BASE), drawn_by, not_finite="NaN")
    assert blank.word == "nan"  # it says more than that nothing is to be seen


NOISY = np.full_like(BASE, 90) + np.random.default_rng(1).integers(0, 2, BASE.shape, dtype=np.uint8)


@each("others", [True, False])
@each(
    ("word", "actual", "expected"),
    [
        *(("blank", blank, blank) for blank in (np.full_like(BASE, 90), NOISY)),
        ("blank", NOISY, None),
        ("size", BASE, BASE[:-1]),
        ("size", BASE, BASE[:, 1:]),
        ("missing", BASE, None),
    ],
    ids=lambda case: case[0],
)
@each("build", [OURS, NEWER])
def test_some_words_are_those_of_every_tier(
    word: str, actual: np.ndarray, expected: np.ndarray | None, build: Fingerprint, others: bool
) -> None:
    there = [] if expected is None else [reference(expected, build)]
    result, nearest = judge(actual, OURS, *(([], there) if others else (there, [])))
    assert (result.word, result.tier) == (word, "")
    assert nearest is None or there


def test_a_reference_that_cannot_be_read_is_its_own_word() -> None:
    result = unreadable(BASE, OURS, "dawn.png: the file is damaged")
    message = "unreadable: dawn.png: the file is damaged"
    assert (result.word, result.ok, result.message) == ("unreadable", False, message)
