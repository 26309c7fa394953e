"""Drive without a teacher in which the doubt of each tick is logged, and measures of a score from these ticks."""

import random
import zlib
from base64 import b64decode, b64encode
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import zip_longest
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator

from config.settings import Settings, SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.runtime import Runtime
from simbridge.contracts.simulation import Simulation

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
    """Log of one drive of n ticks: doubt, distance, and what went wrong; all arrays have shape (n,)."""

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
    """Quality of a score, doubt or distance, as a warning before wrong actions and collisions."""

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
    """Return the ticks (n,) in which a robot does wrong, before which a score should have warned.

    These are lasting missed turns away, and the 2 s before each collision.
    """
    wrong = np.zeros(len(log.missed), dtype=np.bool_)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], log.missed.astype(np.int8), [0]))))
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        wrong[begin:end] = end - begin >= WRONG_TICKS
    for tick in log.collisions:
        wrong[max(0, tick - BEFORE_TICKS) : tick] = True
    return wrong


def area_under_curve(scores: Scores, wrong: Flags) -> float:
    """Return the area under the ROC curve of scores (n,); NaN without wrong or right ticks."""
    from scipy.stats import mannwhitneyu  # an extra, and every command loads this module where --help is said

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


_STUCK_S = 15.0
_AT_OUTLINE_M = 0.05
"""Distance from the outline at which a remembered obstacle is what the robot touches: noise, and 2 s by encoders."""
_SETTLES_S = 1.0


class DoubtResponse(StrEnum):
    """Response to doubt of a robot without a teacher: it only logs the doubt, or it stands."""

    TELLS = "only told"
    STANDS = "stands"


@dataclass(frozen=True, slots=True)
class DoubtSetup:
    """Setup of one drive in which doubt is logged: world, seed, duration, and the response to doubt."""

    world: str
    seed: int
    duration_s: float
    response: DoubtResponse
    set_down_after_s: float
    """Time after which a robot that asks, and gets no answer, is set down at another start; 0: it stands on."""


def with_doubt(task: TaskSettings, response: DoubtResponse) -> TaskSettings:
    """Return the task with a robot that responds so to its doubt also without a teacher.

    Raises config.settings.SettingsError if the task sets no doubt.
    """
    doubt = task.learning.doubt
    if doubt is None:
        raise SettingsError("sets no doubt", where=f"task {task.name}: learning.doubt", do="give its scales there")
    stands = response is DoubtResponse.STANDS
    doubt = doubt.model_copy(update={"asks": stands, "alone": stands})
    return task.model_copy(update={"learning": task.learning.model_copy(update={"doubt": doubt})})


class DoubtRun(Episode):
    """Drive without a teacher that logs, tick by tick, doubt, missed turns and collisions."""

    def __init__(
        self, simulation: Simulation, runtime: Runtime, setup: DoubtSetup, on_progress: Callable[[float], None]
    ) -> None:
        chance = random.Random(f"doubt in world {setup.world}, seed {setup.seed}")
        super().__init__(simulation, runtime, chance, stuck_after_s=_STUCK_S, on_progress=on_progress)
        self._world = setup.world
        self._policy = runtime.task.policy.build(runtime.robot.infrared)
        meter = runtime.level.doubt
        assert meter is not None
        self._drives_on = meter.actions
        self._memory = meter.memory
        self._seen: list[bool] = []
        self._settles = round(_SETTLES_S / self.period_s)
        self._unanswered = round(setup.set_down_after_s / self.period_s)
        self._asked_ticks = 0
        self._settled_at = 0
        self._ticks: list[tuple[float, float, bool, bool]] = []
        """Doubt, distance, driving and missed of each tick (DriveLog)."""
        self._collisions: list[int] = []
        self._counted = 0

    def on_tick(self, record: TickRecord) -> None:
        """Log one tick; set the robot down elsewhere if it is stuck or its question is not answered."""
        self.measure()
        decision, match = record.decision, record.decision.match
        right = self._policy.choose(record.readings.infrared_counts, record.behaviour)
        missed = decision.action in self._drives_on and right not in self._drives_on
        distance = 0.0 if match is None else match.distance / match.radius
        driving = decision.driving and record.tick >= self._settled_at
        self._ticks.append((decision.doubt or 0.0, distance, driving, missed))
        if self.simulation.collisions > self._counted:
            self._counted = self.simulation.collisions
            self._collisions.append(len(self._ticks) - 1)
            self._seen.append(self._memory is not None and self._memory.remembers_within(_AT_OUTLINE_M))
        if record.guard_result.latched:
            self.simulation.rescue()
            self.send(Resume(self.next_id("go"), "experimenter"))
        self._asked_ticks = self._asked_ticks + 1 if decision.asking else 0
        unanswered = 0 < self._unanswered <= self._asked_ticks
        if unanswered or self.is_stuck(waiting=decision.asking):
            self.reposition()
            self.runtime.reposition()
            self._asked_ticks = 0
            self._settled_at = record.tick + self._settles

    def log(self) -> DriveLog:
        """Return the log of the ticks so far."""
        doubt, distance, driving, missed = zip(*self._ticks, strict=True)
        return DriveLog(
            world=self._world,
            doubt=np.array(doubt),
            distance=np.array(distance),
            driving=np.array(driving, dtype=np.bool_),
            missed=np.array(missed, dtype=np.bool_),
            collisions=tuple(self._collisions),
            seen=tuple(self._seen),
            travelled_m=self.distance_travelled_m,
        )
