"""A block of a lesson in a notebook: live in its browser, else by pictures that the kernel draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import traitlets

from playground.errors import PlaygroundError
from playground.publish.notebook.widget import BROWSER, LiveWidget


class PictureWidget(LiveWidget):
    """A figure, and controls whose values are read and set by key.

    ``draw`` takes the controls' values by key, and returns a PNG: the picture of a saved notebook, and that
    of a browser without WebGL2. A mistake that it raises is shown under the picture, which stays.
    """

    labels = traitlets.List(traitlets.Unicode()).tag(sync=True)  # of a series, one for each scene
    controls = traitlets.List(traitlets.Dict()).tag(sync=True)
    values = traitlets.Dict().tag(sync=True)

    def __init__(
        self,
        draw: Callable[[Mapping[str, float]], bytes],
        controls: Sequence[Mapping[str, Any]],
        alt: str = "",
        *,
        page: str = "",
        labels: Sequence[str] = (),
        language: str = "en",
    ) -> None:
        self.draw = draw
        values = {control["key"]: control["value"] for control in controls}
        super().__init__(
            picture=draw(values),
            alt=alt,
            controls=list(controls),
            values=values,
            page=page,
            labels=list(labels),
            language=language,
        )
        self.observe(self._changed, names="values")

    def _changed(self, _: object) -> None:
        if self.drawn_by == BROWSER:
            return
        try:
            self.picture = self.draw(self.values)
            self.mistake = ""
        except PlaygroundError as error:
            self.mistake = str(error)
        finally:
            self.send({"drawn": True})  # what the browser waits for before it asks for another
