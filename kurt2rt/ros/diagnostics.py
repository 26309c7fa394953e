"""Errors that /diagnostics tells."""

from collections.abc import Sequence

from kurt2rt.ros.messages import DiagnosticArray, DiagnosticStatus


class DiagnosticErrors:
    """Newest errors of the statuses that matter."""

    def __init__(self, names: Sequence[str]) -> None:
        """Read statuses whose names begin with one of `names`."""
        self._names = tuple(names)
        self._errors: dict[str, str] = {}

    def update(self, array: DiagnosticArray) -> str:
        """Apply a message and return `text`."""
        for status in array.status:
            if status.name.startswith(self._names):
                self._errors.pop(status.name, None)
                if status.level == DiagnosticStatus.ERROR:
                    self._errors[status.name] = status.message
        return self.text

    @property
    def text(self) -> str:
        """First error that lasts, as `name: message`; empty without one."""
        return next((f"{name}: {message}" for name, message in self._errors.items()), "")
