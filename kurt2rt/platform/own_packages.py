"""Top-level packages of the program that a foreign package of the same name hides."""

from importlib.util import find_spec
from pathlib import Path

_NAMES = ("config", "hal", "behaviors", "simbridge")
_HERE = Path(__file__).resolve().parents[2]


def hidden_packages(names: tuple[str, ...] = _NAMES, here: Path = _HERE) -> str:
    """Return a sentence about packages that Python finds elsewhere than this one; empty if it finds the program's own.

    Nothing is imported.

    Args:
        names: packages that belong to the program.
        here: folder that holds them.
    """
    found = {name: _folder_of(name) for name in names}
    foreign = [f"{name} in {folder}" for name, folder in found.items() if folder is not None and folder != here / name]
    if not foreign:
        return ""
    return (
        f"Python finds foreign packages instead of those of kurt2rt, which are in {here}: {', '.join(foreign)}; "
        "rename or uninstall them, or take their folder off Python's path (PYTHONPATH, the folder of the script)"
    )


def _folder_of(name: str) -> Path | None:
    """Return the folder of a package, or the file of a module; None if Python finds neither."""
    try:
        spec = find_spec(name)
    except ValueError:  # a module that was put together by hand has no spec
        return None
    if spec is None or spec.origin is None:
        return None
    origin = Path(spec.origin).resolve()
    return origin.parent if origin.name == "__init__.py" else origin
