"""While a window is open, no collection of garbage goes through what was imported before."""

from __future__ import annotations

import gc
from types import SimpleNamespace

import pytest

from playground.errors import ContextError
from playground.studio import app


def test_imports_are_frozen_from_gc_while_window_is_open(monkeypatch):
    frozen = []

    def no_window(*_: object) -> None:
        frozen.append(gc.get_freeze_count())
        raise ContextError("no window in this test")

    monkeypatch.setattr(app, "Window", no_window)
    with pytest.raises(ContextError, match="no window"):
        app.run("l_dot_n", fresh=True, sandbox=SimpleNamespace())  # type: ignore[arg-type]
    assert frozen[0] > 10_000
    assert gc.get_freeze_count() == 0
