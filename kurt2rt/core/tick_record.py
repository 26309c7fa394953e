"""Record of one tick: its inputs, decision and results."""

from typing import NamedTuple

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import GuardResult, SensorReadings
from hal.sensor_watch import BrokenSensor
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Decision, MidDecision
from kurt2rt.core.decision.standing import DRIVES, Standing
from kurt2rt.core.expectations.expectations import Surprise
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.teaching.commands import CommandResult
from kurt2rt.core.teaching.inbox import Input


class TickRecord(NamedTuple):
    """Inputs, decision and results of one tick, as channel, recorder and scripted teachers read them."""

    tick: int
    now_s: float
    readings: SensorReadings
    situation: Situation
    decision: Decision
    guard_result: GuardResult
    results: tuple[CommandResult, ...]
    """Answers to the teacher's commands of this tick."""
    behaviour: str = ""
    """The active behaviour."""
    appraisal_features: AppraisalFeatures | None = None
    """The critic's features; None without a critic and while the robot is blind."""
    opinion: Opinion | None = None
    """The critic's opinion of the features; None without a critic and before its first lesson."""
    surprise: Surprise | None = None
    """Comparison with the expectation of the RLA that ended in this tick; None if none ended."""
    commands: tuple[Input, ...] = ()
    """Messages taken from the inbox, in order."""
    saving_error: str | None = None
    """Reason that lessons cannot be saved, read once in this tick; None if they can."""
    events: tuple[TeachingEvent, ...] = ()
    """Changes of knowledge in this tick, by teachers and by the robot itself."""
    number: int = 0
    """1, 2, 3 ... of the ticks that were run; `tick` skips missed ticks."""
    knowledge: tuple[Rla, ...] | None = None
    """All active RLAs after this tick, if it changed them and once a second; None otherwise."""
    standing: Standing = DRIVES
    """Reason that the robot stands, or DRIVES; while a question is open, that of its first tick (OpenQuestion)."""
    question_begins: bool = False
    """True in the first tick of a question."""
    broken_sensors: tuple[BrokenSensor, ...] = ()
    """Infra-red sensors that do not count in this tick."""
    lesson_speed: float = 1.0
    """Fraction of the decided speeds that was asked of the guard; below 1 in a slow lesson."""
    trusted_counts: tuple[int, ...] | None = None
    """Counts that the robot decided by, one per sensor, if they are not those of `readings`."""

    @property
    def mid(self) -> MidDecision | None:
        """Command of the mid level; None without one."""
        return self.decision.mid
