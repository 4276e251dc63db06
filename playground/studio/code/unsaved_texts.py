"""Keep what is typed and not saved, in the user's state folder, until it is saved or taken back.

One file a text: JSON with the path, the text, and a hash of the file that it was typed over. It is written
each time that the text is compiled, so that neither a crash nor a quit loses more than the last letters.
"""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from playground.errors import PlaygroundError
from playground.files import read_regular, write_file
from playground.json_text import read_json

FORMAT = 1
_MAX_BYTES = 2**25  # of a file of JSON, whose text may be escaped


@dataclass(frozen=True)
class KeptText:
    """A text that was typed, and when [ns since the epoch]."""

    text: str
    time: int
    over: str  # a hash of the text in the file that it was typed over


def hash_of_text(text: str) -> str:
    """Return a hash of a text."""
    return hashlib.blake2b(text.encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()


class KeptTexts:
    """The texts that are kept; ``folder`` None keeps none."""

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder

    def keep(self, path: Path, text: str, base: str) -> None:
        """Keep what is typed over ``base``, the text of a file; raise ``DataError`` where that fails."""
        if self._folder is None:
            return
        table = {"format": FORMAT, "path": str(path), "over": hash_of_text(base), "text": text}
        self._folder.mkdir(parents=True, exist_ok=True)
        write_file(self._file(path), json.dumps(table).encode())

    def forget(self, path: Path) -> None:
        """Keep nothing of a file any more."""
        if self._folder is not None:
            with suppress(OSError):
                self._file(path).unlink(missing_ok=True)

    def of(self, path: Path) -> KeptText | None:
        """Return what is kept of a file; None for nothing, and for what cannot be read."""
        if self._folder is None:
            return None
        file = self._file(path)
        try:
            status = file.stat()
            table = read_json(read_regular(file).decode()) if status.st_size <= _MAX_BYTES else None
        except (OSError, ValueError, PlaygroundError):
            return None
        if not isinstance(table, dict) or table.get("format") != FORMAT or table.get("path") != str(path):
            return None
        text, over = table.get("text"), table.get("over")
        if not isinstance(text, str) or not isinstance(over, str):
            return None
        return KeptText(text, status.st_mtime_ns, over)

    def _file(self, path: Path) -> Path:
        assert self._folder is not None
        digest = hashlib.blake2b(str(path).encode("utf-8", "surrogatepass"), digest_size=6).hexdigest()
        return self._folder / f"{path.stem[:40]}-{digest}.json"
