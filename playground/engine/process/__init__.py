"""Worker processes: what draws or compiles for another process, so that what kills it kills nothing else.

A draw that hangs cannot be interrupted inside its own process, some texts crash a driver's
compiler, and asking Mesa for its software renderer changes the environment of a whole process.
So a room that draws what it does not trust names a module of its own, the handler, and starts
it in a child process: ``worker`` is the parent's end and ``child`` the other one. They exchange
``messages`` in ``frames``; ``limits`` bounds the child's memory and its life, ``activity_clock``
the time of each thing that it does, and ``crash_report`` says how it ended.
"""
