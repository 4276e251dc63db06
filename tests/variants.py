"""Record fast variants that a test wrote as verified, without drawing them."""

from __future__ import annotations

from pathlib import Path

from playground.allowed_files import canonical_of, is_variant, root_of
from playground.sketch.techniques import Techniques
from playground.sketch.variants import NAME, content_of, written


def trust(folder: Path) -> None:
    """Write the record that says that each fast variant of a folder agrees."""
    entries = {}
    for path in sorted(filter(is_variant, folder.iterdir())):
        owner = canonical_of(path)
        assert owner is not None
        technique = Techniques().read(f"./{owner.stem}", folder, root_of(owner))
        variant = next(v for v in technique.variants if Path(v.path) == path.resolve())
        entries[path.name] = (content_of(technique), content_of(variant.technique))
    (folder / NAME).write_text(written(entries), encoding="utf-8")
