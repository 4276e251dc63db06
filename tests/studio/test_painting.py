"""Painting on masks: the brush by mouse and keys, where a stroke goes, how it is saved and undone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.data.image_files import read_image, read_png, write_png
from playground.engine.engine import Engine
from playground.engine.file_sources import read_mask
from playground.errors import DataError, ShaderError
from playground.studio.mouse import PictureMouse
from playground.studio.paint.brush import ERASER, Brush, Dab, cover
from playground.studio.paint.layer import MAX_TEXELS, NUMBERS, WEIGHTS, Layer
from playground.studio.paint.painting import Painting
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import passes
from .panel_desk import Bare, PictureDesk
from .session_desk import OpenSession

FILES = {
    "sketch.toml": 'format = 1\nsize = 65\nextent = 1000.0\nrelief = 200.0\nmain = ["height.amount"]\n'
    + passes(
        hills="generation/layered_noise",
        rain="erosion/painted_factor",
        mask="texturing/alpha_map/mask",
        height="generation/sculpted",
    ).replace('use = "generation/sculpted"', 'use = "generation/sculpted"\ninputs = { height = "hills" }')
    + '[view]\nuse = "view/terrain"\nsamples = 1\n'
    + "camera = { azimuth = 180, elevation = 89, distance = 900 }\n"
}
_K = imgui.Key
AREA = (0.0, 0.0, 1280.0, 720.0)
Act = Callable[..., None]


@pytest.fixture
def act(bare: Bare, tmp_path: Path) -> Iterator[Act]:
    """Give a function that draws a frame of the picture's mouse at (700, 360)."""
    painting, io = bare.bench.painting, imgui.get_io()
    painting.folder, painting.now = tmp_path, lambda: bare.time
    hand = PictureMouse(bare.bench)

    def frame(*, down: bool = False, wheel: float = 0.0, keys: tuple[imgui.Key, ...] = ()) -> None:
        bare.time += 0.05
        io.add_mouse_pos_event(700, 360)
        io.add_mouse_button_event(0, down)
        for key in keys:
            io.add_key_event(key, True)
        io.add_mouse_wheel_event(0.0, wheel)
        imgui.new_frame()
        hand.act(AREA, 1.0)
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)
        bare.session.frame((48, 32))
        for key in keys:
            io.add_key_event(key, False)

    yield frame


def test_the_wheel_and_keys_change_the_brush(bare: Bare, act: Act) -> None:
    painting = bare.bench.painting
    before = painting.brush
    bare.type("]")
    assert painting.brush == before, "the brush is not taken"
    bare.key(_K.b)
    first, camera = painting.brush, bare.session.sketch.camera
    act(wheel=1.0, keys=(_K.mod_ctrl,))
    assert painting.brush.radius == pytest.approx(first.radius * 1.1)
    act(wheel=-2.0, keys=(_K.mod_shift,))
    assert painting.brush.strength == pytest.approx(first.strength - 0.1)
    act(wheel=1.0, keys=(_K.mod_ctrl, _K.mod_shift))
    assert painting.brush.softness == pytest.approx(first.softness + 0.05)
    assert bare.session.sketch.camera == camera, "the wheel was the brush's"
    bare.run_frames(2)  # Ctrl and Shift are up
    bare.type("[}<")
    assert painting.brush.radius == pytest.approx(first.radius)
    assert painting.brush.strength == pytest.approx(first.strength - 0.05)
    assert painting.brush.softness == pytest.approx(first.softness)
    bare.type("[" * 60 + "}" * 40 + "<" * 40)
    assert painting.brush.radius == pytest.approx(2.0) and painting.brush.strength == 1
    assert painting.brush.softness == 0
    act(wheel=1.0)
    assert bare.session.sketch.camera != camera


