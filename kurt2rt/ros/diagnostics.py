"""Errors that /diagnostics tells."""

from collections.abc import Sequence

from kurt2rt.ros.messages import DiagnosticArray, DiagnosticStatus

_MOST = 64
_MORE = f"more than {_MOST} parts"
_LONGEST = 200


class DiagnosticErrors:
    """Newest errors of the statuses that matter.

    An error lasts until the same name tells OK or WARN: STALE says that nothing is known of it any more. Of more names
    than a base has, one error stands for the rest, until the program is started again.
    """

    def __init__(self, names: Sequence[str]) -> None:
        """Read statuses whose names begin with one of `names`."""
        self._names = tuple(names)
        self._errors: dict[str, str] = {}

    def update(self, array: DiagnosticArray) -> str:
        """Apply a message and return `text`."""
        for status in array.status:
            if not status.name.startswith(self._names):
                continue
            if status.level in (DiagnosticStatus.OK, DiagnosticStatus.WARN):
                self._errors.pop(status.name, None)
            elif status.level == DiagnosticStatus.ERROR:
                if status.name in self._errors or len(self._errors) < _MOST:
                    self._errors[status.name] = status.message
                else:
                    self._errors[_MORE] = "mend them, and start the program again"
        return self.text

    @property
    def text(self) -> str:
        """First error that lasts, as `name: message`, cut to 200 characters; empty without one."""
        return next((f"{name}: {message}"[:_LONGEST] for name, message in self._errors.items()), "")
