"""What every live figure of a notebook has: its page, its picture, who draws it, how it is saved."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import anywidget
import traitlets

from playground.publish.notebook.saved import STATE, saved_figure, shipped_runtime
from playground.publish.web.bundle import read_bundle

BROWSER = "browser"
KERNEL = "kernel"


class LiveWidget(anywidget.AnyWidget):
    """A figure that the browser's runtime draws, or else the kernel; both have the same values.

    ``page`` is what the runtime needs (gzip in base64), "" where no page can run the figure. ``picture`` is
    a PNG: what is shown until something is drawn, and where there are no widgets. ``mistake`` is a message
    under the picture, "" for none. ``drawn_by`` is "browser" or "kernel" once the figure is shown, and
    ``why`` says why it is the kernel.
    """

    _esm = read_bundle("notebook.js")
    _css = read_bundle("notebook.css")

    kind = traitlets.Unicode("block").tag(sync=True)
    page = traitlets.Unicode("").tag(sync=True)
    language = traitlets.Unicode("en").tag(sync=True)
    picture = traitlets.Bytes(b"").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    mistake = traitlets.Unicode("").tag(sync=True)
    drawn_by = traitlets.Unicode("").tag(sync=True)
    why = traitlets.Unicode("").tag(sync=True)

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Show the figure, or its picture, where no widgets can be: in a saved notebook, on a page."""
        bundle = super()._repr_mimebundle_(**kwargs)
        if bundle is None:
            return None
        data, metadata = bundle if isinstance(bundle, tuple) else (bundle, {})
        shown = {**data, "image/png": b64encode(self.picture).decode()}
        if self.page:
            state = self.get_state([name for name in STATE if name in self.keys])
            shown["text/html"] = str(saved_figure(state, self.picture, shipped_runtime()))
        return shown, metadata
