"""Decide whether a picture passes: by the strictest comparison that its references allow.

    tier               allowed
    same build         a difference of 1 in any channel, alpha included
    another build      a difference of 3; at most 0.5 % of the pixels above 1, and nowhere crowded
    another renderer   the perceived difference (FLIP) under two bounds: structural defects alone
                       show by it, and the outcome says so

`playground.verify.shots.references` says what a build is. What was drawn, and the playground's own
version, never make a comparison less strict. Where one reference was drawn by this very build,
the others do not loosen it: they count where the picture is theirs to within one level, since
someone accepted that picture, and for nothing else.

Some pictures fail before anything is compared, each in its own word: an OpenGL error, a number
that is not finite in a texture that went into it, a picture of one colour.

A shot may declare a tolerance: a picture that differs from its renderer's reference passes by it. It bounds
how much a pixel may differ, and how many pixels may. By these alone a picture without its shadows could
pass a wide one. So two bounds hold for every tolerance, whatever it says:

    scattered or unbiased   In each 32 × 32 pixels, either few differ by more than a level (one in
                            twenty), or what they differ by cancels: the sum of n differences is within
                            6 times the root of the sum of their squares. For independent noise
                            that is six standard deviations, of any distribution that is symmetric.
                            n equal differences reach √n times, more than 6 from 37 pixels on: so a
                            shadow that is lost, or a hue that shifts, fails however faint it is.
    not seen                FLIP is below the bounds between renderers: a pattern that is moved,
                            whose differences cancel too, shows there.

A film is judged frame by frame. Its reference is a contact strip: the frames in rows, from the top left, in a
grid as near to square as it can be; cells that are left over are transparent black. It is a PNG like any
other reference, so that a browser, a diff on a web page and `playground shots review` show all of its
frames at once, where an animated PNG would have to be caught at the right moment. So a tolerance holds in
each frame, a blank one is seen among good ones, and the first that fails is named, with its time.

It reads no files and draws nothing.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.sketch.model import Tolerance
from playground.verify.shots.compare import (
    TOLERANCE,
    Comparison,
    Mask,
    compare,
    hidden,
    shown_alone,
    sums_of_windows,
    worst_window,
)
from playground.verify.shots.flip import TILE, flip
from playground.verify.shots.references import Fingerprint, Reference
from playground.verify.shots.verdicts import VERDICTS

# ── the tolerance that a shot declares ───────────────────────────────────────


OUTLIER_WINDOW = 20
"""One pixel of so many in a window may differ in any way."""

DEVIATIONS = 6.0
"""[standard deviations] By which the sum of the differences in a window may be off zero."""


@dataclass(frozen=True, slots=True)
class Tolerated:
    """Whether a tolerance lets a picture pass."""

    why_not: str  # "" where it does
    crowded: bool = False  # whether it is for differences that lie together


def tolerated(
    actual: NDArray[np.uint8],
    expected: NDArray[np.uint8],
    tolerance: Tolerance,
    bounds: tuple[float, float],
    hidden: int = 0,
) -> Tolerated:
    """Hold a picture to a tolerance, both uint8 (height, width, 4) and of one size.

    ``bounds`` are of FLIP, on average and in the worst tile; ``hidden`` is how many pixels are masked,
    which are the same in both.
    """
    signed = actual.astype(np.int16) - expected
    most = int(np.abs(signed).max())
    if most > tolerance.levels:
        return Tolerated(f"the tolerance allows {tolerance.levels}")
    over = (np.abs(signed) > TOLERANCE).any(axis=2)
    fraction = np.count_nonzero(over) / (over.size - hidden)
    if fraction > tolerance.share:
        return Tolerated(f"the tolerance allows {100 * tolerance.share:g} %")
    if corner := _biased(np.where(over[..., None], signed, 0), over):
        x, y = corner
        return Tolerated(
            f"it is no noise: in the {WINDOW} × {WINDOW} pixels at x = {x}, y = {y} from the top left many "
            "differ, and the same way, which no tolerance lets pass",
            crowded=True,
        )
    seen = flip(actual, expected)
    tile, (x, y) = seen.worst_tile()
    if seen.mean > bounds[0] or tile > bounds[1]:
        return Tolerated(
            f"an eye sees it: FLIP {seen.mean:.3f} on average, {tile:.3f} at x = {x}, y = {y} from the top "
            f"left; with any tolerance at most {bounds[0]:g} and {bounds[1]:g} may be"
        )
    return Tolerated("")


def _biased(signed: NDArray[np.int16], over: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Return x and y of the window whose differences are the most biased, if that is too much."""
    counts = sums_of_windows(over, WINDOW)
    area = min(WINDOW, over.shape[0]) * min(WINDOW, over.shape[1])
    many = counts > area // OUTLIER_WINDOW
    if not many.any():
        return None
    worst, corner = 0.0, (0, 0)
    for channel in np.moveaxis(signed.astype(np.float64), 2, 0):
        sums, squares = sums_of_windows(channel, WINDOW), sums_of_windows(channel * channel, WINDOW)
        ratio = np.where(many, np.abs(sums) / np.sqrt(np.maximum(squares, 1.0)), 0.0)
        if float(ratio.max()) > worst:
            worst = float(ratio.max())
            y, x = divmod(int(ratio.argmax()), ratio.shape[1])
            corner = (x, y)
    return corner if worst > DEVIATIONS else None


