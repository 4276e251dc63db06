"""Have a mistake point at the line of the sketch that asks for what is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from playground.errors import DataError, ParameterError, SketchError
from playground.paths import shown
from playground.sketch.model import PassSpec, Shot, Sketch


def placed(error: DataError, sketch: Sketch, spec: PassSpec) -> DataError:
    """Return an error of a data file at the pass that names it, the file in the sentence.

    Where a file was set for the pass from outside, the sketch's text is not at fault, and
    the error stays as it is.
    """
    by_hand = any(
        path.partition(".")[0] == spec.name and isinstance(value, str) for path, value in sketch.overrides
    )
    if by_hand or not spec.file:
        return error
    found = "; ".join(f"{d.place}: {d.message}" if d.place else d.message for d in error.diagnostics)
    return DataError(found, file=spec.file, line=spec.line)


@contextmanager
def told_at(sketch: Sketch, shot: Shot) -> Iterator[None]:
    """Have a mistake in what a shot asks for, as its steps, point at the shot."""
    try:
        yield
    except ParameterError as error:
        first = error.diagnostics[0]
        if first.file or not shot.line:
            raise
        message = f"shot '{shot.name}': {first.message}"
        raise SketchError(message, file=shown(sketch.file), line=shot.line) from None
