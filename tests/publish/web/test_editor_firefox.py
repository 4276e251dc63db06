"""The editor in Firefox, typed in as it is in Chromium."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .firefox import MISSING, Firefox
from .test_editor_page import (  # noqa: F401  the same tests, with the browser of this module
    WEB,
    folder,
    page,
    test_a_kernel_is_broken_and_repaired,
    test_an_error_in_an_included_file_is_gone_to,
    test_keys_of_the_field,
    test_what_python_reads_is_said_to_have_no_effect_here,
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(MISSING), reason=MISSING),
    pytest.mark.skipif(
        not (WEB / "node_modules" / "esbuild").is_dir(), reason="needs npm ci in playground/publish/web"
    ),
]


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    with Firefox(tmp_path_factory.mktemp("profile")) as firefox:
        firefox.size(1100, 900)
        yield firefox