# ── one picture ──────────────────────────────────────────────────────────────


SAME_BUILD, OTHER_BUILD, OTHER_RENDERER = "same build", "another build", "another renderer"

OTHER_TOLERANCE = 3
"""[levels of 255] What another build may differ by.

Mesa 22.3.6 and 25.0.7 were 1 apart at most in 219 of the 220 shipped shots, and 3 at one pixel
of the last. A change of processor can be more: without AVX, shadows and reflections fell the
other way at single pixels, by up to 20. Such a picture is accepted as a further one,
``<shot>.2.png``.
"""

OTHER_FRACTION = 0.005
"""Share of the pixels that may differ by more than `TOLERANCE` from another build's."""

WINDOW = 32
"""[pixels] Side of the window in which pixels that differ may not crowd."""

CROWD = 51
"""[pixels] of a window that may differ by more than `TOLERANCE`: one in twenty, ten times the fraction.

Between builds there were 6 at most, roundings that lie along an edge. A square of 8 × 8 pixels that
is a little off is more, and is no rounding.
"""


STRUCTURE_ONLY = "The reference is another renderer's, so this finds structural defects only"

FLIP_MEAN = 0.05
"""Mean FLIP that another renderer's picture may have; renderers were up to 0.035 apart."""

FLIP_TILE = 0.2
"""Mean FLIP that its worst 32 × 32 pixels may have; renderers were up to 0.10 apart."""


@dataclass(frozen=True, slots=True)
class Crowd:
    """The window in which the most pixels differ."""

    count: int  # pixels
    place: tuple[int, int]  # [pixels] x and y of its top left corner, from the picture's
    size: tuple[int, int]  # [pixels] width and height; less than `WINDOW` in a small picture


@dataclass(frozen=True, slots=True)
class Perceived:
    """How different another renderer's picture looks, by FLIP: 0 alike, 1 as different as can be."""

    mean: float  # over the picture
    tile: float  # over its worst 32 × 32 pixels
    place: tuple[int, int]  # [pixels] x and y of their top left corner


