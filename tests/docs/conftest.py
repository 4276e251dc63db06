"""What the tests of the documentation share."""

from __future__ import annotations

import sys
from pathlib import Path

# MkDocs finds the generators beside its hooks; so do these tests.
sys.path.append(str(Path(__file__).resolve().parents[2] / "docs"))
