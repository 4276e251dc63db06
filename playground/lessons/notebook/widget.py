"""A picture with sliders, in a notebook: dragged there, drawn here."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from playground.errors import PlaygroundError
from playground.lessons.notebook.controls import Control

_HERE = Path(__file__).resolve().parent


class PictureWidget(anywidget.AnyWidget):
    """A PNG, and controls whose every change asks for another.

    ``draw`` takes the controls' values by key, and returns a PNG. A mistake that it raises
    is shown under the picture, which stays.
    """

    _esm = (_HERE / "widget.js").read_text(encoding="utf-8")
    _css = (_HERE / "widget.css").read_text(encoding="utf-8")

    picture = traitlets.Bytes(b"").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    controls = traitlets.List(traitlets.Dict()).tag(sync=True)
    values = traitlets.Dict().tag(sync=True)
    mistake = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self, draw: Callable[[Mapping[str, float]], bytes], controls: Sequence[Control], alt: str = ""
    ) -> None:
        self._draw = draw
        values = {control.key: control.value for control in controls}
        super().__init__(
            picture=draw(values),
            alt=alt,
            controls=[asdict(control) for control in controls],
            values=values,
        )
        self.observe(self._changed, names="values")

    def _changed(self, _: object) -> None:
        try:
            self.picture = self._draw(self.values)
            self.mistake = ""
        except PlaygroundError as error:
            self.mistake = str(error)
        finally:
            self.send({"drawn": True})  # what the browser waits for before it asks for another

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Show the picture where no widgets can be: in a saved notebook, on a page."""
        found = super()._repr_mimebundle_(**kwargs)
        if found is None:
            return None
        data, metadata = found if isinstance(found, tuple) else (found, {})
        return {**data, "image/png": b64encode(self.picture).decode()}, metadata