def test_the_panel_offers_tools_for_heights_and_layers_for_masks(bare: Bare) -> None:
    painting = bare.bench.painting
    bare.key(_K.b)
    assert set(painting.targets) == {"height.image", "rain.image", "mask.image"}
    for target, row, other in (
        ("height.image", "##tool", "##layer"),
        ("rain.image", "##tool", "##layer"),
        ("mask.image", "##layer", "##tool"),
    ):
        painting.choose(target)
        bare.places.clear()
        bare.run_frames(2)
        assert row in bare.places and other not in bare.places and "##target" in bare.places
        bare.type("4")
        assert (painting.brush.tool == "flatten") == (row == "##tool")
        bare.run_frames(1)
        assert ("##stated" in bare.places) == (row == "##tool")
        bare.type("7")
        assert (painting.brush.tool == "erode") == (target == "height.image"), "a factor has no ground"
        bare.type("1")


def test_held_brush_paints_without_mouse_motion(bare: Bare, act: Act) -> None:
    painting = bare.bench.painting
    bare.key(_K.b)
    painting.choose("height.image")
    heights = []
    act()
    for _ in range(4):
        act(down=True)
        assert painting.layer is not None and painting.layer.kind is NUMBERS
        heights.append(float(painting.layer.pixels.max()))
    assert all(a < b for a, b in pairwise(heights))
    act()
    assert painting.layer is not None and painting.layer.saved and painting.layer.can_undo
    bare.key(_K.mod_ctrl, _K.z)
    assert not painting.layer.pixels.any()


def test_a_stroke_by_keys_is_one_step_back(any_engine: Engine, folder: Path) -> None:
    desk = PictureDesk(any_engine, folder)
    painting = desk.bench.painting
    painting.folder, painting.now = folder, lambda: desk.time
    camera = desk.session.sketch.camera if desk.session.sketch else None
    desk.key(_K.b)
    painting.choose("height.image")
    desk.key(_K.x)
    io = imgui.get_io()
    io.add_key_event(_K.space, True)
    desk.run_frames(3)
    assert painting.layer is not None
    spot = int((painting.layer.pixels > 0).sum())
    for _ in range(3):  # Shift is for longer steps: it pans nothing meanwhile
        desk.key(_K.mod_shift, _K.right_arrow)
    io.add_key_event(_K.space, False)
    desk.run_frames(3)
    stroke = int((painting.layer.pixels > 0).sum())
    assert stroke > spot > 0 and desk.session.sketch is not None
    assert desk.session.sketch.camera == camera
    desk.key(_K.right_arrow)
    desk.run_frames(2)
    assert int((painting.layer.pixels > 0).sum()) == stroke, "the button is up"
    desk.key(_K.mod_ctrl, _K.z)
    assert not painting.layer.pixels.any()
    desk.key(_K.enter)
    desk.key(_K.left_arrow)
    assert painting.layer.pixels.any(), "Enter holds the button down"
    desk.key(_K.escape)
    desk.run_frames(2)
    assert not imgui.is_mouse_down(0) and painting.layer.saved and painting.on
    desk.key(_K.mod_ctrl, _K.z)
    assert not painting.layer.pixels.any()
    desk.close()


# ── painting ──────────────────────────────────────────────────────────────────


EXTENT = (1000.0, 500.0)
HARD = Brush(channel=1, radius=100.0, strength=1.0, softness=0.0)


def empty(ny=51, nx=101):
    return np.zeros((ny, nx, 4), np.float32)


def distance_to_segment(ny, nx, start, end):
    """Return the distance [m] of each node from a segment, by very many of its points."""
    y, x = np.mgrid[0:ny, 0:nx]
    position = np.stack([x * EXTENT[0] / (nx - 1), y * EXTENT[1] / (ny - 1)], axis=-1)
    points = np.linspace(np.multiply(start, EXTENT), np.multiply(end, EXTENT), 400)
    return np.linalg.norm(position[:, :, None] - points, axis=-1).min(axis=-1)


