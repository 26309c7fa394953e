"""The one error of this package."""


class PageError(Exception):
    """The page cannot be served. The message is one line: what, where, what to do."""
