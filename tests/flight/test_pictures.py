"""A flight as a sequence of shots: a slope in the morning, lakes from high above, clouds in the evening.

``pictures/tour.jsonl`` is the flight, ``pictures/<renderer>/`` its pictures. To rewrite those
that do not match: ./play test tests/flight/test_pictures.py --shots-update
"""

from __future__ import annotations

from pathlib import Path

import moderngl
import pytest

from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.flight.flight import CACHE_BYTES, fly_again
from playground.flight.record import read_record
from playground.verify.shots.compare import compare

from ..loading import load

HOME = Path(__file__).parent / "pictures"
EVERY = 150


@pytest.mark.slow
def test_the_tour_looks_as_it_should(ctx: moderngl.Context, request: pytest.FixtureRequest) -> None:
    record = read_record(HOME / "tour.jsonl")
    with Engine(ctx, cache_bytes=CACHE_BYTES) as engine:
        folder = HOME / engine.info.slug
        updating = request.config.getoption("--shots-update")
        if not folder.is_dir() and not updating:
            pytest.skip(f"there are no pictures of {engine.info.slug}")
        sketch = load(record.header.sketch).with_values(record.header.values)
        seen = 0
        for flight in fly_again(engine, sketch, record, every=EVERY):
            frame = flight.picture(record.header.size)
            path = folder / f"tour-{flight.craft.steps:03d}.png"
            result = compare(frame.array, read_png(path)[0] if path.is_file() else None)
            if result.verdict != "same" and updating:
                folder.mkdir(exist_ok=True)
                frame.save(path)
            elif result.verdict != "same":
                pytest.fail(f"{path.name}: {result}")
            seen += 1
        assert seen == 4 and flight.hour == 17.5
