"""What can go wrong with the paper's experiments."""


class PaperError(RuntimeError):
    """Results cannot be used; the message says why and what to do."""
