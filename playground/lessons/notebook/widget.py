"""A figure with sliders in a notebook: live in its browser, else by pictures that the kernel draws."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import anywidget
import traitlets

from playground.errors import PlaygroundError
from playground.lessons.notebook.controls import Control
from playground.lessons.notebook.saved import STATE, saved_figure, shipped_runtime
from playground.web.bundle import read_bundle


class PictureWidget(anywidget.AnyWidget):
    """A figure, and controls whose values are read and set by key.

    ``page`` is what the browser's runtime needs (gzip in base64), "" where no page can run the figure.
    ``draw`` takes the controls' values by key, and returns a PNG: the picture of a saved notebook, and
    that of a browser without WebGL2. A mistake that it raises is shown under the picture, which stays.
    """

    _esm = read_bundle("notebook.js")
    _css = read_bundle("notebook.css")

    page = traitlets.Unicode("").tag(sync=True)
    language = traitlets.Unicode("en").tag(sync=True)
    labels = traitlets.List(traitlets.Unicode()).tag(sync=True)  # of a series, one for each scene
    live = traitlets.Bool(False).tag(sync=True)  # the browser draws: no picture is waited for
    picture = traitlets.Bytes(b"").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    controls = traitlets.List(traitlets.Dict()).tag(sync=True)
    values = traitlets.Dict().tag(sync=True)
    mistake = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self,
        draw: Callable[[Mapping[str, float]], bytes],
        controls: Sequence[Control],
        alt: str = "",
        *,
        page: str = "",
        labels: Sequence[str] = (),
        language: str = "en",
    ) -> None:
        self._draw = draw
        values = {control.key: control.value for control in controls}
        super().__init__(
            picture=draw(values),
            alt=alt,
            controls=[asdict(control) for control in controls],
            values=values,
            page=page,
            labels=list(labels),
            language=language,
        )
        self.observe(self._changed, names="values")

    def _changed(self, _: object) -> None:
        if self.live:
            return
        try:
            self.picture = self._draw(self.values)
            self.mistake = ""
        except PlaygroundError as error:
            self.mistake = str(error)
        finally:
            self.send({"drawn": True})  # what the browser waits for before it asks for another

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Show the figure, or its picture, where no widgets can be: in a saved notebook, on a page."""
        found = super()._repr_mimebundle_(**kwargs)
        if found is None:
            return None
        data, metadata = found if isinstance(found, tuple) else (found, {})
        shown = {**data, "image/png": b64encode(self.picture).decode()}
        if self.page:
            state = {name: getattr(self, name) for name in STATE}
            shown["text/html"] = str(saved_figure(state, self.picture, shipped_runtime()))
        return shown, metadata
