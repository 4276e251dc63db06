"""The page of a sketch in Firefox, driven as it is in Chromium."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.publish.web import fake_page

from .firefox import MISSING, Firefox
from .node import MISSING as NO_NODE
from .test_page_browser import (  # noqa: F401  the same tests, with the pages of this module
    Page,
    no_complaint,
    script,
    test_a_button_is_pressed_while_it_is_held,
    test_a_drag_of_the_pictures_height_turns_half_around,
    test_a_map_is_moved_enlarged_and_read,
    test_ctrl_drag_moves_sun_and_divider_follows_its_drag,
    test_each_widget_sets_its_value,
    test_hostile_texts_stay_texts,
    test_keys_orbit_zoom_and_reset,
    test_pads_are_dragged,
    test_resets_and_undo,
    test_right_and_shift_drags_move_the_target_alike,
    test_search_presets_techniques_iterations,
    test_the_address_holds_the_state_and_brings_it_back,
    test_the_panel_hides_and_the_code_has_its_tab,
    test_wheel_zooms_by_window_notch_and_double_click_resets,
    test_why_rows_are_locked_is_said_once_in_each_group,
)

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING or NO_NODE), reason=MISSING or NO_NODE)]


@pytest.fixture(scope="module")
def wide(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    with Firefox(tmp_path_factory.mktemp("wide")) as made:
        made.size(1280, 757)
        yield made


@pytest.fixture
def page(wide: Firefox, script: Path, tmp_path: Path) -> Iterator[Page]:  # noqa: F811
    made = Page(wide, fake_page.write(script, tmp_path / "page.html", fake_page.page()).as_uri())
    made.open()
    yield made
    no_complaint(made)
