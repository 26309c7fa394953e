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
_SAVED_AS_UNKNOWN = 205
"""Shade of unknown cells in a map that map_saver wrote."""
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
            shade, opacity = _shades(opened)
    except FileNotFoundError as error:
        raise image_error(source, f"{image} does not exist", "give a path relative to the YAML file") from error
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        if isinstance(error, SettingsError):
            raise
        raise image_error(source, f"{image} cannot be read ({error})", "give a PGM or PNG file") from error
    occupancy = _occupancy(shade, opacity, settings)
    return np.asarray((occupancy >= 0) & (occupancy < _HALF_OCCUPIED))[::-1]


def _shades(image: Image.Image) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return brightness (mean of the colours) and opacity of each cell, 0 to 255; None for an image without opacity."""
    if image.has_transparency_data:
        image = image.convert("RGBA")
    elif image.mode not in ("L", "RGB", "I", "I;16"):
        image = image.convert("RGB" if image.mode == "P" else "L")
    values = np.asarray(image, dtype=np.float64)
    if image.mode in ("I", "I;16"):  # 16 bits
        values = values / 257.0
    if values.ndim == 2:
        return values, None
    return values[..., :3].mean(axis=2), values[..., 3] if image.mode == "RGBA" else None


def _occupancy(
    shade: NDArray[np.float64], opacity: NDArray[np.float64] | None, settings: MapSettings
) -> NDArray[np.float64]:
    """Return map_server's occupancy: 0 free, 100 occupied, -1 unknown.

    In two cases it knows less than map_server. Its map_saver writes unknown as the shade 205, which its own default
    free_thresh of 0.25 takes for free. Invisible cells are free there if their colour is bright enough.
    """
    # As map_server has it, opacity counts as a fourth colour in mode trinary.
    averaged = shade if opacity is None or settings.mode != "trinary" else (3.0 * shade + opacity) / 4.0
    bright = 255.0 - averaged if settings.negate else averaged
    share = (255.0 - bright) / 255.0
    low, high = settings.free_thresh, settings.occupied_thresh
    known: NDArray[np.bool_] | bool = True
    if settings.mode == "raw":
        occupancy = np.where(bright <= 100, bright, _UNKNOWN)
    else:
        between = _UNKNOWN if settings.mode == "trinary" else 1.0 + 98.0 * (share - low) / (high - low)
        occupancy = np.where(share > high, 100.0, np.where(share < low, 0.0, between))
    if settings.mode == "trinary":
        known = (255.0 - shade if settings.negate else shade) != _SAVED_AS_UNKNOWN
    if opacity is not None:
        known = known & (opacity == 255 if settings.mode == "scale" else opacity > 0)
    return np.where(known, occupancy, _UNKNOWN)
