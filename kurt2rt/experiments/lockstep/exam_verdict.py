"""Verdict on an exam, and its texts."""

from enum import StrEnum


class ExamVerdict(StrEnum):
    """Outcome of an exam."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_JUDGED = "not_judged"
    """The reference drive makes too little progress to measure another drive by."""


EXAM_VERDICT_TEXTS = {
    ExamVerdict.PASSED: "passed",
    ExamVerdict.FAILED: "failed",
    ExamVerdict.NOT_JUDGED: "not judged",
}
"""Shown in tables and pictures."""

NOT_JUDGED_BECAUSE = "not judged: the policy itself gets nowhere here"
"""Shown where there is room for the reason."""
