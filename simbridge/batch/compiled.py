"""Compiler of the batch's functions: numba where it is installed (extra `fast`), else plain Python.

Nothing may change a rounding: no fastmath, no contraction of a product and a sum. Compiled code is kept in the user's
cache, in a folder named by the hash of all sources that are compiled, because numba itself looks only at the file of
the outermost function.
"""

import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FunctionType
from typing import Any, ParamSpec, TypeVar, cast

try:
    import numba

    _numba: Any = numba
except ImportError:
    _numba = None

_P = ParamSpec("_P")
_T = TypeVar("_T")

_ROOT = Path(__file__).parents[2]
_SOURCES = (
    *sorted(_ROOT.glob("simbridge/batch/*.py")),
    *sorted(_ROOT.glob("behaviors/policies/*.py")),
    _ROOT / "behaviors" / "keep_distance.py",
    _ROOT / "simbridge" / "robot" / "wheels.py",
    *sorted(_ROOT.glob("simbridge/contracts/*.py")),
    *(_ROOT / "hal" / f"{name}.py" for name in ("guard_limits", "infrared_law", "numerics", "sensor_signs")),
)
"""Files with functions that are compiled, and with the constants in them."""

IS_COMPILED: bool = _numba is not None and not _numba.config.DISABLE_JIT
"""True if the batch is compiled; otherwise it gives the same numbers some hundred times slower."""


def _make_cache() -> bool:
    """Set up the folder of compiled code, unless the user has named one; return whether it can be written."""
    if _numba.config.CACHE_DIR:
        return True
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in _SOURCES)).hexdigest()
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "kurt2rt" / "compiled" / digest[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    _numba.config.CACHE_DIR = str(folder)
    return os.access(folder, os.W_OK)


_CACHES = IS_COMPILED and _make_cache()


def compiled(
    function: Callable[_P, _T], *plain: Callable[..., Any], **compiled_already: Callable[..., Any]
) -> Callable[_P, _T]:
    """Return a function compiled for the batch; without numba, the function itself.

    Raises ValueError for a function of a file whose changes would not be noticed.

    Args:
        function: function to be compiled.
        plain: functions that it calls, which are compiled with it.
        compiled_already: others that it calls, by name.
    """
    if Path(function.__code__.co_filename) not in _SOURCES:
        raise ValueError(f"{function.__module__} is not among the sources of the batch")
    if _numba is None:
        return function
    called = {each.__name__: compiled(each) for each in plain} | compiled_already
    if called:
        own = cast("FunctionType", function)
        function = FunctionType(own.__code__, {**own.__globals__, **called}, own.__name__)
    return _compile(function)


def with_types_of(functions: Iterable[Callable[_P, _T]], *arguments: Any) -> list[Callable[_P, _T]]:
    """Return compiled functions for arguments of the same types as these, which they do not look at again.

    Numba takes 20 to 50 us in each call to look at the types of all numbers in the tables.
    """
    if not IS_COMPILED:
        return list(functions)
    types = tuple(map(_numba.typeof, arguments))
    return [cast("Any", function).compile(types) for function in functions]


def compiled_in_any_order(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """Return a function compiled so that its sums may be added in another order, for sums that are never rounded.

    Raises ValueError as `compiled`.
    """
    if Path(function.__code__.co_filename) not in _SOURCES:
        raise ValueError(f"{function.__module__} is not among the sources of the batch")
    return function if _numba is None else _compile(function, fastmath={"reassoc"})


def _compile(function: Callable[_P, _T], **more: Any) -> Callable[_P, _T]:
    # Reference counts of the shared tables took a third of the time. Nothing here makes or keeps an array, so none are
    # needed, and inlining spares passing hundreds of numbers to each function.
    options = {"cache": _CACHES, "error_model": "numpy", "forceinline": True, "_nrt": False, **more}
    fast: Callable[_P, _T] = _numba.njit(**options)(function)
    return fast
