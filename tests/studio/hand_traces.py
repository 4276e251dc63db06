"""Traces made by hand: a march of three rays, each with its own number of steps."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from playground.engine.trace.model import Call, Event, Trace

FILE = str(Path("/sketch/march.glsl"))
TEXT = """float march(float start) {
    float far = start;
    for (int i = 0; i < 9; i++) {
        far = far * 2.0;
        if (far > 20.0) return far;
    }
    return far;
}

float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int ray = 0; ray < 3; ray++) {
        sum += sqrt(march(float(ray) - 1.0));
    }
    return sum;
}""".split("\n")
HEAD_OF_MARCH, STEPS, FAR, HIT = 1, 3, 4, 5
HEAD_OF_KERNEL, RAYS, SUM = 10, 12, 13


class Recorder:
    """Records events in the order in which a run gives them."""

    def __init__(self, file: str = FILE, text: list[str] = TEXT, shift: int = 0) -> None:
        self.file, self.text, self.shift = file, text, shift
        self.calls: list[Call] = []
        self.events: list[Event] = []
        self.stack: list[int] = []
        self.loops: list[list[int]] = []  # line and iteration of each open loop, of the running call

    def enter(self, function: str, line: int, end: int) -> None:
        caller = self.stack[-1] if self.stack else None
        call = Call(
            len(self.calls), function, self.file, line + self.shift, end + self.shift, caller, len(self.stack)
        )
        self.calls.append(call)
        self.stack.append(call.index)
        self.outer, self.loops = [*getattr(self, "outer", []), self.loops], []
        self.put("enter", function, line, None)

    def put(self, kind: str, name: str, line: int, value: Any) -> None:
        line += self.shift
        around = tuple(at + self.shift for at, _ in self.loops)
        event = Event(
            len(self.events), kind, name, "float", value, self.file, line, 1, 1, self.stack[-1],
            tuple(n for _, n in self.loops), around, -line if kind == "iteration" else line,
            tuple(-at for at in around),
        )  # fmt: skip
        self.events.append(event)
        self.calls[self.stack[-1]].events.append(event)

    def leave(self, name: str, line: int, value: Any) -> None:
        self.put("return", name, line, value)
        self.stack.pop()
        self.loops = self.outer.pop()

    def trace(self, **more: Any) -> Trace:
        return Trace(
            "height", (3, 5), (), {}, {}, True, self.calls, self.events, True, len(self.events),
            ("kernel", "march"), (), {self.file: tuple(self.text)}, **more,
        )  # fmt: skip


def march_trace(factor: float = 2.0, text: list[str] = TEXT, shift: int = 0, file: str = FILE) -> Trace:
    """Return the run of ``TEXT``; ``shift``: lines that were inserted before it."""
    run = Recorder(file, text, shift)
    run.enter("kernel", HEAD_OF_KERNEL, 16)
    run.put("argument", "texel", HEAD_OF_KERNEL, (3, 5))
    total = 0.0
    run.put("set", "sum", 11, total)
    for ray in range(3):
        run.loops = [[RAYS, ray]]
        run.put("iteration", "ray", RAYS, ray)
        far = ray - 1.0
        run.enter("march", HEAD_OF_MARCH, 8)
        run.put("argument", "start", HEAD_OF_MARCH, far)
        run.put("set", "far", 2, far)
        for i in range(9):
            run.loops = [[STEPS, i]]
            run.put("iteration", "i", STEPS, i)
            far *= factor
            run.put("set", "far", FAR, far)
            run.put("condition", "far > 20.0", HIT, far > 20.0)
            if far > 20.0:
                break
        else:
            run.loops = []
        run.leave("march", HIT if far > 20.0 else 7, far)
        root = math.sqrt(far) if far >= 0.0 else math.nan
        total += root
        run.put("set", "sum", SUM, total)
    run.loops = []
    run.leave("kernel", 15, total)
    return run.trace()
