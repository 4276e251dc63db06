"""Render shots in a worker process: open the renderer that is wanted, take each shot on it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from playground.engine.context import context_info, open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.child import Parent, Service
from playground.errors import ContextError
from playground.shots.suite import render_shot

if TYPE_CHECKING:
    import moderngl


def open_service(parent: Parent, renderer: str) -> Service:
    """Open a context and an engine on it."""
    context = _open(renderer)
    engine = Engine(context, owns_context=True, notice=silent)
    return Service(partial(render_shot, engine), context_info(context))


def _open(renderer: str) -> moderngl.Context:
    """Open the context: "software", "any", or "either", the first where it is to be had."""
    if renderer == "any":
        return open_context()
    try:
        return open_context(software=True)
    except ContextError:
        if renderer != "either":
            raise
    return open_context()
