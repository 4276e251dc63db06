"""What the group Terrain sets: metres or feet, where the sun's rows are, cameras, numbered views."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from playground.shader.kernel import TerrainKernel
from playground.sketch.model import Camera, Sketch
from playground.studio.edits.edits import Draft
from playground.studio.panel.parameter_list import Item, items_of
from playground.studio.picture.gestures import suns_of
from playground.studio.session import Session

METRES_IN = {"m": 1.0, "ft": 0.3048}
"""Units that lengths are shown and typed in; the international foot."""
VIEWS = tuple(range(1, 6))
"""The numbers under which views are kept."""
_DAYLIGHT = ("hour", "day", "year", "latitude", "longitude")
_SEA = "sea"  # whether one is drawn
SIZES = (65, 129, 257, 513, 1025, 2049)


@dataclass
class Land:
    """What the group remembers while the window is open: its unit and what is typed."""

    unit: str = "m"
    size_text: str = ""  # that is being typed

    def shown(self, metres: float) -> float:
        """Return metres in the unit."""
        return metres / METRES_IN[self.unit]

    def metres(self, shown: float) -> float:
        """Return what is shown in the unit in metres, in whole millimetres."""
        return round(shown * METRES_IN[self.unit], 3)


def keep_view(session: Session, number: int) -> None:
    """Keep the camera as a numbered view of the sketch, remembered with the user's edits."""
    if session.sketch is not None:
        session.view.views[number] = session.sketch.camera


def recall_view(session: Session, number: int) -> bool:
    """Look from where a numbered view was kept; return whether there is one."""
    camera = session.view.views.get(number)
    if camera is not None:
        session.turn_table(False)
        session.drafts.set_camera(camera)
    return camera is not None


def keep_exaggeration(session: Session) -> None:
    """Make what is shown the sketch's own relief, and show it as it is."""
    relief = session.plan.shown_relief if session.plan is not None else None
    if relief is not None:
        session.drafts.set("relief", relief)
        session.exaggerate(1.0)


def from_above(camera: Camera) -> Camera:
    """Return a camera over the middle of the terrain, as far as shows all of it, with north on top."""
    return replace(camera, azimuth=180.0, elevation=89.0, distance=0.0, target=None)


def north_up(camera: Camera) -> Camera:
    """Return a camera that looks north, from the south of where it looks."""
    return replace(camera, azimuth=180.0)


def aspect_sizes(size: tuple[int, int]) -> list[tuple[int, int]]:
    """Return sizes to choose from, in texels: the longer side is one of ``SIZES``, in the same proportions.

    What is between the texels keeps them: of 65 x 33 the larger is 129 x 65.
    """
    longer, shorter = max(size) - 1, min(size) - 1
    found = []
    for side in SIZES:
        other = round((side - 1) * shorter / longer) + 1 if longer > 0 else side
        found.append((side, other) if size[0] >= size[1] else (other, side))
    return found


def sun_items(draft: Draft) -> list[Item]:
    """Return what sets the sun: hour, day and place where daylight is wired, else azimuth and elevation."""
    items = items_of(draft)
    daylight = [item for item in items.values() if _named(item, _DAYLIGHT) and _is_daylight(item, items)]
    if daylight:
        return sorted(daylight, key=lambda item: _DAYLIGHT.index(item.path.rpartition(".")[2]))
    return [items[path] for path in _directions(draft.sketch) if path in items]


def sea_items(draft: Draft) -> list[Item]:
    """Return what says whether a sea is drawn, where the sketch can have one."""
    return [item for item in items_of(draft).values() if _named(item, (_SEA,))]


def level_items(draft: Draft) -> list[Item]:
    """Return what sets elevations [m], as the sea's: headers say which parameters those are."""
    kernels = draft.sketch.graph.kernels
    leaves = {f"{path}.{kernel.level}" for path, kernel in kernels if isinstance(kernel, TerrainKernel)}
    return [item for item in items_of(draft).values() if item.exported and item.leaf in leaves]


def _named(item: Item, names: tuple[str, ...]) -> bool:
    return item.exported and item.path.rpartition(".")[2] in names


def _is_daylight(item: Item, items: Mapping[str, Item]) -> bool:
    """Return whether a pass counts hours of a place."""
    around = item.path.rpartition(".")[0]
    return f"{around}.hour" in items and f"{around}.latitude" in items


def _directions(sketch: Sketch) -> list[str]:
    return list(suns_of(sketch))
