"""List the extras, or check names of some: ``./play add`` asks this."""

from __future__ import annotations

import re
import sys
import textwrap
from collections.abc import Sequence

from playground.errors import nearest
from playground.extras import EXTRAS, requirements


def main(names: Sequence[str]) -> int:
    """Print the extras and their packages, or the names of some, comma-separated; return the exit status."""
    if not names:
        width = max(map(len, EXTRAS)) + 2
        for extra, purpose in EXTRAS.items():
            packages = dict.fromkeys(re.split(r"[^\w.-]", needed)[0] for needed in requirements(extra))
            text = f"{extra:<{width}}{purpose}: {', '.join(packages)}"
            print(textwrap.fill(text, 100, subsequent_indent=" " * width, break_on_hyphens=False))
        return 0
    for name in names:
        if name not in EXTRAS:
            print(f"play: no extra '{name}'{nearest(name, EXTRAS)}", file=sys.stderr)
            return 2
    print(",".join(dict.fromkeys(names)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