@pytest.mark.parametrize(
    ("start", "end"), [((0.5, 0.5), (0.5, 0.5)), ((0.2, 0.3), (0.7, 0.9)), ((0.0, 1.0), (0.05, 1.0))]
)
def test_a_hard_brush_covers_what_is_within_its_radius(start, end):
    mask = empty()
    cover(mask, Dab(start, end, EXTENT, HARD))
    away = distance_to_segment(51, 101, start, end)
    sure = np.abs(away - HARD.radius) > 2.0
    np.testing.assert_array_equal(mask[..., 1][sure], (away < HARD.radius)[sure])
    assert (mask[..., [0, 2, 3]] == 0).all() and mask[..., 1].any()


def test_a_soft_brush_fades_from_its_middle_to_its_radius():
    brush = Brush(radius=200.0, softness=1.0)
    (rows, columns), share = Dab((0.5, 0.5), (0.5, 0.5), EXTENT, brush).covered((101, 51))
    middle = share[25 - rows.start]
    assert middle.max() == 1 and middle[0] < 0.05
    half = middle[50 - columns.start :]
    assert (np.diff(half) <= 0).all()
    assert abs(np.interp(100.0, np.arange(len(half)) * 10.0, half) - 0.5) < 0.01


def test_a_layer_takes_from_the_others_and_an_eraser_from_all():
    mask = empty()
    mask[..., 0] = 0.75
    cover(
        mask, Dab((0.5, 0.5), (0.5, 0.5), EXTENT, Brush(channel=3, radius=50.0, strength=0.5, softness=0.0))
    )
    np.testing.assert_allclose(mask[25, 50], [0.375, 0, 0, 0.5], atol=1e-6)
    assert mask.sum(axis=-1).max() <= 1
    cover(
        mask,
        Dab((0.5, 0.5), (0.5, 0.5), EXTENT, Brush(channel=ERASER, radius=50.0, strength=1.0, softness=0.0)),
    )
    assert (mask[25, 50] == 0).all() and mask[0, 0, 0] == 0.75


def test_outside_the_terrain_nothing_is_painted():
    mask = empty()
    cover(mask, Dab((3.0, 3.0), (4.0, 3.0), EXTENT, HARD))
    assert (mask == 0).all()


SIZE = (128, 64)  # texels of the pass that reads it


def test_a_new_mask_has_the_pass_s_size_and_a_new_name(tmp_path: Path):
    first = Layer.create(tmp_path, "hills-image", WEIGHTS, SIZE)
    second = Layer.create(tmp_path, "hills-image", WEIGHTS, SIZE)
    assert first.path.name == "hills-image.png" and second.path.name == "hills-image-2.png"
    assert read_image(first.path).size == SIZE


def test_layer_has_terrain_size_within_a_bound(tmp_path: Path):
    layer = Layer.create(tmp_path, "usual", WEIGHTS, (1025, 513))
    assert read_image(layer.path).size == layer.array.shape[1::-1] == (1025, 513)
    layer = Layer.create(tmp_path, "large", WEIGHTS, (4097, 2049), most=1024)
    assert read_image(layer.path).size == (1024, 512)
    assert MAX_TEXELS == 2**12 + 1


def read_written(layer: Layer) -> np.ndarray:
    layer.writing.wait()
    return read_image(layer.path).pixels


def test_strokes_are_saved_north_up_and_undone_one_by_one(tmp_path: Path):
    layer = Layer.create(tmp_path, "mask", WEIGHTS, SIZE)
    pictures = [read_written(layer)]
    for x in (0.2, 0.8):
        layer.begin()
        layer.paint(Dab((x, 0.9), (x, 0.95), EXTENT, HARD))
        layer.save()
        pictures.append(read_written(layer))
    north, south = pictures[-1][:16], pictures[-1][-16:]
    assert north[..., 1].max() == 255 and south[..., 1].max() == 0
    assert (pictures[1] != pictures[2]).any()
    for expected in (pictures[1], pictures[0]):
        assert layer.can_undo
        layer.undo()
        np.testing.assert_array_equal(read_written(layer), expected)
    assert not layer.can_undo
    layer.undo()
    for expected in pictures[1:]:
        assert layer.can_redo
        layer.redo()
        np.testing.assert_array_equal(read_written(layer), expected)
    assert not layer.can_redo
    layer.redo()
    np.testing.assert_array_equal(read_written(layer), pictures[2])
    layer.undo()
    np.testing.assert_array_equal(read_written(layer), pictures[1])


