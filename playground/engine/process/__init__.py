"""Worker processes: what draws or compiles for another process, so that what kills it kills nothing else.

A draw that hangs cannot be interrupted inside its own process, some texts crash a driver's
compiler, and asking Mesa for its software renderer changes the environment of a whole process.
So a room that draws what it does not trust names a module of its own, the handler, and has a ``pool``
of processes answer its requests, each with an ``Outcome``. ``child`` is one process as its parent has it,
``worker`` what runs in it.
"""
