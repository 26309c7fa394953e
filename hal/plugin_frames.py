"""Places in plug-ins at which errors of other authors' code were raised."""

import sys
import traceback

from hal.plugins import OWN_PACKAGES

_LIBRARIES = frozenset({"numpy", "pydantic", "pydantic_core"})
"""Packages that both the program and plug-ins call; an error in them belongs to their caller."""


def place_in_plugin(error: BaseException) -> str:
    """Return the file and line of a plug-in's newest frame in an error's traceback; empty if none of it is a plug-in's.

    The outermost package from outside of the program is the plug-in, so the line in it that called a library is told.
    """
    package, place = "", ""
    for frame, line in traceback.walk_tb(error.__traceback__):
        module = str(frame.f_globals.get("__name__", "")).partition(".")[0]
        if not package and module not in sys.stdlib_module_names and module not in {*OWN_PACKAGES, *_LIBRARIES}:
            package = module
        if package and module == package:
            place = f"{frame.f_code.co_filename}, line {line}"
    return place
