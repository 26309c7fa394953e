"""What can go wrong with an experiment."""


class LessonLostError(RuntimeError):
    """Lessons could not be saved, or were refused; the message says why and what to do."""
