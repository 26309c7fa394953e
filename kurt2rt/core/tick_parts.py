"""Parts and settings of a tick."""

from dataclasses import dataclass

from hal.robot import Robot
from hal.sensor_ring import SubstituteReadings
from hal.sensor_watch import SensorWatch
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.decision.decision import Level
from kurt2rt.core.event_store import EventStore
from kurt2rt.core.expectations.tracker import ExpectationTracker
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.inbox import TeacherInbox
from kurt2rt.platform.tick_timer import TickTimer


@dataclass(frozen=True, slots=True, kw_only=True)
class TickParts:
    """Parts that a `Tick` calls, in any order; `kurt2rt.runtime` builds them, None for what a task lacks."""

    robot: Robot
    perception: Perception
    level: Level
    handler: CommandHandler
    inbox: TeacherInbox
    event_store: EventStore
    statistics: StatisticsCounter
    timer: TickTimer
    appraisal_perception: AppraisalPerception | None = None
    """Features for the handler's critic; None without a critic."""
    expectations: ExpectationTracker | None = None
    """None: nothing is expected."""
    sensor_watch: SensorWatch | None = None
    """Detector of single broken sensors; None: all readings are trusted."""
    substitute: SubstituteReadings | None = None
    """Readings instead of those of broken sensors; given with a `sensor_watch`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TickOptions:
    """Limits of a tick that the robot's and the service's settings give."""

    stale_infrared_s: float
    """The robot is blind if its infra-red readings are older."""
    tolerates_stalls: bool = False
    """Extend the teacher's leases by missed ticks, for a simulated robot that stalls with this program."""
    asks_at_bumper: bool = True
    """Ask if an RLA pushes on toward what a bumper touches."""
