"""Listings of the texts of studies' reports."""

from collections.abc import Iterator

from kurt2rt.experiments.lockstep.exam_verdict import EXAM_VERDICT_TEXTS, ExamVerdict
from kurt2rt.experiments.study.verdict import Result, Target, Verdict
from kurt2rt.experiments.study.verdict_text import RESULT_TEXTS, cells_of

_VALUES: dict[str, float | str] = {
    "limit": 91,
    "rlas": 92.5,
    "limit_s": 345.0,
    "teaching_s": 344.5,
    "world": "A",
    "needed": 18,
    "judged": 20,
    "success": "18 of 20",
    "share": 0.95,
    "right": 0.9994,
    "rate": 0.25,
    "robots": 20,
    "succeeded": 19,
    "most": 3,
    "fall": 0.9,
    "low": 0.8,
    "high": 0.95,
    "before": 2.0,
    "after": 0.2,
    "measure": "progress",
    "margin": 0.02,
    "no_longer_clean": 1,
    "worst": 0.019,
    "direction": "worse",
    "junctions": 1600,
    "without_error": 18,
    "presses": 20,
    "median": "7.5",
}


def targets() -> Iterator[tuple[str, str]]:
    """Yield name, requirement and measured value of each target."""
    for target in Target:
        changed = {"right": "95.0% of 100"} if target is Target.JUNCTIONS_RIGHT else {}
        yield target, " | ".join(cells_of(Verdict(target, {**_VALUES, **changed}, met=True)))


def results() -> Iterator[tuple[str, str]]:
    """Yield the texts of results of verdicts and of exams."""
    yield from ((result, RESULT_TEXTS[result]) for result in Result)
    yield from ((f"exam {verdict}", EXAM_VERDICT_TEXTS[verdict]) for verdict in ExamVerdict)
