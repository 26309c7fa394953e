"""Reproducible figure files, and figures that a notebook shows."""

from io import BytesIO
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

_DPI = 120
_NO_DATE: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None, "Producer": None},
}

FORMATS = tuple(_NO_DATE)
"""Suffixes of figure files."""


class ShownFigure(Figure):
    """Figure that a notebook shows; Jupyter shows other figures only after matplotlib.pyplot was imported."""

    def _repr_png_(self) -> bytes:
        file = BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def save_figure(figure: Figure, path: Path) -> None:
    """Write the figure in the format of the suffix, and create its folder. Raises OSError.

    The bytes depend on the drawing alone.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # Text stays text: it can be searched, and the file is a third as large.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "kurt2rt"}):
        figure.savefig(path, dpi=_DPI, metadata=_NO_DATE[path.suffix])
