"""Error of a recording that cannot be made or read."""

from config.errors import UserError


class RecordingError(UserError):
    """Error of a recording that cannot be made or read."""
