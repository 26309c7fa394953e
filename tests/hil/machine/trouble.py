"""Error for users if no machine can be had."""


class MachineError(Exception):
    """There is no machine, or it ended by itself. The message says what happened and what to do."""