def test_new_edit_after_undo_discards_redo(tmp_path: Path):
    layer = Layer.create(tmp_path, "mask", WEIGHTS, SIZE)
    layer.begin()
    layer.paint(Dab((0.2, 0.5), (0.2, 0.5), EXTENT, HARD))
    layer.undo()
    assert layer.can_redo
    layer.clear()
    assert not layer.can_redo
    layer.redo()
    assert (read_written(layer) == 0).all()


def test_clearing_can_be_undone(tmp_path: Path):
    layer = Layer.create(tmp_path, "mask", WEIGHTS, SIZE)
    layer.begin()
    layer.paint(Dab((0.5, 0.5), (0.5, 0.5), EXTENT, HARD))
    layer.save()
    painted = read_written(layer)
    layer.clear()
    assert (read_written(layer) == 0).all()
    layer.undo()
    np.testing.assert_array_equal(read_written(layer), painted)


def test_a_mask_that_is_there_is_copied_and_stays_as_it_was(tmp_path: Path):
    pixels = np.random.default_rng(1).integers(0, 256, (SIZE[1], SIZE[0], 4), np.uint8)
    write_png(tmp_path / "old.png", pixels)
    layer = Layer.create(tmp_path, "new", WEIGHTS, SIZE, of=tmp_path / "old.png")
    np.testing.assert_array_equal(read_written(layer), pixels)
    layer.clear()
    np.testing.assert_array_equal(read_image(tmp_path / "old.png").pixels, pixels)