@dataclass(frozen=True, eq=False, kw_only=True)
class Rule:
    """What a shot says of its comparison."""

    tolerance: Tolerance | None = None
    mask: Mask | None = None  # of the picture's size
    allow_blank: bool = False

    @property
    def hidden(self) -> int:
        """How many pixels are masked."""
        return 0 if self.mask is None else int(np.count_nonzero(self.mask))


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Whether a picture passes, and why."""

    word: str  # of `VERDICTS`
    comparison: Comparison  # with the nearest reference
    message: str  # what there is to say, beginning with the word
    tier: str = ""  # how strictly it was compared; "": it was not
    fingerprint: Fingerprint = field(default_factory=Fingerprint)  # the picture's
    differences: tuple[str, ...] = ()  # how its origin differs from the reference's, as text
    crowd: Crowd | None = None  # of another build's picture, where pixels differ
    perceived: Perceived | None = None  # of another renderer's
    tolerance: Tolerance | None = None  # that the shot declares
    tolerated: bool = False  # whether it passes by that, and would not without

    @property
    def ok(self) -> bool:
        """Whether the picture passes."""
        return VERDICTS[self.word].passes


def judge(
    actual: NDArray[np.uint8],
    fingerprint: Fingerprint,
    references: Sequence[Reference],
    others: Sequence[Reference] = (),
    *,
    not_finite: str = "",
    gl_error: str = "",
    rule: Rule | None = None,
) -> tuple[Judgement, Reference | None]:
    """Judge a picture, uint8 (height, width, 4), by its renderer's references.

    Where there are none it is judged by ``others``, those of another renderer. ``not_finite`` and
    ``gl_error`` say what is wrong with it, and fail it. Returns with the judgement the
    reference that it is by: one that matches, else the nearest; None where there is none. Raises
    ``DataError`` for an array of another dtype or shape.
    """
    rule = rule or Rule()
    judgement, reference = _nearest(actual, fingerprint, references, others, rule)
    judgement = replace(judgement, tolerance=rule.tolerance, message=_with_rule(judgement, rule))
    wrong = ""
    if gl_error:
        wrong = f"gl-error: drawing it left the OpenGL error {gl_error}, so it is not to be trusted"
    elif not_finite:
        wrong = f"nan: {not_finite}"
    if wrong:
        word = wrong.partition(":")[0]
        return replace(judgement, word=word, message=wrong, tier=""), reference
    return judgement, reference


def _with_rule(judgement: Judgement, rule: Rule) -> str:
    """Return a judgement's message, with what is masked, and whether a tolerance was needed."""
    message = judgement.message
    if judgement.ok and rule.tolerance and judgement.tier in (SAME_BUILD, OTHER_BUILD):
        if judgement.tolerated:
            message = re.sub(f"^({_TOLERABLE})", "same, by the tolerance", message)
        else:
            message += "; the tolerance is not needed"
    if rule.hidden:
        width, height = judgement.comparison.size
        message += f"; {rule.hidden} pixels ({100 * rule.hidden / (width * height):.3g} %) are masked"
    return message


_TOLERABLE = "|".join(word for word, verdict in VERDICTS.items() if verdict.tolerable)


def unreadable(actual: NDArray[np.uint8], fingerprint: Fingerprint, reason: str) -> Judgement:
    """Return the judgement where a reference is there that cannot be read."""
    return Judgement(
        word="unreadable",
        comparison=compare(actual, None),
        message=f"unreadable: {reason}",
        fingerprint=fingerprint,
    )


def most_crowded(over: NDArray[np.bool_], side: int = WINDOW) -> Crowd:
    """Return the window of ``side`` × ``side`` pixels, at any place, in which the most of a mask are set."""
    count, corner, size = worst_window(over, side)
    return Crowd(round(count), corner, size)


