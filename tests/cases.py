"""Many small cases in one test: each is checked, and one failure names every case that failed.

pytest spends some milliseconds on a test before and after it runs, in both workers and in the
process that reports. For a case that takes less than that, ``@each`` replaces
``@pytest.mark.parametrize``: fixtures are made once for all cases, so they must not
remember what a case did.
"""

from __future__ import annotations

import functools
import inspect
import traceback
from collections.abc import Callable, Iterable
from typing import Any

import pytest


def each(
    names: str | tuple[str, ...],
    cases: Iterable[Any] | Callable[[], Iterable[Any]],
    ids: Callable[[Any], object] = repr,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call the test for every case; fail with the name, the line and the message of each that fails.

    Cases that take long to find are a function, which is called when the test runs.
    """
    arguments = (names,) if isinstance(names, str) else names

    def over_all(test: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(test)
        fixtures = [p for name, p in signature.parameters.items() if name not in arguments]

        @functools.wraps(test)
        def all_cases(**value: Any) -> None:
            failed = []
            result = list(cases() if callable(cases) else cases)
            assert result, "there are no cases"
            for case in result:
                values = (case,) if isinstance(names, str) else case
                try:
                    test(**value, **dict(zip(arguments, values, strict=True)))
                except (Exception, pytest.fail.Exception) as error:
                    failed.append(f"[{ids(case)}] {_described(error, test)}")
            if failed:
                pytest.fail(f"{len(failed)} of {len(result)} cases:\n" + "\n".join(failed), pytrace=False)

        all_cases.__signature__ = signature.replace(parameters=fixtures)  # type: ignore[attr-defined]
        return all_cases

    return over_all


def _described(error: BaseException, test: Callable[..., None]) -> str:
    """Return the line of the test's file where it failed, and why."""
    file = inspect.getsourcefile(inspect.unwrap(test))
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == file]
    why = "".join(traceback.format_exception_only(error)).strip()
    return f"line {lines[-1] if lines else '?'}: {why}"
