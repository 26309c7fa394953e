"""What can go wrong with an experiment."""


class JobKilledError(RuntimeError):
    """The process of a job was killed from outside; the message names the job."""


class LessonLostError(RuntimeError):
    """Lessons could not be saved, or were refused; the message says why and what to do."""


class StudyError(RuntimeError):
    """Kept results cannot be used, or experiments do not fit together; the message says why and what to do."""
