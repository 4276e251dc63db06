"""Conditions under which a shot must look the same, and a choice of many of them.

Some are of a whole process: its environment, the folder that it runs in, where the sketch
lies. Others are of one drawing: the driver, how much the engine may cache, what it drew
before. The choice is seeded: the same number of drawings is the same drawings.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

_SEED = 1841
_A_PROCESS = 8  # drawings, at most

_THREADS = ("", "0", "1", "2", "4")  # of llvmpipe; "": as many as it likes
_ENVIRONMENTS = (
    (),
    (("MESA_GL_VERSION_OVERRIDE", "4.1"),),
    (("MESA_SHADER_CACHE_DISABLE", "true"),),
    (("LC_ALL", "C"),),
    (("LC_ALL", "de_DE.UTF-8"),),  # a comma in place of the decimal point
    (("LC_ALL", "tr_TR.UTF-8"),),  # i and I are no pair
    (("PYTHONHASHSEED", "1"),),
    (("TZ", "Pacific/Chatham"),),
)
_BEFORE = ("", "", "the same", "another shot", "all shots", "a smaller picture", "another camera", "a mutant")


@dataclass(frozen=True, slots=True)
class Drawing:
    """How the shot is drawn once."""

    driver: str = "auto"
    fresh: bool = False  # by a new engine; else by the one of the drawing before
    cache_bytes: int = 0  # of the new engine's cache; 0: as usual
    before: str = ""  # what is drawn before it by the same engine
    commented: bool = False  # comments and blank lines are put into its shaders

    @property
    def words(self) -> str:
        """What is unusual about it."""
        return _listed(
            f"driver {self.driver}" if self.driver != "auto" else "",
            "new engine" if self.fresh else "",
            f"caches {self.cache_bytes // 2**20} MiB" if self.cache_bytes else "",
            f"after {self.before}" if self.before else "",
            "comments edited" if self.commented else "",
        )


@dataclass(frozen=True, slots=True)
class Process:
    """Drawings that one process does, one after the other."""

    drawings: tuple[Drawing, ...]
    environment: tuple[tuple[str, str], ...] = ()
    elsewhere: bool = False  # it runs in another folder
    moved: bool = False  # the sketch lies in another folder
    cold: bool = False  # the driver's shader cache is empty

    @property
    def all_forms(self) -> bool:
        """Whether it may have compute shaders, where there are any."""
        return "MESA_GL_VERSION_OVERRIDE" not in dict(self.environment)

    @property
    def words(self) -> str:
        """What is unusual about it."""
        return _listed(
            *(f"{name}={value}" for name, value in self.environment),
            "in another folder" if self.elsewhere else "",
            "sketch moved" if self.moved else "",
            "cold shader cache" if self.cold else "",
        )


def _listed(*conditions: str) -> str:
    return ", ".join(filter(None, conditions)) or "as usual"


def processes(count: int, drivers: tuple[str, ...]) -> list[Process]:
    """Choose so many drawings, by these drivers, and share them out among processes."""
    randomness = random.Random(_SEED)
    result: list[Process] = []
    left = count
    while left > 0:
        number = len(result)  # environments alternate, so that a few processes have most of them
        threads = _THREADS[number % len(_THREADS)]
        environment = _ENVIRONMENTS[number % len(_ENVIRONMENTS)]
        if threads:
            environment = (*environment, ("LP_NUM_THREADS", threads))
        drawings = [_drawing(randomness, drivers) for _ in range(min(left, _A_PROCESS))]
        moved, elsewhere, cold = (randomness.random() < part for part in (0.3, 0.5, 0.2))
        result.append(Process(tuple(drawings), environment, elsewhere, moved, cold))
        left -= len(drawings)
    return result


def _drawing(randomness: random.Random, drivers: tuple[str, ...]) -> Drawing:
    return Drawing(
        randomness.choice(drivers),
        randomness.random() < 0.4,
        randomness.choice((0, 0, 1, 16)) * 2**20,
        randomness.choice(_BEFORE),
        randomness.random() < 0.25,
    )