def _nearest(
    actual: NDArray[np.uint8],
    fingerprint: Fingerprint,
    references: Sequence[Reference],
    others: Sequence[Reference],
    rule: Rule,
) -> tuple[Judgement, Reference | None]:
    alone = compare(shown_alone(actual, rule.mask), None, allow_blank=rule.allow_blank, hidden=rule.hidden)
    if rule.mask is not None and alone.verdict == "blank":
        return Judgement(
            word="blank",
            comparison=alone,
            message=f"{alone}, except masked areas",
            fingerprint=fingerprint,
        ), next(iter((*references, *others)), None)
    if not references and others:
        perceived = [(_judged_by_eye(actual, fingerprint, other, rule), other) for other in others]
        return min(perceived, key=lambda pair: _distance(pair[0]))
    if not references:
        return Judgement(
            word=alone.verdict, comparison=alone, message=str(alone), fingerprint=fingerprint
        ), None
    own = [fingerprint.same_build(reference.fingerprint) for reference in references]
    judged = []
    for reference, same in zip(references, own, strict=True):
        strict = same or any(own)
        judgement = _judged(actual, fingerprint, reference, same, strict, rule)
        judged.append((_with_tolerance(judgement, actual, reference, rule), reference))
    return min(judged, key=lambda pair: _distance(pair[0]))


def _distance(judgement: Judgement) -> tuple[bool, bool, float, int, int]:
    comparison = judgement.comparison
    by_eye = judgement.perceived.mean if judgement.perceived else 0.0
    return not judgement.ok, comparison.verdict == "size", by_eye, comparison.over, comparison.most


def _with_tolerance(
    judgement: Judgement, actual: NDArray[np.uint8], reference: Reference, rule: Rule
) -> Judgement:
    """Return a judgement by the tolerance that a shot declares, where the usual one lets it fail."""
    if rule.tolerance is None or not VERDICTS[judgement.word].tolerable:
        return judgement
    visible = hidden(actual, reference.pixels, rule.mask)
    bounds = (FLIP_MEAN, FLIP_TILE)
    result = tolerated(visible, reference.pixels, rule.tolerance, bounds, rule.hidden)
    if not result.why_not:
        passed = replace(judgement.comparison, verdict="same")
        return replace(judgement, word="same", comparison=passed, tolerated=True)
    if result.crowded:
        message = judgement.message.replace("differs", "crowded", 1)
        return replace(judgement, word="crowded", message=f"{message}; {result.why_not}")
    return replace(judgement, message=f"{judgement.message}; {result.why_not}")


def _judged(
    actual: NDArray[np.uint8],
    fingerprint: Fingerprint,
    reference: Reference,
    same: bool,
    strict: bool,
    rule: Rule,
) -> Judgement:
    """Judge by one reference of the same renderer; ``strict`` allows one level even of another build."""
    judgement = _by_pixels(actual, fingerprint, reference, SAME_BUILD if same else OTHER_BUILD, rule)
    comparison = judgement.comparison
    if strict or _is_final(comparison):
        return judgement
    most = f"differs: max difference {comparison.most} of 255"
    if comparison.most > OTHER_TOLERANCE:
        return replace(judgement, message=f"{judgement.message}; of another build, {OTHER_TOLERANCE} may")
    crowd = most_crowded(_over(hidden(actual, reference.pixels, rule.mask), reference.pixels))
    judgement = replace(judgement, crowd=crowd)
    fraction = comparison.fraction
    counted = f"{comparison.over} pixels ({100 * fraction:.3g} %) over {TOLERANCE}"
    if fraction > OTHER_FRACTION:
        return replace(
            judgement, message=f"{most}, {counted}; of another build, {100 * OTHER_FRACTION:g} % may be"
        )
    location = f"at x = {crowd.place[0]}, y = {crowd.place[1]}"
    window = (
        f"{crowd.count} of them in the {crowd.size[0]} × {crowd.size[1]} pixels {location} from the top left"
    )
    if crowd.count > CROWD:
        return replace(
            judgement, word="crowded", message=f"crowded: {counted}, {window}; at most {CROWD} may be"
        )
    passed = replace(comparison, verdict="same")
    message = (
        f"same, as another build's: max difference {comparison.most} of 255, {counted}, at most {window}"
    )
    return replace(judgement, word="same", comparison=passed, message=message)


