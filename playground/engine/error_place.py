"""Place an error at the line of the sketch that it comes from."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from playground.errors import DataError, ParameterError, SketchError
from playground.paths import shown
from playground.sketch.model import PassSpec, Shot, Sketch


def placed(error: DataError, sketch: Sketch, spec: PassSpec) -> DataError:
    """Return an error of a data file at the pass that names it, the file in the sentence.

    Where an override set the file, or it was opened itself, the sketch's text is right, and the error
    stays as it is.
    """
    overridden = any(
        path.partition(".")[0] == spec.name and isinstance(value, str) for path, value in sketch.overrides
    )
    if overridden or not spec.file or all(d.file == spec.file for d in error.diagnostics):
        return error
    found = "; ".join(f"{d.place}: {d.message}" if d.place else d.message for d in error.diagnostics)
    return DataError(found, file=spec.file, line=spec.line)


@contextmanager
def located_at(sketch: Sketch, shot: Shot) -> Iterator[None]:
    """Place an error in what a shot sets, as its steps, at the shot's line."""
    try:
        yield
    except ParameterError as error:
        first = error.diagnostics[0]
        if first.file or not shot.line:
            raise
        message = f"shot '{shot.name}': {first.message}"
        raise SketchError(message, file=shown(sketch.file), line=shot.line) from None
