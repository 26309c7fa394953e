"""Status line of the robot program, once a second."""

from hal.health import Health
from kurt2rt.service.health.snapshot import format_activity
from kurt2rt.service.post_tick import ProgramStatus


def status_line(status: ProgramStatus, health: Health, trouble: str = "") -> str:
    """Return one line: what drives the wheels and why, lessons, lateness, and what is wrong, `trouble` last."""
    parts = [f"{_clock_s(status):8.1f} s", f"{format_activity(status.record):<48}", *format_numbers(status)]
    return " | ".join([*parts, *format_problems(status, health), *([trouble] if trouble else [])])


def format_numbers(status: ProgramStatus) -> list[str]:
    """Return how many RLAs there are, and how punctual the loop is, each in words."""
    runtime = status.runtime
    lateness = runtime.timer.lateness()
    return [
        f"{len(runtime.level.system):3d} RLAs",
        f"late {lateness.median_us / 1000:.2f} ms, p99 {lateness.p99_us / 1000:.2f} ms",
        f"missed {runtime.timer.missed_ticks}",
    ]


def format_timed_activity(status: ProgramStatus) -> str:
    """Return the time since the start, and what drives the wheels or why they stand."""
    return f"{_clock_s(status):.1f} s  {format_activity(status.record)}"


def _clock_s(status: ProgramStatus) -> float:
    return status.record.tick * status.runtime.robot.cycle_s


def format_problems(status: ProgramStatus, health: Health) -> list[str]:
    """Return what is wrong, each part in words; empty if nothing is."""
    return [*format_guard(status), *format_alarms(status, health)]


def format_guard(status: ProgramStatus) -> list[str]:
    """Return what the guard changed in this tick, in words; empty if it changed nothing."""
    reasons = status.record.guard_result.reasons
    return ["guard: " + ", ".join(reasons)] if reasons else []


def format_alarms(status: ProgramStatus, health: Health) -> list[str]:
    """Return what is wrong besides what the guard changes in passing, each part in words."""
    unsaved, foreign = status.unsaved_lessons, health.foreign_control
    alarms = (
        f"{unsaved} lessons not saved yet" if unsaved else None,
        status.saving_error,
        status.runtime.handler.updater.error,
        status.channel_trouble,
        status.recording_trouble,
        health.trouble,
        f"{foreign} CONTROL frames of another sender so far" if foreign else None,
    )
    return [each for each in alarms if each]
