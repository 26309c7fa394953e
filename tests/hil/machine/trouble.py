"""What the machine's user is told when there is none."""


class MachineError(Exception):
    """There is no machine, or it ended by itself. The message says what happened and what to do."""
