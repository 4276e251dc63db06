"""Every picture of every lesson, against its reference.

A picture that is a shot of its sketch and nothing else has its reference there. The others
are drawn a third as large each way, which is enough to tell them from others. Of a series, whose
pictures differ in one value, three are drawn: the first, one in the middle, the last.
"""

from __future__ import annotations

import pytest

from playground.course.read import read_lesson, summaries
from playground.course.scenes import pictures_in, pictures_of

LESSONS = [summary.name for summary in summaries()]


def check(shot, lesson, pictures):
    """Compare pictures; say of all what is wrong, not of the first."""
    wrong = []
    for picture in pictures:
        scene = picture.smaller().scene
        frame = shot.render(scene.sketch, size=scene.pixels, time=scene.time, steps=dict(scene.steps))
        try:
            shot.check(frame, f"{lesson}-{picture.name}")
        except AssertionError as error:
            wrong.append(f"{picture.name}: {error}")
    assert not wrong, "\n".join(wrong)


def three_of(pictures):
    return pictures if len(pictures) <= 3 else [pictures[0], pictures[len(pictures) // 2], pictures[-1]]


def own(name):
    result = [three_of(list(pictures_in(block))) for block in read_lesson(name).blocks]
    return [picture for pictures in result for picture in pictures if not picture.scene.plain]


@pytest.mark.slow
@pytest.mark.parametrize("name", LESSONS)
def test_pictures(shot, name):
    check(shot, name, own(name))


def test_what_is_left_to_shots_is_one():
    """Of a lesson's picture that is a shot of its sketch, that sketch's test compares the reference."""
    for name in LESSONS[:2]:
        for picture in pictures_of(read_lesson(name)):
            if picture.scene.plain:
                sketch = picture.scene.sketch
                assert picture.scene.shot in [shot.name for shot in sketch.shots]
                shot = sketch.shot(picture.scene.shot)
                assert (shot.size, shot.time, shot.steps) == (
                    picture.scene.pixels,
                    picture.scene.time,
                    picture.scene.steps,
                )
