"""The wall clock of a program that is set forward and back while it runs."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.cli.helpers import Running, started

HOUR_S = 3600


class WallClock:
    """Offset of the wall clock of a robot program, kept in a file."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / "wall-clock"
        self.off_by_s = 0
        self.jump(0)

    def jump(self, by_s: int) -> None:
        """Set it forward, or back."""
        self.off_by_s += by_s
        fresh = self._file.with_suffix(".new")
        fresh.write_text(str(self.off_by_s), encoding="ascii")
        fresh.replace(self._file)

    @contextmanager
    def running(self, *words: str, folder: Path) -> Iterator[Running]:
        """Start `kurt2rt ...` in a folder, by this clock; what is left of it at the end is killed."""
        with started("tests.crash.skewed_clock", str(self._file), *words, folder=folder) as process:
            try:
                yield Running(process)
            finally:
                process.kill()
