"""Output of the robot program."""

from typing import Protocol

from hal.health import Health
from kurt2rt.service.post_tick import ProgramStatus


class ProgramScreen(Protocol):
    """Output of the program. The printer's thread calls all methods while it runs; the loop reads only `links`."""

    @property
    def links(self) -> tuple[str, ...]:
        """Links to the teacher's page, with their tokens."""
        ...

    def print_line(self, text: str, style: str | None = None) -> None:
        """Print a line. `style`: red for an error, yellow for a warning, another colour of rich, or None."""
        ...

    def lesson_saved(self, text: str) -> None:
        """Print the text of a lesson that is durable."""
        ...

    def show_status(self, status: ProgramStatus, health: Health, trouble: str) -> None:
        """Show the status. `trouble`: of simulator and CAN log; empty where neither has any."""
        ...

    def page_line(self, line: str) -> None:
        """Process a line that the page's program printed: the pages that it serves, or a message."""
        ...

    def close(self) -> None:
        """Remove the lines that stay in place on a terminal."""
        ...
