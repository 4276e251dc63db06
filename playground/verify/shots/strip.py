"""A few frames of a film as one picture, and judged frame by frame.

The reference is a contact strip: the frames in rows, from the top left, in a grid as near to square
as it can be; cells that are left over are transparent black. It is a PNG like any other reference, so
that a browser, a diff on a web page and `playground shots review` show all of its frames at once,
where an animated PNG would have to be caught at the right moment.

Each frame is judged as a picture of its own. So a tolerance holds in each, a blank frame is seen
among good ones, and the first that fails is named, with its time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.verify.shots.compare import Comparison, compare
from playground.verify.shots.fingerprint import Fingerprint
from playground.verify.shots.judge import Judgement, Rule, judge
from playground.verify.shots.masking import Mask, hidden
from playground.verify.shots.references import Reference

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
        worst = next((i for i, word in enumerate(words) if word != "same"), None)
    if worst is None:
        worst = max(range(count), key=lambda i: judged[i][0].comparison.most)
    judgement, cell_reference = judged[worst]
    path = cell_reference.path if cell_reference else None
    reference = next((r for r in (*fitting, *alike) if r.path == path), None)
    sentence = judgement.sentence
    if judgement.word not in ("missing", "nan", "gl-error"):  # which are of no frame, or say of which
        word, _, rest = sentence.partition(": ")
        whose = f"frame {worst + 1} of {count}{labels[worst] and f', {labels[worst]}'}"
        sentence = f"{word}: {f'all {count} frames; of ' if judgement.ok else ''}{whose}: {rest}"
        failed = sum(word != "same" for word in words)
        sentence += f"; {failed} of the {count} frames fail" if failed > 1 else ""
    whole = _whole(strip, reference, count, rule)
    return (
        replace(
            judgement,
            comparison=replace(whole, verdict=judgement.comparison.verdict),
            sentence=sentence,
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
