"""A picture in motion gets as many pixels as are quick enough, and keeps them where fewer gain nothing."""

from __future__ import annotations

import pytest

from .node import Node

# Frames of motions one after another: what a frame takes is a part that follows its pixels, and one that
# does not; the first at a size takes longer, for its textures are made.
MOTIONS = """async (motions, frames, load) => {
  const { createQuality } = await load("figure_map.js"), quality = createQuality();
  return motions.map(([pixels, fixed]) => {
    const found = [];
    quality.begin();
    for (let i = 0; i < frames; i++) {
      const { scale } = quality;
      found.push(scale);
      quality.took(pixels * scale * scale + fixed + (scale === found.at(-2) ? 0 : 40));
    }
    quality.rest();
    return [...found, quality.scale];
  });
}"""


def scales(node: Node, *motions: tuple[float, float], frames: int = 14) -> list[list[float]]:
    """Return the scale of each frame of each motion, and at rest after it."""
    values = node.run(MOTIONS, motions, frames)
    assert isinstance(values, list)
    return values


def test_quick_picture_is_full_size_despite_slow_first_frames(node: Node) -> None:
    [result] = scales(node, (40, 2))
    assert result[-5:] == [1] * 5


def test_a_slow_picture_is_small_from_its_second_frame_on(node: Node) -> None:
    """Not step by step, each slow in its turn; 450 ms of pixels are 60 at about a third of the sides."""
    [result] = scales(node, (450, 0))
    assert result[0] == 1 and all(scale <= 0.35 for scale in result[1:-1])
    assert result[-1] == 1


@pytest.mark.parametrize("fixed", [100, 300])
def test_pixels_are_restored_where_fewer_save_no_time(node: Node, fixed: float) -> None:
    [result] = scales(node, (0, fixed))
    assert result[-6:] == [1] * 6


def test_the_first_frame_at_a_size_decides_nothing(node: Node) -> None:
    """Half the sides would seem to gain nothing, if the making of their textures counted."""
    [result] = scales(node, (90, 12))
    assert result[-2] < 1


def test_another_motion_learns_anew_from_where_the_last_ended(node: Node) -> None:
    first, second, third = scales(node, (450, 0), (0, 300), (450, 0))
    assert first[-2] < 1
    assert second[0] == first[-2] and second[-2] == 1
    assert third[-2] == first[-2]
