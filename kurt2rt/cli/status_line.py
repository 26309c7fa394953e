"""The line that tells once a second how the robot's program is."""

from hal.health import Health
from kurt2rt.rla.rla import MID, rla_title
from kurt2rt.rounds import Status
from kurt2rt.standing_text import in_short


def status_line(status: Status, health: Health) -> str:
    """One line: what drives the wheels and why, lessons, punctuality, and what is wrong."""
    record, runtime = status.record, status.runtime
    lateness = runtime.ledger.lateness()
    parts = [
        f"{record.tick * runtime.robot.can.cycle_s:8.1f} s",
        f"{doing(status):<48}",
        f"{len(runtime.level.system):3d} RLAs",
        f"late {lateness.median_us / 1000:.2f} ms, p99 {lateness.p99_us / 1000:.2f} ms",
        f"missed {runtime.ledger.missed_ticks}",
    ]
    return " | ".join([*parts, *troubles(status, health)])


def doing(status: Status) -> str:
    """What drives the wheels and why, or why the robot stands."""
    record = status.record
    decision, match, stands = record.decision, record.decision.match, in_short(record.standing)
    near = "" if match is None else f" at {match.distance:.0f} of R {match.radius:.0f}"
    if stands:
        return stands
    if decision.rla_id is not None:
        text = f"{decision.action} by {rla_title(decision.rla_id, record.behaviour)}{near}"
    elif decision.driving:
        text = f"{decision.action}, as the teacher says"
    elif decision.asking and decision.asks_at == MID:
        text = "stands and asks the way" + ("" if match is None else f", nearest {match.rla.title}{near}")
    else:
        about = f" about {record.behaviour}" if record.behaviour else ""
        text = "stands and asks" + (about if match is None else f", nearest {match.rla.title}{near}")
    if decision.mid is not None and decision.driving:
        by = "its teacher" if decision.mid.rla_id is None else rla_title(decision.mid.rla_id, "", MID)
        text += f", sent by {by}"
    return text


def troubles(status: Status, health: Health) -> list[str]:
    """What is wrong, each part in words; empty when nothing is."""
    record, runtime = status.record, status.runtime
    parts = []
    if record.grant.reasons:
        parts.append("guard: " + ", ".join(record.grant.reasons))
    if status.unsaved_lessons:
        parts.append(f"{status.unsaved_lessons} lessons not saved yet")
    if status.trouble is not None:
        parts.append(status.trouble)
    if runtime.school.learning.trouble:
        parts.append(runtime.school.learning.trouble)
    if status.channel_trouble:
        parts.append(status.channel_trouble)
    if status.recording_trouble:
        parts.append(status.recording_trouble)
    if health.trouble:
        parts.append(health.trouble)
    if health.foreign_control:
        parts.append(f"{health.foreign_control} CONTROL frames of another sender so far")
    return parts
