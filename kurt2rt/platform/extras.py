"""Extras of the installation."""

EXTRAS = {
    "contourpy": "simulation",
    "dask": "studies",
    "distributed": "studies",
    "foxglove": "recording",
    "h11": "page",
    "jinja2": "simulation",
    "matplotlib": "simulation",
    "mcap": "recording",
    "networkx": "simulation",
    "numba": "fast",
    "optuna": "studies",
    "PIL": "simulation",
    "pyarrow": "export",
    "pymunk": "simulation",
    "rosbags": "ros",
    "scipy": "studies",
    "shapely": "simulation",
    "serial": "serial",
    "sklearn": "studies",
    "starlette": "page",
    "uvicorn": "page",
    "websockets": "page",
    "zenoh": "ros",
    "zstandard": "recording",
}
"""Packages that a robot can do without, by their importable names, and the extra that brings each."""


def extra_for(error: ModuleNotFoundError) -> str | None:
    """Return the extra that brings the missing module; None if no extra does."""
    return EXTRAS.get((error.name or "").partition(".")[0])
