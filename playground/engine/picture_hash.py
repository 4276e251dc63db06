"""Return in one hash what a picture is drawn from, the same on every machine and in every year.

It is a pass's key (see ``cache_keys``) with two things smoothed out. A text counts by its tokens, as
the compiler takes it, so that comments, line ends and spaces say nothing. What the engine works
out in floating point, the camera's matrices above all, counts to nine digits, since the last
ones differ between mathematical libraries.

What a file is called and where it lies, and the order of a TOML's tables, say nothing either;
a number, a size, a wire, the form that runs (a plain text or a fast variant, and by which driver)
and a byte of an image do. It explains a picture that differs; by itself it fails no comparison, so a
fast variant that was renewed leaves every reference good whose picture it still draws.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from playground.engine.cache_keys import KeyMaker
from playground.engine.plan import Plan, Step
from playground.shader.reserved_names import MOMENT
from playground.sketch.model import Kernel
from playground.sketch.variants import compiled_text

_DIGITS = 9


def _compiled_text(kernel: Kernel) -> str:
    return compiled_text(kernel.source.code)


class PictureHasher:
    """Computes the hashes; remembers what kernels' texts say."""

    def __init__(self) -> None:
        self._keys = KeyMaker(_compiled_text)

    def hash_of(
        self, plan: Plan, driver: Callable[[Step], str], uniforms_of: Callable[[Step], Mapping[str, Any]]
    ) -> str:
        """Return the hash of what a plan's picture is made from; arguments as ``KeyMaker`` takes them."""

        def smoothed(step: Step) -> dict[str, Any]:
            return {n: value if n == MOMENT else rounded(value) for n, value in uniforms_of(step).items()}

        keys = self._keys.keys_of(plan, driver, smoothed).result(plan.picture.path)
        times = plan.sketch.picture.supersample
        return keys if times == 1 else f"{keys} reduced {times} times"


def rounded(value: Any) -> Any:
    """Return a number, or a tuple of them, to nine digits of the largest; anything else as it is."""
    if isinstance(value, tuple | list):
        most = max((abs(float(v)) for v in value), default=0.0)
        return tuple(_to_digits(float(v), most) for v in value)
    return _to_digits(value, abs(value)) if isinstance(value, float) else value


def _to_digits(value: float, most: float) -> str:
    if most == 0.0:
        return "0"
    share = round(value / most, _DIGITS) + 0.0  # no -0.0
    return f"{share:.{_DIGITS}f} of {most:.{_DIGITS}g}"
