"""What can be wrong with a drill."""


class DidNotDriveError(RuntimeError):
    """The robot stood before anything failed, so that nothing can be seen. One line: which case, what to look at."""
