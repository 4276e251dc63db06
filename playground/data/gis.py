"""Read rasters by GDAL, where the extra ``gis`` is installed (rasterio): what the readers here cannot.

Only the drivers that are named are used: others may read further files or the network.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.data.geokeys import DIRECTORY, DOUBLES, WORDS, Keys, keys_of_code, read_keys, write_keys
from playground.data.grid import Found, check_grid
from playground.data.image_files import reason
from playground.data.place import Crs, Place, turned
from playground.data.rows import Band
from playground.errors import DataError
from playground.extras import install_command

if TYPE_CHECKING:
    import rasterio.io


def advice(verb: str = "reads") -> str:
    """Return how to install ``gis``, which reads, or transforms, what is not read here."""
    return f"the extra gis {verb} it: {install_command('gis')}"


_NETCDF = "netCDF"
_USUAL = ("elevation", "z", "height", "altitude", "topo", "dem", "band1", "band_data")
_WGS_84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]'
)
_BAND = 2**22  # [texels]


def has_rasters() -> bool:
    """Return whether rasterio is installed."""
    return find_spec("rasterio") is not None


def _open(path: Path | str, driver: str, overview: int | None = None) -> rasterio.io.DatasetReader:
    import rasterio

    options = {} if overview is None else {"OVERVIEW_LEVEL": overview}
    return rasterio.open(path, driver=driver, **options)


@dataclass(frozen=True, eq=False)
class GdalRows:
    """The rows of a raster's first band, or of one of its overviews."""

    path: Path | str  # or GDAL's name of a part of a file
    driver: str
    shape: tuple[int, int]
    dtype: np.dtype[Any]
    high: int  # rows of a block
    overview: int | None = None

    def bands(self) -> Iterator[Band]:
        """Yield all rows, at least a row of blocks at a time."""
        from rasterio.windows import Window

        with _explained(self.path), _open(self.path, self.driver, self.overview) as raster:
            rows, cols = self.shape
            count = max(_BAND // (cols * self.high), 1) * self.high
            for start in range(0, rows, count):
                window = Window(0, start, cols, min(count, rows - start))
                yield start, raster.read(1, window=window)


def raster_rows(path: Path | str, driver: str, overview: int | None = None) -> GdalRows:
    """Return the rows of a raster's first band, or of one of its overviews, by its number from 0."""
    with _explained(path), _open(path, driver, overview) as raster:
        dtype, high = np.dtype(raster.dtypes[0]), raster.block_shapes[0][0]
        return GdalRows(path, driver, raster.shape, dtype, high, overview)


def overview_rows(path: Path, driver: str) -> tuple[GdalRows, ...]:
    """Return the overviews of a raster's first band, finest first."""
    with _explained(path), _open(path, driver) as raster:
        count = len(raster.overviews(1))
    return tuple(raster_rows(path, driver, number) for number in range(count))


@contextmanager
def _explained(path: Path | str) -> Iterator[None]:
    """Raise what rasterio raises as a ``DataError``."""
    from rasterio.errors import RasterioError

    try:
        yield
    except RasterioError as error:
        message = f"cannot be read by GDAL: {reason(Exception(str(error.__cause__ or error)))}"
        raise DataError(message, file=path) from error


def read_netcdf(path: Path) -> Found:
    """Read the heights of a NetCDF file by GDAL; raise ``DataError`` naming the extra where it is missing."""
    if not has_rasters():
        raise DataError(f"NetCDF is read by GDAL; {advice()}", file=path)
    name = _grid_in(path)
    with _explained(path), _open(name, _NETCDF) as raster:
        check_grid(raster.shape, np.dtype(raster.dtypes[0]), path, in_turn=True)
        notes = (f"the first of its {raster.count} bands was read",) if raster.count > 1 else ()
        place, more = _place(raster, path)
        scale, offset, no_data = raster.scales[0], raster.offsets[0], raster.nodata
        unit = raster.units[0] or ""
    rows = raster_rows(name, _NETCDF)
    notes = (*more, *notes)
    spacing = None
    if place is not None:
        spacing, more = place.spacing
        notes = (*more, *notes)
    found = Found(
        rows,
        spacing,
        no_data=no_data,
        scale=scale,
        offset=offset,
        place=place,
        south_first=None if place is None else False,
        notes=notes,
    )
    return found.in_unit(Crs() if place is None else place.crs, unit)


def _grid_in(path: Path) -> str:
    """Return what GDAL calls the variable that holds heights: the one of a usual name, or the only grid."""
    with _explained(path), _open(path, _NETCDF) as raster:
        if raster.count:
            return str(path)
        names: dict[str, str] = {name.rpartition(":")[2].lower(): name for name in raster.subdatasets}
    usual = [names[name] for name in _USUAL if name in names]
    if usual or len(names) == 1:
        return [*usual, *names.values()][0]
    listed = ", ".join(names) or "nothing"
    raise DataError(f"holds {listed}; expected one grid, or one called {' or '.join(_USUAL[:2])}", file=path)


def _place(raster: rasterio.io.DatasetReader, path: Path) -> tuple[Place | None, tuple[str, ...]]:
    """Return where the nodes lie, None where it is not said, and notes; GDAL gives the northern row first."""
    at = raster.transform
    if at.is_identity:
        return None, ("it does not say where its texels lie",)
    if at.b or at.d or at.a < 0.0 or at.e > 0.0:
        raise turned(path, at.a, at.d)
    wkt: str = raster.crs.to_wkt() if raster.crs else ""
    notes: tuple[str, ...] = ()
    units = [str(text) for name, text in raster.tags().items() if name.endswith("#units")]
    if not wkt and any(text.startswith("degree") for text in units):
        wkt, notes = _WGS_84, ("its degrees are of no named system; WGS 84 is assumed",)
    size = raster.width, raster.height
    return Place(at.c + 0.5 * at.a, at.f + 0.5 * at.e, (at.a, -at.e), size, Crs(wkt=wkt)), notes


def geokeys_of(crs: Crs) -> Keys:
    """Return GeoTIFF's keys for a reference system; none where nothing here knows them."""
    if crs.keys or not crs.facts.kind:
        return crs.keys
    if crs.facts.epsg:
        return keys_of_code(crs.facts)
    return _keys_of_wkt(crs.wkt) if has_rasters() else ()


@lru_cache(maxsize=8)
def _keys_of_wkt(wkt: str) -> Keys:
    """Return the keys that GDAL writes for a text."""
    import rasterio
    import tifffile
    from rasterio.crs import CRS
    from rasterio.errors import CRSError
    from rasterio.transform import Affine

    try:
        crs = CRS.from_wkt(wkt)
    except CRSError:
        return ()
    facts = {"driver": "GTiff", "width": 1, "height": 1, "count": 1, "dtype": "uint8"}
    with rasterio.MemoryFile() as memory:
        with memory.open(**facts, crs=crs, transform=Affine(1.0, 0.0, 0.0, 0.0, -1.0, 1.0)) as raster:
            raster.write(np.zeros((1, 1, 1), np.uint8))
        with tifffile.TiffFile(io.BytesIO(memory.read())) as tif:
            tags = tif.pages.first.tags
            return read_keys(*(tags.valueof(number) for number in (DIRECTORY, DOUBLES, WORDS)))


def name_for_gdal(crs: Crs) -> str:
    """Return a reference system as GDAL takes it: a code or a text; "" where nothing here knows one."""
    if crs.name or crs.wkt or not crs.keys or not has_rasters():
        return crs.name or crs.wkt
    return _wkt_of_keys(crs.keys)


@lru_cache(maxsize=8)
def _wkt_of_keys(keys: Keys) -> str:
    """Return the text that GDAL makes of GeoTIFF's keys."""
    import rasterio
    import tifffile

    directory, reals, text = write_keys(keys)
    tags: list[tuple[int, str, int, Any, bool]] = [
        (33550, "d", 3, (1.0, 1.0, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), True),
        (DIRECTORY, "H", len(directory), directory, True),
    ]
    tags += [(DOUBLES, "d", len(reals), reals, True)] if reals else []
    tags += [(WORDS, "s", 0, text, True)] if text else []
    stream = io.BytesIO()
    tifffile.imwrite(stream, np.zeros((1, 1), np.uint8), extratags=tags, metadata=None)
    with rasterio.MemoryFile(stream.getvalue()) as memory, memory.open(driver="GTiff") as raster:
        found: str = raster.crs.to_wkt() if raster.crs else ""
        return found


def transformed(points: NDArray[np.float64], from_crs: str, to_crs: str) -> NDArray[np.float64]:
    """Return points (n, 2) in another reference system; what has no place there is not finite.

    Both are a code or a text. Raises ``DataError`` where GDAL knows one of them not.
    """
    from rasterio.crs import CRS
    from rasterio.errors import CRSError, RasterioError
    from rasterio.warp import transform

    try:
        systems = [CRS.from_user_input(crs) for crs in (from_crs, to_crs)]
        x, y = transform(*systems, points[:, 0].tolist(), points[:, 1].tolist())
    except CRSError as error:
        raise DataError(f"GDAL does not know a reference system: {reason(Exception(str(error)))}") from None
    except RasterioError as error:
        raise DataError(f"cannot be brought into another system: {reason(Exception(str(error)))}") from None
    return np.stack([np.array(x, np.float64), np.array(y, np.float64)], 1)
