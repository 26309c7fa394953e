"""What can be wrong with a status."""


class StatusError(Exception):
    """No status can be had. The message is one line: why, and what to do."""
