"""The library's fast variants: the record of them is fresh, and each agrees within its bound."""

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.verify import verify
from playground.engine.verify_what import subjects
from playground.paths import GLSL
from playground.sketch.canonical import content_of
from playground.sketch.places import is_variant
from playground.sketch.variant_record import NAME, read, written
from playground.sketch.variants import is_verified, why_not


def name_of(variant):
    return Path(variant.path).relative_to(GLSL).as_posix()


SUBJECTS = {name_of(s.variant): s for s in subjects("", Path("no-file-is-named.png"))}
SLOW = {"lighting/horizons.comp", "lighting/sun_sweep.comp"}


def test_the_record_is_fresh():
    """Where this fails, a text has changed: ``playground variants renew`` verifies and records."""
    wrong = [
        why_not(s.technique, s.variant) for s in SUBJECTS.values() if not is_verified(s.technique, s.variant)
    ]
    assert wrong == []
    entries = {n: (content_of(s.technique), content_of(s.variant.technique)) for n, s in SUBJECTS.items()}
    assert read(GLSL / NAME) == entries
    assert (GLSL / NAME).read_text(encoding="utf-8") == written(entries)


def test_every_file_that_is_one_by_its_name_is_one():
    files = {p.relative_to(GLSL).as_posix() for p in GLSL.rglob("*") if is_variant(p)}
    assert files == set(SUBJECTS)
    assert {s.variant.kind for s in SUBJECTS.values()} == {"compute", "passes"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in sorted(SUBJECTS)]
)
def test_it_agrees_within_its_bound(ctx, tmp_path, name):
    """At every size, seed, choice of a menu and end of a slider: see ``engine.verify``."""
    (subject,) = subjects(f"glsl/{name}", tmp_path / "stand-in.png")
    with Engine(ctx) as engine:
        found = verify(engine, subject.variant, subject.technique, subject.places)
    if found.skipped:
        pytest.skip(found.skipped)
    assert found.ok, found.words
    assert found.drawings >= 20
