"""Measures of a score against wrong actions and collisions, from the ticks of uncorrected drives."""

import zlib
from base64 import b64decode, b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import zip_longest
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator
from scipy.stats import mannwhitneyu

from config.settings import Settings

Scores = NDArray[np.float64]
Flags = NDArray[np.bool_]


def _unpacked(kind: type[np.generic], value: Any) -> Any:
    """Return the array (n,) of a compressed text; an array stays as it is."""
    return np.frombuffer(zlib.decompress(b64decode(value)), kind) if isinstance(value, str) else value


_COMPRESSED = PlainSerializer(lambda array: b64encode(zlib.compress(array.tobytes())).decode())
StoredScores = Annotated[Scores, PlainValidator(partial(_unpacked, np.float64)), _COMPRESSED]
StoredFlags = Annotated[Flags, PlainValidator(partial(_unpacked, np.bool_)), _COMPRESSED]
BEFORE_TICKS = 200
"""Ticks before a collision that count as leading to it: 2 s."""
WRONG_TICKS = 30
"""Ticks for which an action has to be wrong without a break to count: 0.3 s."""
_TOO_LATE_TICKS = 10
"""A score that rises later than 0.1 s before a collision warns too late to stop."""
_APART_TICKS = 300
"""Ticks below the threshold after which the next crossing is another question: an answer takes 3 s."""


class DriveLog(Settings):
    """Ticks of one drive; all arrays have shape (n,)."""

    world: str
    doubt: StoredScores
    distance: StoredScores
    """Distance / R of the nearest RLA."""
    driving: StoredFlags
    """True while an RLA's action drives and the robot was not set down in the last second."""
    missed: StoredFlags
    """True where the teacher's policy turns away and the robot does not."""
    collisions: tuple[int, ...]
    """Ticks in which collisions began."""
    seen: tuple[bool, ...] = ()
    """True for each collision with a thing that a sensor had seen, in the time that the robot remembers.

    Empty without a memory of obstacles.
    """
    travelled_m: float = 0.0
    """Distance on the robot's own wheels."""


@dataclass(frozen=True, slots=True)
class ScoreResult:
    """Quality of a score at one threshold."""

    auc: float
    """Probability that a wrong tick scores higher than a right one; NaN without wrong ticks."""
    caught: int
    """Collisions that the score told before."""
    caught_seen: int
    """Those among them with an obstacle that a sensor had seen."""
    questions: int
    false_questions: int
    """Questions that neither a wrong action nor a collision followed within 2 s."""


def wrong_ticks(log: DriveLog) -> Flags:
    """Return the ticks (n,) with a lasting missed turn away, or with a collision within 2 s."""
    wrong = np.zeros(len(log.missed), dtype=np.bool_)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], log.missed.astype(np.int8), [0]))))
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        wrong[begin:end] = end - begin >= WRONG_TICKS
    for tick in log.collisions:
        wrong[max(0, tick - BEFORE_TICKS) : tick] = True
    return wrong


def area_under_curve(scores: Scores, wrong: Flags) -> float:
    """Return the area under the ROC curve of scores (n,); NaN without wrong or right ticks."""
    if not wrong.any() or wrong.all():
        return float("nan")
    return float(mannwhitneyu(scores[wrong], scores[~wrong]).statistic) / (int(wrong.sum()) * int((~wrong).sum()))


def question_ticks(scores: Scores, driving: Flags, threshold: float) -> list[int]:
    """Return the ticks at which a robot with these scores (n,) would begin to ask; `driving` has shape (n,).

    Scores and threshold are dimensionless.
    """
    found: list[int] = []
    last = -_APART_TICKS - 1
    for tick in np.flatnonzero((scores >= threshold) & driving).tolist():
        if tick - last > _APART_TICKS:
            found.append(tick)
        last = tick
    return found


def judge_score(logs: Sequence[DriveLog], scores: Sequence[Scores], threshold: float) -> ScoreResult:
    """Return the quality of one score over all drives, at a threshold; both are dimensionless.

    `scores`: one array for each log, of shape (n,) with the log's n ticks.
    """
    wrong = [wrong_ticks(log) for log in logs]
    auc = area_under_curve(
        np.concatenate([each[log.driving] for log, each in zip(logs, scores, strict=True)]),
        np.concatenate([each[log.driving] for log, each in zip(logs, wrong, strict=True)]),
    )
    caught = caught_seen = questions = false_questions = 0
    for log, score, bad in zip(logs, scores, wrong, strict=True):
        warned = (score >= threshold) & log.driving
        for tick, seen in zip_longest(log.collisions, log.seen, fillvalue=False):
            told = bool(warned[max(0, tick - BEFORE_TICKS) : max(0, tick - _TOO_LATE_TICKS)].any())
            caught += told
            caught_seen += told and seen
        asked = question_ticks(score, log.driving, threshold)
        questions += len(asked)
        false_questions += sum(not bad[tick : tick + BEFORE_TICKS].any() for tick in asked)
    return ScoreResult(auc, caught, caught_seen, questions, false_questions)


def threshold_for(logs: Sequence[DriveLog], scores: Sequence[Scores], questions: int) -> float:
    """Return the lowest threshold at which drives with these scores have at most so many questions together.

    `scores`: one array for each log, of shape (n,) with the log's n ticks, dimensionless like the threshold.
    """
    candidates = np.unique(np.concatenate(scores))
    low, high = 0, len(candidates) - 1
    while low < high:
        middle = (low + high) // 2
        found = sum(
            len(question_ticks(each, log.driving, float(candidates[middle])))
            for log, each in zip(logs, scores, strict=True)
        )
        low, high = (low, middle) if found <= questions else (middle + 1, high)
    return float(candidates[low])
