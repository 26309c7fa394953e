"""`kurt2rt ...` by a wall clock that is set while it runs: the first argument is a file that says by how many seconds.

Every other clock keeps its time, as on a machine whose wall clock is set.
"""

import datetime
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self


class _WallClock:
    def __init__(self, file: Path) -> None:
        self._file = file

    @property
    def off_by_s(self) -> int:
        return int(self._file.read_text(encoding="ascii"))


def set_clocks_by(file: Path) -> None:
    """Shift the wall clock of all modules of this process, also of those imported before, by the seconds in `file`."""
    wall_clock = _WallClock(file)
    right_s: Callable[[], float] = time.time
    right_ns: Callable[[], int] = time.time_ns

    class WrongDatetime(datetime.datetime):
        @classmethod
        def now(cls, tz: datetime.tzinfo | None = None) -> Self:
            return super().now(tz) + datetime.timedelta(seconds=wall_clock.off_by_s)

    swaps: tuple[tuple[object, object], ...] = (
        (datetime.datetime, WrongDatetime),
        (right_s, lambda: right_s() + wall_clock.off_by_s),
        (right_ns, lambda: right_ns() + wall_clock.off_by_s * 1_000_000_000),
    )
    for module in list(sys.modules.values()):
        for name, value in list(vars(module).items()):
            for right, wrong in swaps:
                if value is right:
                    setattr(module, name, wrong)


if __name__ == "__main__":
    set_clocks_by(Path(sys.argv.pop(1)))
    from kurt2rt.cli.main import main

    main()
