"""Keyframes written into a sketch's text: what they say changes, and nothing else."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest

from playground.errors import PlaygroundError, SketchError
from playground.sketch.model import Keyframe, Sketch
from playground.studio.save.sketch_file import _without_lines, save_keyframes, with_keyframes

from ..loading import load

SKETCH = """format = 1  # ours
size = 33
# The morning.
[[keyframe]]
time = 0.0    # at once
camera = { azimuth = 230.0, distance = 4000.0 }
[keyframe.set]
"light.sun" = { azimuth = 95.0, elevation = 8.0 }
"light.gain" = 2   # bright

[[pass]]
name = "height"
use = "generation/white_noise"

[[pass]]
name = "light"
use = "lighting/l_dot_n"

# Noon,
# and it is hot.
[[keyframe]]
time = 4.0
set = { "light.gain" = 1.5 }
ease = "hold"

[[shot]]
name = "late"
time = 3.0
"""
NEW = """[[keyframe]]
time = 2.25
camera = { azimuth = 10 }
set = { "light.gain" = 1.0 }
ease = "linear"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "sketch.toml"
    path.write_text(SKETCH, encoding="utf-8")
    return path


def saved(path: Path, *expected: Keyframe) -> str:
    save_keyframes(load(path), expected)
    assert _without_lines(load(path).keyframes) == _without_lines(sorted(expected, key=lambda k: k.time))
    return path.read_text(encoding="utf-8")


def test_keyframe_time_ease_and_value_are_overwritten_in_place(file: Path) -> None:
    first, second = load(file).keyframes
    assert saved(file, first, replace(second, time=5.5)) == SKETCH.replace("time = 4.0", "time = 5.5")
    first, second = load(file).keyframes
    text = saved(file, replace(first, ease="linear"), replace(second, ease="smooth", time=4.0))
    assert 'ease = "smooth"' in text and 'ease = "linear"' in text and "# at once" in text
    file.write_text(SKETCH, encoding="utf-8")
    first, second = load(file).keyframes
    values = dict(first.values) | {"light.gain": 3.0}
    text = saved(file, replace(first, values=tuple(values.items())), second)
    assert text == SKETCH.replace('"light.gain" = 2 ', '"light.gain" = 3 ')


def test_one_that_moves_past_another_takes_its_comments_along(file: Path) -> None:
    first, second = load(file).keyframes
    text = saved(file, replace(first, time=9.0), second)
    assert text.index("# and it is hot.") < text.index("[[pass]]") < text.index("# The morning.")
    assert "# The morning.\n[[keyframe]]\ntime = 9.0    # at once\n" in text
    assert all(text.count(line) == SKETCH.count(line) for line in SKETCH.split("\n") if line.startswith("#"))
    again = [replace(k, time=0.0) if k.time == 9.0 else k for k in load(file).keyframes]
    assert saved(file, *again).strip() == SKETCH.strip()


def test_a_new_one_comes_in_and_one_goes_out_with_its_comments(file: Path) -> None:
    first, second = load(file).keyframes
    new = Keyframe(2.25, (("azimuth", 10.0),), (("light.gain", 1.0),), "linear")
    text = saved(file, first, second, new)
    assert NEW in text
    text = saved(file, *(k for k in load(file).keyframes if k.time != 2.25))
    assert "2.25" not in text and "# at once" in text and "# and it is hot." in text
    text = saved(file, load(file).keyframes[0])
    assert "and it is hot" not in text and text.count("[[keyframe]]") == 1 and "[[shot]]" in text
    text = saved(file)
    assert "keyframe" not in text and "morning" not in text
    assert "\n\n\n" not in text and text.startswith("format = 1  # ours\nsize = 33\n")
    assert saved(file, new).endswith(NEW)


def test_windows_line_ends_and_no_end_of_line_stay(file: Path) -> None:
    file.write_bytes(SKETCH.rstrip("\n").replace("\n", "\r\n").encode())
    first, second = load(file).keyframes
    save_keyframes(load(file), [first, second, Keyframe(7.0, values=(("light.gain", 1.0),))])
    data = file.read_bytes()
    assert data.count(b"\n") == data.count(b"\r\n") and len(load(file).keyframes) == 3


@pytest.mark.parametrize("seed", range(8))
def test_any_change_is_what_it_says_and_leaves_the_rest_alone(file: Path, seed: int) -> None:
    """Against an independent truth: the file loaded again, and every line that is no keyframe's."""
    rng = random.Random(seed)
    rest = [
        line
        for line in SKETCH.split("\n")
        if line.startswith(("format", "size", "name", "use", "[[pass", "[[shot"))
    ]
    for _ in range(6):
        keyframes = list(load(file).keyframes)
        for keyframe in keyframes[:]:
            share = rng.random()
            if share < 0.2:
                keyframes.remove(keyframe)
            elif share < 0.5:
                keyframes[keyframes.index(keyframe)] = replace(keyframe, time=round(rng.random() * 20, 2))
            elif share < 0.7:
                keyframes[keyframes.index(keyframe)] = replace(keyframe, ease=rng.choice(["hold", "linear"]))
            elif share < 0.8 and keyframe.values:
                keyframes[keyframes.index(keyframe)] = replace(
                    keyframe, values=(("light.gain", rng.random()),)
                )
        if rng.random() < 0.6:
            keyframes.append(
                Keyframe(30 + round(rng.random() * 20, 2), (("elevation", 20.0 + rng.random()),))
            )
        text = saved(file, *keyframes)
        lines = iter(text.split("\n"))
        assert all(line in lines for line in rest), text


def test_what_cannot_be_written_leaves_the_file(file: Path) -> None:
    first, second = load(file).keyframes
    with pytest.raises(SketchError, match="at 4 s already"):
        save_keyframes(load(file), [first, replace(second, time=4.0), replace(first, time=4.0)])
    with pytest.raises(PlaygroundError):
        save_keyframes(load(file), [first, replace(second, values=(("light.nothing", 1.0),))])
    assert file.read_text(encoding="utf-8") == SKETCH
    listed = "format = 1\nkeyframe = [ { time = 1.0, camera = { azimuth = 1.0 } } ]\n"
    file.write_text(listed + SKETCH.partition("\n\n")[2].partition("# Noon")[0], encoding="utf-8")
    sketch: Sketch = load(file)
    assert len(sketch.keyframes) == 1
    with pytest.raises(SketchError, match=r"written as one list"):
        save_keyframes(sketch, [])


def test_a_header_in_a_text_is_none(file: Path) -> None:
    text = SKETCH.replace("size = 33\n", 'size = 33\ntitle = """\n[[keyframe]]\n"""\n')
    file.write_text(text, encoding="utf-8")
    result = load(file)
    assert with_keyframes(text, result, result.keyframes) == text