def _judged_by_eye(
    actual: NDArray[np.uint8], fingerprint: Fingerprint, reference: Reference, rule: Rule
) -> Judgement:
    """Judge by a reference of another renderer."""
    judgement = _by_pixels(actual, fingerprint, reference, OTHER_RENDERER, rule)
    comparison = judgement.comparison
    if _is_final(comparison):
        return judgement
    difference = flip(hidden(actual, reference.pixels, rule.mask), reference.pixels)
    tile, corner = difference.worst_tile()
    perceived = Perceived(difference.mean, tile, corner)
    measured = (
        f"FLIP {perceived.mean:.3f} on average, {tile:.3f} in the {TILE} × {TILE} pixels at x = {corner[0]}, "
    )
    measured += f"y = {corner[1]} from the top left"
    if perceived.mean > FLIP_MEAN or tile > FLIP_TILE:
        bounds = f"at most {FLIP_MEAN:g} and {FLIP_TILE:g} may be between renderers"
        message = f"structure: {measured}; {bounds}"
        return replace(judgement, word="structure", message=message, perceived=perceived)
    passed = replace(comparison, verdict="same")
    message = f"same in structure: {measured}. {STRUCTURE_ONLY}"
    return replace(judgement, word="same", comparison=passed, message=message, perceived=perceived)


def _is_final(comparison: Comparison) -> bool:
    """Whether no tier changes the verdict on the pixels."""
    return comparison.ok or not VERDICTS[comparison.verdict].measured


def _by_pixels(
    actual: NDArray[np.uint8], fingerprint: Fingerprint, reference: Reference, tier: str, rule: Rule
) -> Judgement:
    """Return the judgement by `TOLERANCE` alone."""
    visible = hidden(actual, reference.pixels, rule.mask)
    blank = rule.allow_blank or rule.mask is not None  # then it has been looked at
    comparison = compare(visible, reference.pixels, TOLERANCE, allow_blank=blank, hidden=rule.hidden)
    return Judgement(
        word=comparison.verdict,
        comparison=comparison,
        message=str(comparison),
        tier=tier if VERDICTS[comparison.verdict].measured else "",
        fingerprint=fingerprint,
        differences=fingerprint.differences(reference.fingerprint),
    )


