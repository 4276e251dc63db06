"""What one texture costs, made again each time, next to what else makes the same."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from playground.engine.cache import VERSIONS
from playground.extras import install_command
from playground.sketch.variants import any_variants
from playground.verify.bench.peers import PeerSetup, made
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room, changing
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Run, alternate, beyond

FORMS = ("auto", "fragment", "plain")
"""By compute shaders where there are any; without; and in the canonical form, without fast variants."""


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the row's figure: each form of ours, each peer.

    Keys: ``texture``, what is read; ``seeds``, ``suns`` and ``nudged``, what is new each time (see
    ``changing``); ``forms``; and those of the sketch (see ``Room.sketch``). ``part`` is a texture that it is
    made of, whose own time is taken off: each round makes one of another terrain as well.
    """
    options = row.options
    sketch, texture = room.sketch(options, size), str(options["texture"])
    varied = any(any_variants(each.technique) for each in sketch.graph.passes if each.name != "height")
    runs: dict[str, Run] = {}
    parts: dict[str, Run] = {}
    for form in options.get("forms", FORMS):
        if form == "plain" and not varied:
            continue
        engine = room.engine("auto" if form == "plain" else form)
        change = changing(room, options)

        def run(of: str, plain: bool = form == "plain", engine=engine, change=change) -> None:  # type: ignore[no-untyped-def]
            engine.texture(change(sketch).plainly(plain), of)
            engine.ctx.finish()

        runs[form] = partial(run, texture)
        if "part" in options:
            parts[_part_of(form)] = partial(run, str(options["part"]))
    setting = PeerSetup(room, size, options)
    peers = [peer for options in row.peers if (peer := made(setting, options)) is not None]
    for name in setting.missing:
        room.options.say(f"{name} is not installed, and is left out; {install_command('bench')}")
    ours = list(runs)
    runs |= parts
    for _ in range(VERSIONS):  # from then on textures are used again, as while one drags
        for warm_up in runs.values():
            warm_up()
    runs |= {peer.name: peer.run for peer in peers}
    once = [peer.name for peer in peers if peer.once]
    samples = alternate(runs, room.options.rounds, once=once)
    yield Figure(
        row.suite,
        row.name,
        row.what,
        size,
        "ms",
        row.goal,
        {name: beyond(samples[name], samples[_part_of(name)]) if parts else samples[name] for name in ours},
        {peer.name: samples[peer.name] for peer in peers},
        frozenset(peer.name for peer in peers if peer.alone),
    )


def _part_of(form: str) -> str:
    """Return the name of the run that makes the part, of a form."""
    return f"{form}, part"
