"""Drag a file from another program and drop it on the window under the mouse, by XDND (version 5)."""

from __future__ import annotations

import ctypes
import ctypes.util
import time
from ctypes import Structure, Union, byref, c_char_p, c_int, c_long, c_uint, c_ulong, c_void_p
from pathlib import Path

LIMIT = 60.0  # [s] until the other program has taken it


class _Message(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("sent", c_int), ("display", c_void_p), ("window", c_ulong),
        ("kind", c_ulong), ("format", c_int), ("data", c_long * 5),
    ]  # fmt: skip


class _Request(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("sent", c_int), ("display", c_void_p), ("owner", c_ulong),
        ("requestor", c_ulong), ("selection", c_ulong), ("target", c_ulong), ("property", c_ulong),
        ("time", c_ulong),
    ]  # fmt: skip


class _Answer(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("sent", c_int), ("display", c_void_p), ("requestor", c_ulong),
        ("selection", c_ulong), ("target", c_ulong), ("property", c_ulong), ("time", c_ulong),
    ]  # fmt: skip


class _Event(Union):
    _fields_ = [
        ("type", c_int), ("message", _Message), ("request", _Request), ("answer", _Answer),
        ("pad", c_long * 24),
    ]  # fmt: skip


_CLIENT_MESSAGE, _SELECTION_REQUEST, _SELECTION_NOTIFY = 33, 30, 31


class Source:
    """A window that nobody sees, which offers a file to what is under the mouse."""

    def __init__(self, display: str) -> None:
        self._x = x = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
        x.XOpenDisplay.restype, x.XOpenDisplay.argtypes = c_void_p, [c_char_p]
        for name in ("XDefaultRootWindow", "XCreateSimpleWindow", "XInternAtom"):
            getattr(x, name).restype = c_ulong
        self._display = c_void_p(x.XOpenDisplay(display.encode()))
        assert self._display, f"no display {display}"
        self._root = x.XDefaultRootWindow(self._display)
        nothing = c_ulong(0)
        self._own = x.XCreateSimpleWindow(self._display, c_ulong(self._root), 0, 0, 1, 1, 0, nothing, nothing)
        self._atoms = {
            name: x.XInternAtom(self._display, name.encode(), 0)
            for name in (
                "XdndEnter", "XdndPosition", "XdndStatus", "XdndDrop", "XdndFinished", "XdndSelection",
                "XdndActionCopy", "text/uri-list",
            )
        }  # fmt: skip

    def drop(self, path: Path) -> None:
        """Drag the file over the window under the mouse, and let it go there."""
        x, atoms = self._x, self._atoms
        target, (left, top) = self._under_mouse()
        x.XSetSelectionOwner(self._display, c_ulong(atoms["XdndSelection"]), c_ulong(self._own), c_ulong(0))
        self._send(target, "XdndEnter", 5 << 24, atoms["text/uri-list"], 0, 0)
        self._send(target, "XdndPosition", 0, left << 16 | top, 0, atoms["XdndActionCopy"])
        self._wait(target, "XdndStatus", path)
        self._send(target, "XdndDrop", 0, 0, 0, 0)
        self._wait(target, "XdndFinished", path)

    def close(self) -> None:
        """End it."""
        self._x.XCloseDisplay(self._display)

    def _under_mouse(self) -> tuple[int, tuple[int, int]]:
        root, child = c_ulong(), c_ulong()
        x, y, inner_x, inner_y, mask = c_int(), c_int(), c_int(), c_int(), c_uint()
        places = (byref(v) for v in (root, child, x, y, inner_x, inner_y, mask))
        self._x.XQueryPointer(self._display, c_ulong(self._root), *places)
        assert child.value, "the mouse is over no window"
        return child.value, (x.value, y.value)

    def _send(self, target: int, name: str, *data: int) -> None:
        event = _Event()
        message = event.message
        message.type, message.window = _CLIENT_MESSAGE, target
        message.kind, message.format = self._atoms[name], 32
        message.data[:] = [self._own, *data]
        self._x.XSendEvent(self._display, c_ulong(target), 0, c_long(0), byref(event))
        self._x.XFlush(self._display)

    def _wait(self, target: int, name: str, path: Path) -> None:
        """Wait for a message of the target; meanwhile give it the file where it asks."""
        end, event = time.monotonic() + LIMIT, _Event()
        while time.monotonic() < end:
            while self._x.XPending(self._display):
                self._x.XNextEvent(self._display, byref(event))
                if event.type == _SELECTION_REQUEST:
                    self._give(event.request, path)
                elif event.type == _CLIENT_MESSAGE and event.message.kind == self._atoms[name]:
                    return
            time.sleep(0.01)
        raise AssertionError(f"the window sent no {name} within {LIMIT:g} s")

    def _give(self, asked: _Request, path: Path) -> None:
        text = f"{path.resolve().as_uri()}\r\n".encode()
        self._x.XChangeProperty(
            self._display, c_ulong(asked.requestor), c_ulong(asked.property), c_ulong(asked.target), 8, 0,
            text, len(text),
        )  # fmt: skip
        event = _Event()
        answer = event.answer
        answer.type, answer.requestor, answer.selection = _SELECTION_NOTIFY, asked.requestor, asked.selection
        answer.target, answer.property, answer.time = asked.target, asked.property, asked.time
        self._x.XSendEvent(self._display, c_ulong(asked.requestor), 0, c_long(0), byref(event))
        self._x.XFlush(self._display)
