"""Values of the program, read in its loop between two ticks."""

from collections.abc import Mapping
from dataclasses import dataclass

from hal.health import Health
from hal.robot import SensorReadings
from hal.sensor_watch import BrokenSensor
from kurt2rt.core.decision.standing import short_text
from kurt2rt.core.progress import NO_PROGRESS, Progress
from kurt2rt.core.rla.rla import MID, Rla, rla_title
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.runtime import Runtime
from kurt2rt.service.health.probes import Probes


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Values of the program after one tick, taken in the loop; a thread makes the health report of them."""

    tick: int
    now_s: float
    """Time of the clock that dates troubles, in s."""
    readings: SensorReadings
    bus: Health | None
    unwritten: int
    saving_error: str | None
    last_write_s: float | None
    drops: Mapping[str, int]
    errors: Mapping[str, str]
    """Error of each part with an error, in a line."""
    ticks: int
    missed_ticks: int
    active: tuple[Rla, ...]
    """Active RLAs of all levels."""
    lessons: int
    doing: str
    progress: Progress = NO_PROGRESS
    broken_sensors: tuple[BrokenSensor, ...] = ()
    phase: int = 1
    teacher: str | None = None
    """Present teacher; None without teacher."""
    reached: str = ""
    """Progress of a simulated robot with its task; empty if it is not measured."""


def take_snapshot(
    runtime: Runtime, record: TickRecord, keeping: JournalWriter, instruments: Probes, now_s: float
) -> Snapshot:
    """Return the values of a program after a tick; takes some 10 µs and never waits.

    Args:
        runtime: of the program.
        record: of the tick.
        keeping: writer of the journal.
        instruments: parts outside the runtime.
        now_s: present time of the monotonic clock, in s.
    """
    system, timer = runtime.level.system, runtime.timer
    errors = {part: error() for part, error in instruments.errors.items()}
    errors["teaching"] = runtime.handler.updater.error
    return Snapshot(
        tick=record.tick,
        now_s=now_s,
        readings=record.readings,
        bus=None if instruments.bus is None else instruments.bus(),
        unwritten=keeping.unwritten,
        saving_error=keeping.saving_error,
        last_write_s=keeping.last_write_s,
        drops={queue: count() for queue, count in instruments.drops.items()},
        errors={part: line for part, line in errors.items() if line},
        ticks=timer.ticks,
        missed_ticks=timer.missed_ticks,
        active=system.active_rlas,
        lessons=system.history.standing,
        progress=runtime.progress.progress(),
        doing=format_activity(record),
        broken_sensors=record.broken_sensors,
        phase=int(runtime.handler.phase),
        teacher=runtime.handler.authority.teacher,
        reached=instruments.reached(),
    )


def format_activity(record: TickRecord) -> str:
    """Return what drives the wheels and why, or why the robot stands."""
    asks = record.standing.asks
    decision, match, stands = record.decision, record.decision.match, short_text(record.standing)
    near = "" if match is None else f" at {match.distance:.0f} of R {match.radius:.0f}"
    if stands:
        return stands
    if decision.rla_id is not None and not asks:
        text = f"{decision.action} by {rla_title(decision.rla_id, record.behaviour)}{near}"
    elif decision.driving and not asks:
        text = f"{decision.action}, as the teacher says"
    elif decision.asking and decision.asks_at == MID:
        text = "stands and asks the way" + ("" if match is None else f", nearest {match.rla.title}{near}")
    else:
        about = f" about {record.behaviour}" if record.behaviour else ""
        text = "stands and asks" + (about if match is None else f", nearest {match.rla.title}{near}")
    if decision.mid is not None and decision.driving and not asks:
        by = "its teacher" if decision.mid.rla_id is None else rla_title(decision.mid.rla_id, "", MID)
        text += f", sent by {by}"
    return text