def test_a_mask_of_another_size_takes_the_pass_s(tmp_path: Path):
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0] = [0, 200, 0, 0]  # the north
    write_png(tmp_path / "coarse.png", pixels)
    layer = Layer.create(tmp_path, "fine", WEIGHTS, SIZE, of=tmp_path / "coarse.png")
    array = read_written(layer)
    assert array.shape == (SIZE[1], SIZE[0], 4)
    assert array[0, 0, 1] == 200 and array[-1, -1, 1] == 0 and 90 < array[SIZE[1] // 2, 7, 1] < 110


def test_layer_full_of_fourth_weight_reads_back_the_same(tmp_path: Path):
    layer = Layer.create(tmp_path, "full", WEIGHTS, SIZE)
    everything = Brush(channel=3, radius=5000.0, strength=1.0, softness=0.0)
    layer.begin()
    layer.paint(Dab((0.5, 0.5), (0.5, 0.5), EXTENT, everything))
    layer.save()
    layer.writing.wait()
    np.testing.assert_array_equal(read_mask(layer.path, SIZE), np.broadcast_to([0, 0, 0, 1], (64, 128, 4)))


def test_a_folder_that_is_missing_has_a_sentence(tmp_path: Path):
    with pytest.raises(DataError, match="missing"):
        Layer.create(tmp_path / "missing", "mask", WEIGHTS, SIZE)


SKETCH = (
    """format = 1
size = 65
extent = [2000.0, 2000.0]
relief = 200.0
"""
    + passes(
        height="generation/layered_noise",
        painted=("texturing/alpha_map/mask", "size = 128", 'set = { image = "none.png" }'),
        weights=("texturing/alpha_map", "set = { path = 0.0 }"),
        colour="view/weights",
        light="lighting/l_dot_n",
    )
    + """[view]
use = "view/terrain"
samples = 1
camera = { azimuth = 180, elevation = 60, distance = 3500 }
"""
)


@pytest.fixture
def session(tmp_path: Path, open_session: OpenSession) -> Session:
    (tmp_path / "sketch").mkdir()
    write_png(tmp_path / "sketch" / "none.png", np.zeros((4, 4, 4), np.uint8))
    (tmp_path / "sketch" / "sketch.toml").write_text(SKETCH)
    made = open_session(tmp_path / "sketch")
    made.frame((160, 120))
    assert made.error is None
    return made


def test_a_stroke_over_the_picture_is_painted_under_the_mouse(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    assert painting.target == "painted.image"
    painting.toggle()
    painting.brush = Brush(channel=3, radius=150.0, strength=1.0, softness=0.0)
    position = (0.42, 0.45)
    x, y = painting.ground(position)
    before = session.engine.read(session.sketch, "weights")
    painting.press(position)
    painting.release()
    session.frame((160, 120))
    after = session.engine.read(session.sketch, "weights")
    ny, nx = after.shape[:2]
    there = (round(y * (ny - 1)), round(x * (nx - 1)))
    assert after[there][3] == 1 and before[there][3] == 0
    far = np.hypot(*(np.mgrid[0:ny, 0:nx] - np.array(there)[:, None, None])) * 2000 / (nx - 1) > 200
    np.testing.assert_array_equal(after[far], before[far])
    painting.undo()
    session.frame((160, 120))
    np.testing.assert_array_equal(session.engine.read(session.sketch, "weights"), before)
    painting.redo()
    session.frame((160, 120))
    np.testing.assert_array_equal(session.engine.read(session.sketch, "weights"), after)


def test_the_file_that_the_sketch_names_is_never_written_to(session: Session, tmp_path: Path) -> None:
    named = (tmp_path / "sketch" / "none.png").read_bytes()
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.press((0.5, 0.5))
    painting.move((0.6, 0.5))
    painting.release()
    assert (tmp_path / "sketch" / "none.png").read_bytes() == named
    layer = painting.layer
    assert layer is not None and layer.path.parent == tmp_path and painting.files == {layer.path}
    assert dict(session.shown.edits.values)["painted.image"] == str(layer.path)
    assert any("painting on" in note for note in session.notes)
    session.drafts.unset("painted.image")
    assert painting.layer is None, "the sketch names its own file again"
    painting.press((0.5, 0.5))
    assert painting.layer is not None and painting.layer.path != layer.path


def shown(tmp_path: Path, engine: Engine, text: str, *files: tuple[str, str]) -> Session:
    folder = tmp_path / "another"
    folder.mkdir()
    write_png(folder / "none.png", np.zeros((4, 4, 4), np.uint8))
    for name, content in files:
        (folder / name).write_text(content)
    (folder / "sketch.toml").write_text(text)
    made = Session(engine, folder)
    made.frame((160, 120))
    assert made.error is None
    return made


def test_terrain_that_is_not_square_can_be_painted_on(tmp_path: Path, any_engine: Engine) -> None:
    text = SKETCH.replace("extent = [2000.0, 2000.0]", "extent = [2000.0, 1100.0]")
    session = shown(tmp_path, any_engine, text)
    try:
        painting = Painting(session, tmp_path)
        painting.toggle()
        painting.press((0.5, 0.5))
        painting.release()
        session.frame((160, 120))
        assert session.error is None and painting.layer is not None and painting.layer.array.max() > 0.5
    finally:
        session.release()


FLAT = '#pragma kernel(output = "{}:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'


def test_the_ground_is_that_of_the_height_that_the_view_shows(
    tmp_path: Path, any_engine: Engine, session: Session
) -> None:
    """Neither a later pass that gives a height nor what a height is called leads the brush astray."""
    expected = Painting(session, tmp_path).ground((0.42, 0.55))
    text = SKETCH.replace(
        "[view]\n", '[[pass]]\nname = "sea_bed"\nuse = "./bed"\n[view]\ninputs = { height = "height" }\n'
    )
    other = shown(tmp_path, any_engine, text, ("bed.glsl", FLAT.format("height", "0.0")))
    try:
        assert Painting(other, tmp_path).ground((0.42, 0.55)) == expected
    finally:
        other.release()


def test_a_mask_that_was_taken_away_is_written_again(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.press((0.5, 0.5))
    painting.release()
    layer = painting.layer
    assert painting.settle()
    layer.path.unlink()
    painting.press((0.4, 0.5))
    painting.release()
    assert painting.settle()
    session.frame((160, 120))
    assert layer.path.exists() and session.error is None


def test_without_its_mask_the_brush_is_off(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    assert painting.on
    text = SKETCH.replace("texturing/alpha_map/mask", "texturing/rock").replace(
        'set = { image = "none.png" }', ""
    )
    (tmp_path / "sketch" / "sketch.toml").write_text(text)
    session.drafts.reload()
    session.frame((160, 120))
    assert session.error is None and not painting.on


def weights(session: Session) -> np.ndarray:
    session.frame((160, 120))
    assert session.error is None
    return session.engine.read(session.sketch, "painted")


def test_picture_follows_each_move_and_file_is_written_at_end(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.press((0.4, 0.5))
    layer = painting.layer
    assert layer is not None and layer.array.shape[:2] == (128, 128), "the size of the pass that reads it"
    array = weights(session)
    file = layer.path.read_bytes()
    for position in ((0.45, 0.5), (0.5, 0.5), (0.55, 0.52)):
        painting.move(position)
        np.testing.assert_array_equal(weights(session), layer.pixels / np.float32(255))
    assert not layer.saved and layer.path.read_bytes() == file
    assert (weights(session) != array).any()
    painting.release()
    assert painting.settle() and layer.saved
    seen = weights(session)
    np.testing.assert_array_equal(seen, read_mask(layer.path, (128, 128)), "as the file says")
    with Engine(session.engine.ctx, driver=session.engine.driver) as another:
        np.testing.assert_array_equal(another.read(session.sketch, "painted"), seen, "and any other reader")


def test_only_the_part_that_changed_goes_to_the_graphics_card(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.brush = Brush(channel=1, radius=40.0, strength=1.0, softness=0.0)
    painting.press((0.45, 0.5))
    weights(session)
    paint, whole = session.engine.runner.paint, 128 * 128
    before = paint.uploaded
    painting.move((0.47, 0.5))
    weights(session)
    once = paint.uploaded - before
    assert 0 < once < 0.05 * whole
    weights(session)
    assert paint.uploaded - before == once, "nothing changed"
    painting.move((0.5, 0.5))
    painting.move((0.53, 0.5))  # two between two pictures
    painting.release()
    np.testing.assert_array_equal(weights(session), painting.layer.pixels / np.float32(255))  # type: ignore[union-attr]
    for act in (painting.undo, painting.redo, painting.clear, painting.undo):
        act()
        np.testing.assert_array_equal(weights(session), painting.layer.pixels / np.float32(255))  # type: ignore[union-attr]


def test_a_mask_that_others_paint_on_is_read_again(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.press((0.45, 0.5))
    painting.release()
    layer = painting.layer
    weights(session)
    assert painting.settle()
    theirs = np.zeros((128, 128, 4), np.uint8)
    theirs[:, :, 2] = 255
    write_png(layer.path, theirs)
    session.redraw()
    np.testing.assert_array_equal(weights(session), theirs[::-1] / np.float32(255))
    painting.press((0.45, 0.5))
    painting.release()
    array = weights(session)
    assert (array[..., 2] == 1).mean() > 0.9 and array[..., 3].max() > 0.5
    np.testing.assert_array_equal(array, layer.pixels / np.float32(255))


@pytest.mark.parametrize("act", ["undo", "clear"])
def test_what_others_painted_since_is_not_taken_back(session: Session, tmp_path: Path, act: str) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    for _ in range(2):
        painting.press((0.45, 0.5))
        painting.release()
    layer = painting.layer
    assert painting.settle()
    theirs = np.zeros((128, 128, 4), np.uint8)
    theirs[:, :, 2] = 255
    write_png(layer.path, theirs)
    getattr(painting, act)()
    np.testing.assert_array_equal(read_png(layer.path)[0], theirs)
    np.testing.assert_array_equal(weights(session), theirs[::-1] / np.float32(255))
    assert any("was changed by another program" in note for note in session.notes)


def test_layer_resampled_by_its_source_is_followed_by_file(tmp_path: Path, any_engine: Engine) -> None:
    text = SKETCH.replace('set = { image = "none.png" }', 'set = { image = "none.png", texels = [4, 4] }')
    session = shown(tmp_path, any_engine, text)
    clock = [0.0]
    try:
        painting = Painting(session, tmp_path, lambda: clock[0])
        painting.toggle()
        painting.press((0.4, 0.5))
        layer = painting.layer
        assert layer is not None and layer.saved and not session.engine.painted
        painting.move((0.45, 0.5))
        assert not layer.saved
        clock[0] = 1.0
        painting.move((0.5, 0.5))
        assert layer.saved
        painting.move((0.55, 0.5))
        painting.release()
        assert layer.saved
    finally:
        session.release()


def test_changes_since_a_version_are_a_rectangle_around_them(tmp_path: Path) -> None:
    layer = Layer.create(tmp_path, "mask", WEIGHTS, SIZE)
    small = Brush(channel=0, radius=20.0, strength=1.0, softness=0.0)
    assert layer.changed_since(layer.version) == (slice(0, 0), slice(0, 0))
    rng = np.random.default_rng(3)
    versions = []
    for _ in range(300):
        versions.append((layer.version, layer.pixels.copy()))
        position = tuple(rng.uniform(-0.2, 1.2, 2))
        layer.paint(Dab(position, position, EXTENT, small))
    for version, before in versions[::17]:
        rows, columns = layer.changed_since(version)
        copy = before.copy()
        copy[rows, columns] = layer.pixels[rows, columns]
        np.testing.assert_array_equal(copy, layer.pixels)


def test_in_the_sky_no_stroke_begins(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    painting.press((0.5, 0.999))
    painting.move((0.5, 0.998))
    assert painting.layer is None and not list(tmp_path.glob("*.png"))


def test_the_outline_lies_around_the_place(session: Session, tmp_path: Path) -> None:
    painting = Painting(session, tmp_path)
    painting.toggle()
    outline = np.array(painting.outline((0.5, 0.5), 32))
    assert outline.shape == (32, 2)
    np.testing.assert_allclose(outline.mean(axis=0), (0.5, 0.5), atol=0.01)
    assert painting.outline((0.5, 0.999), 32) == []


def test_a_sketch_without_a_mask_says_so(tmp_path: Path, open_session: OpenSession) -> None:
    text = SKETCH.replace("texturing/alpha_map/mask", "texturing/rock")
    (tmp_path / "plain.toml").write_text(text.replace('set = { image = "none.png" }', ""))
    session = open_session(tmp_path / "plain.toml")
    session.frame((80, 60))
    painting = Painting(session, tmp_path)
    painting.toggle()
    assert not painting.on and any("nothing to paint on" in note for note in session.notes)


def test_paint_is_a_word_of_files_alone(tmp_path: Path) -> None:
    head = '#pragma kernel(output = "a:r32f")\n'
    kernel = tmp_path / "k.glsl"
    body = "float kernel(ivec2 texel) { return 0.0; }\n"
    kernel.write_text(f'{head}uniform sampler2D a_mask; //! input("paint")\n{body}')
    with pytest.raises(ShaderError, match="'paint' is not a way to read a texture"):
        load(kernel)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (
            'uniform sampler2D a; //! file("a.tif") erode("erosion/brush")',
            "'a' is not painted on; erode is for a",
        ),
        (
            'uniform sampler2D a; //! input erode("erosion/brush")',
            "'a' is not painted on; erode is for a file",
        ),
        (
            'uniform float a = 1.0; //! erode("erosion/brush")',
            "erode is for a file that is painted on; 'a' is",
        ),
        ('uniform sampler2D a; //! file("a.tif", "paint") erode()', "erode\\(\\) takes one text in quotes"),
    ],
)
def test_erode_is_for_what_is_painted_on(tmp_path: Path, line: str, sentence: str) -> None:
    kernel = tmp_path / "k.glsl"
    kernel.write_text(
        f'#pragma kernel(output = "h:r32f")\n{line}\nfloat kernel(ivec2 texel) {{ return 0.0; }}\n'
    )
    with pytest.raises(ShaderError, match=sentence):
        load(kernel)
