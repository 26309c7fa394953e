"""Drivable cells from the image of a map, interpreted as map_server does."""

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from hal.settings import SettingsError
from simbridge.worlds.map_server.settings import MapSettings, image_error

MOST_CELLS = 4096 * 4096

_UNKNOWN = -1.0
_HALF_OCCUPIED = 50.0
"""Threshold on an occupancy grid's scale of 0 to 100; mode trinary has nothing between."""


def drivable_cells(source: Path, settings: MapSettings) -> NDArray[np.bool_]:
    """Return the cells of a map's image known to be free, shape (rows, columns), row 0 at the bottom.

    `source`: file of the map, whose `settings` name the image. Raises SettingsError that names file and key.
    """
    image = source.parent / settings.image
    if image.exists() and not image.is_file():  # opening a FIFO waits until another program writes to it
        raise image_error(source, f"{image} is a folder or device, not a file", "give a PGM or PNG file")
    try:
        with warnings.catch_warnings():
            # Pillow warns of huge images, of which nothing is read before the size check below.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            opened = Image.open(image)
        with opened:
            width, height = opened.size
            if width * height > MOST_CELLS:
                too_large = f"{image} is too large (got {width} x {height} cells, allowed {MOST_CELLS})"
                raise image_error(source, too_large, "crop it to the robot's area")
            shade, is_opaque = _shades(opened)
    except FileNotFoundError as error:
        raise image_error(source, f"{image} does not exist", "give a path relative to the YAML file") from error
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        if isinstance(error, SettingsError):
            raise
        raise image_error(source, f"{image} cannot be read ({error})", "give a PGM or PNG file") from error
    occupancy = _occupancy(shade, is_opaque, settings)
    return np.asarray((occupancy >= 0) & (occupancy < _HALF_OCCUPIED))[::-1]


def _shades(image: Image.Image) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the brightness (mean of the colours, 0 to 255) and the opacity of each cell."""
    if image.mode == "P":
        image = image.convert("RGBA")
    elif image.mode not in ("L", "LA", "RGB", "RGBA", "I", "I;16"):
        image = image.convert("L")
    values = np.asarray(image, dtype=np.float64)
    if image.mode in ("I", "I;16"):  # 16 bits
        values = values / 257.0
    if values.ndim == 2:
        return values, np.ones(values.shape, dtype=np.bool_)
    if image.mode in ("LA", "RGBA"):
        return values[..., :-1].mean(axis=2), values[..., -1] == 255
    return values.mean(axis=2), np.ones(values.shape[:2], dtype=np.bool_)


def _occupancy(shade: NDArray[np.float64], is_opaque: NDArray[np.bool_], settings: MapSettings) -> NDArray[np.float64]:
    """Return map_server's occupancy: 0 free, 100 occupied, -1 unknown."""
    bright = 255.0 - shade if settings.negate else shade
    if settings.mode == "raw":
        return np.where(bright <= 100, bright, _UNKNOWN)
    share = (255.0 - bright) / 255.0
    low, high = settings.free_thresh, settings.occupied_thresh
    between: NDArray[np.float64] | float = _UNKNOWN
    if settings.mode == "scale":
        between = np.where(is_opaque, 1.0 + 98.0 * (share - low) / (high - low), _UNKNOWN)
    return np.where(share > high, 100.0, np.where(share < low, 0.0, between))
