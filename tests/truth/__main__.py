"""``python tests/truth``: see ``errors``."""

import sys
from pathlib import Path

# By the folder's own name, since other packages may be called "tests".
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from truth.errors import main

main()
