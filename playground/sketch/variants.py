"""Fast variants: which of them may run in place of a technique, and why another may not.

A technique's canonical form is its plain text. A fast variant of it, a ``.comp`` or the
passes of a ``.fast.toml``, runs only while both texts are those that were found to agree:
their contents (see ``canonical``) are in a record (see ``variant_record``). Techniques are
compared as they are in memory, so a text that replaces a file's counts as well.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from shlex import quote

from playground.paths import shown
from playground.sketch.canonical import content_of
from playground.sketch.identity import Identity
from playground.sketch.model import VARIANTS, Graph, Sketch, Technique, Variant, with_inner


def active_variant(technique: Technique, kinds: Collection[str]) -> Variant | None:
    """Return the fast variant of some ``kinds`` that runs in place of a technique, if one may."""
    found = (v for v in technique.variants if v.kind in kinds and is_verified(technique, v))
    return next(found, None)


def is_verified(technique: Technique, variant: Variant) -> bool:
    """Return whether a technique and its fast variant are those that were found to agree."""
    return variant.verified == (content_of(technique), content_of(variant.technique))


def left_out(sketch: Sketch, kinds: Collection[str] = VARIANTS) -> tuple[str, ...]:
    """Return a sentence for each fast variant of some ``kinds`` that its sketch cannot have run, and why."""
    if sketch.plain:
        return ()
    return _left_out(Identity(sketch.graph), frozenset(kinds))


@lru_cache(maxsize=64)
def _left_out(key: Identity[Graph], kinds: frozenset[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(_sentences(key.object, kinds)))


def _sentences(technique: Technique, kinds: frozenset[str]) -> Iterator[str]:
    other = active_variant(technique, kinds)
    runs = Path(other.path).name if other else "the plain form"
    for variant in technique.variants:
        if variant.kind in kinds and not is_verified(technique, variant):
            yield f"{Path(variant.path).name} is left out, {runs} runs: {why_not(technique, variant)}"
    if isinstance(technique, Graph) and other is None:
        for spec in technique.passes:
            yield from _sentences(spec.technique, kinds)


def why_not(technique: Technique, variant: Variant) -> str:
    """Return why a fast variant that is not verified is not."""
    renew = f"`playground variants renew {quote(shown(variant.path))}` verifies it"
    canonical = Path(technique.path).name
    if not variant.technique.agrees:
        return 'it does not say how closely it agrees, as agrees = "1e-5"'
    if variant.verified is None:
        return f"it was never verified against {canonical}; {renew}"
    if variant.verified[0] == content_of(technique):
        return f"it has changed since it was verified against {canonical}; {renew}"
    what = f"{canonical}, or what it is made of," if isinstance(technique, Graph) else canonical
    return f"{what} has changed since the two were found to agree; {renew} again"


def trusted(technique: Technique) -> Technique:
    """Return a technique whose fast variants count as verified, those of its passes included."""
    if isinstance(technique, Graph):
        technique = with_inner(technique, trusted)
    variants = tuple(
        replace(v, verified=(content_of(technique), content_of(v.technique))) for v in technique.variants
    )
    return replace(technique, variants=variants)


def without_variants(technique: Technique) -> Technique:
    """Return a technique in its canonical form; the same object where it has no fast variants."""
    if not any_variants(technique):
        return technique
    if isinstance(technique, Graph):
        return replace(with_inner(technique, without_variants), variants=())
    return replace(technique, variants=())


def any_variants(technique: Technique) -> bool:
    """Return whether a technique, or one inside it, has fast variants."""
    if technique.variants:
        return True
    return isinstance(technique, Graph) and any(any_variants(spec.technique) for spec in technique.passes)
