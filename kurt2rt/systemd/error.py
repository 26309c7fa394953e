"""The one error of this package."""


class UnitError(Exception):
    """A unit cannot be made, installed or checked. The message is one line: what, where, what to do."""