def _over(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> NDArray[np.bool_]:
    difference = np.maximum(actual, expected) - np.minimum(actual, expected)
    # The four channels of a pixel as one number: many times faster than any() along an axis of four.
    return np.asarray((difference > TOLERANCE).view(np.uint32)[..., 0] != 0)


# ── a film, as a strip of frames ─────────────────────────────────────────────


Picture = NDArray[np.uint8]


def strip_of(frames: Sequence[Picture]) -> Picture:
    """Return frames, uint8 (height, width, 4), as one picture; raise ``DataError`` where nothing moves."""
    if len(frames) < 2:
        raise DataError(f"an animation is two frames or more; found {len(frames)}")
    for number, frame in enumerate(frames, 1):
        if frame.shape != frames[0].shape:
            sizes = [f"{f.shape[1]} × {f.shape[0]}" for f in (frame, frames[0])]
            raise DataError(f"frame {number} of {len(frames)} is {sizes[0]} pixels, the first {sizes[1]}")
    if all(np.array_equal(frame, frames[0]) for frame in frames):
        raise DataError(f"all {len(frames)} frames are the same picture: nothing moves; check one of them")
    height, width = frames[0].shape[:2]
    columns, rows = _grid(len(frames))
    strip = np.zeros((rows * height, columns * width, 4), np.uint8)
    for cell, frame in zip(_cells(strip, len(frames)), frames, strict=True):
        cell[...] = frame
    return strip


def frame_size(strip: Picture, count: int) -> tuple[int, int]:
    """Return width and height in pixels of each of ``count`` frames of a strip."""
    columns, rows = _grid(count)
    return strip.shape[1] // columns, strip.shape[0] // rows


def repeated(mask: Mask, count: int) -> Mask:
    """Return the mask of a frame as that of a strip of ``count`` frames; empty cells are not hidden."""
    columns, rows = _grid(count)
    whole = np.tile(mask, (rows, columns))
    for cell in _all_cells(whole, count)[count:]:
        cell[...] = False
    return whole


def judge_frames(
    strip: Picture,
    fingerprint: Fingerprint,
    references: Sequence[Reference],
    others: Sequence[Reference] = (),
    *,
    labels: Sequence[str],
    rule: Rule | None = None,
    not_finite: str = "",
    gl_error: str = "",
) -> tuple[Judgement, Reference | None]:
    """Judge a strip frame by frame; otherwise as `judge`, which is told what is wrong with the picture.

    ``labels`` name the frames, as "at 0.5 s". ``rule`` is of one frame.
    """
    rule, count = rule or Rule(), len(labels)
    fitting = [r for r in references if r.pixels.shape == strip.shape]
    alike = [r for r in others if r.pixels.shape == strip.shape]
    if (references or others) and not (fitting or alike):  # of another size
        return judge(strip, fingerprint, references, others, not_finite=not_finite, gl_error=gl_error)
    judged = []
    for number, cell in enumerate(_cells(strip, count)):
        own, foreign = (
            [Reference(r.path, _cells(r.pixels, count)[number], r.text) for r in group]
            for group in (fitting, alike)
        )
        picture = np.ascontiguousarray(cell)
        judged.append(
            judge(picture, fingerprint, own, foreign, not_finite=not_finite, gl_error=gl_error, rule=rule)
        )
    words = [judgement.word for judgement, _ in judged]
    # A blank frame comes first, even where the others only miss a reference: it may not be written.
    worst = next((i for i, word in enumerate(words) if word == "blank"), None)
    if worst is None:
        worst = next((i for i, word in enumerate(words) if not VERDICTS[word].passes), None)
    if worst is None:
        worst = max(range(count), key=lambda i: judged[i][0].comparison.most)
    judgement, cell_reference = judged[worst]
    path = cell_reference.path if cell_reference else None
    reference = next((r for r in (*fitting, *alike) if r.path == path), None)
    message = judgement.message
    if VERDICTS[judgement.word].of_frame:  # else it is of none, or the message says of which
        word, _, rest = message.partition(": ")
        whose = f"frame {worst + 1} of {count}{labels[worst] and f', {labels[worst]}'}"
        message = f"{word}: {f'all {count} frames; of ' if judgement.ok else ''}{whose}: {rest}"
        failed = sum(not VERDICTS[word].passes for word in words)
        message += f"; {failed} of the {count} frames fail" if failed > 1 else ""
    whole = _whole(strip, reference, count, rule)
    return (
        replace(
            judgement,
            comparison=replace(whole, verdict=judgement.comparison.verdict),
            message=message,
            crowd=None,
            perceived=None,
        ),
        reference,
    )


def _whole(strip: Picture, reference: Reference | None, count: int, rule: Rule) -> Comparison:
    if reference is None:
        return compare(strip, None, allow_blank=True)
    mask = None if rule.mask is None else repeated(rule.mask, count)
    visible = hidden(strip, reference.pixels, mask)
    return compare(visible, reference.pixels, allow_blank=True, hidden=rule.hidden * count)


def _grid(count: int) -> tuple[int, int]:
    """Return columns and rows for so many frames."""
    columns = math.ceil(math.sqrt(count))
    return columns, math.ceil(count / columns)


def _cells(strip: Picture, count: int) -> list[Picture]:
    return _all_cells(strip, count)[:count]


def _all_cells(strip: NDArray[Any], count: int) -> list[NDArray[Any]]:
    columns, rows = _grid(count)
    height, width = strip.shape[0] // rows, strip.shape[1] // columns
    return [
        strip[y * height : (y + 1) * height, x * width : (x + 1) * width]
        for y in range(rows)
        for x in range(columns)
    ]
