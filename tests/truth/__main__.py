"""``python tests/truth``: see ``errors``."""

import sys
from pathlib import Path
from types import ModuleType

# The folder's modules import from the one above, so both need their places in a package; and
# another one may be installed as "tests", which would come before a folder without __init__.py.
package = ModuleType("tests")
package.__path__ = [str(Path(__file__).resolve().parent.parent)]
sys.modules["tests"] = package

from tests.truth.errors import main  # noqa: E402

main()
