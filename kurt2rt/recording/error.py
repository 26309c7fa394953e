"""What can be wrong with a recording."""


class RecordingError(Exception):
    """A recording cannot be made. The message is one line: which file, what is wrong, what to do."""
