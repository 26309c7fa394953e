"""Refusal of a drive that the batch simulator does not know."""

from hal.errors import UserError


class BatchRefusedError(UserError):
    """The batch simulator cannot drive this as the loop over the CAN bus does; the text says what and what to do."""
