"""Text of the health report: one row for each subject, and a sentence for each trouble."""

from typing import NamedTuple

from kurt2rt.channel.protocol.health import HealthReport, SensorAges, Trouble
from kurt2rt.core.progress import WINDOW_S, Progress

FINE, WARNS, URGENT = "", "warns", "urgent"
"""Level of a row: without trouble, with a trouble, with an urgent trouble."""


class HealthRow(NamedTuple):
    """Line of a health report: a subject, such as bus, and its state in words."""

    name: str
    text: str
    level: str
    """FINE, WARNS or URGENT."""


def rows_of(report: HealthReport) -> tuple[HealthRow, ...]:
    """Return one row (name, text, level) per subject of the report, in the order of the screens."""
    late, bus = report.punctuality, report.bus
    reached = f", {report.reached} so far" if report.reached else ""
    lately = f", {late.missed_lately} of them in the last minute" if late.missed_lately else ""
    rows = [
        ("does", report.doing),
        ("teacher", f"{report.teacher or 'none'}, phase {report.phase}{reached}"),
        (
            "lateness",
            f"now {late.newest_ms:.2f} ms; in a minute: median {late.median_ms:.2f}, p99 {late.p99_ms:.2f}, "
            f"worst {late.worst_ms:.2f} ms",
        ),
        ("ticks", f"{late.ticks:,} done, in {late.took_p99_ms:.2f} ms each (p99), {late.missed} missed{lately}"),
        ("sensors", _ages(report.ages)),
    ]
    if bus is not None:
        counts = {
            "junk": bus.junk,
            "error frames": bus.error_frames,
            "foreign CONTROL": bus.foreign_control,
            "send failures": bus.send_failures,
            "receive failures": bus.receive_failures,
        }
        wrong = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
        rows.append(("bus", f"{bus.controller}, {bus.frames:,} frames, {wrong or 'nothing wrong with them'}"))
    written = "all durable" if not report.safety.unwritten else f"{report.safety.unwritten} not durable yet"
    took_ms = report.safety.last_write_ms
    took = "" if took_ms is None else f"; the disk took {took_ms:.0f} ms for the last"
    rows.append(("lessons", f"{report.lessons} in force, {rules_in(report)}, {written}{took}"))
    rows.append(("progress", progress_in(report.progress)))
    rooms = [
        f"{each.of}: {'no answer' if each.free_bytes is None else f'{size(each.free_bytes)} free'}"
        for each in report.disks
    ]
    rows.append(("disk", ", ".join(rooms)))
    dropped = ", ".join(f"{each.count} {each.of}" for each in report.drops if each.count)
    rows.append(("queues", f"thrown away: {dropped}" if dropped else "nothing thrown away"))
    machine = report.machine
    parts = [f"{size(machine.memory_bytes)} of memory"]
    if machine.available_bytes is not None:
        parts.append(f"{size(machine.available_bytes)} left")
    parts.append(f"{machine.processor_share:.0%} of a core")
    if machine.battery is not None:
        parts.append(f"battery {machine.battery:.0%}{', discharging' if machine.discharging else ''}")
    rows.append(("machine", ", ".join(parts)))
    rows.append(("program", f"kurt2rt {report.version}, start {report.boot}, up {lasting(report.uptime_s)}"))
    rows.append(("robot", f"{report.robot}, task {report.task}, {report.knowledge}"))
    if report.plugins:
        rows.append(("plug-ins", "; ".join(report.plugins)))
    return tuple(HealthRow(name, text, _level(report, name)) for name, text in rows)


def trouble_in(trouble: Trouble) -> str:
    """Return a line with the fault, its duration and the remedy."""
    to_do = f": {trouble.to_do}" if trouble.to_do else ""
    return f"{trouble.what} (for {lasting(trouble.since_s)}){to_do}"


def lines_of(report: HealthReport | None) -> tuple[str, ...]:
    """Return the report as lines of a terminal; None: no report in the first second."""
    if report is None:
        return ("nothing is known yet, the robot program has just begun",)
    troubles = (f"{'!!' if each.urgent else '!'} {trouble_in(each)}" for each in report.troubles)
    return (headline(report), *(f"{row.name:<9} {row.text}" for row in rows_of(report)), *troubles)


def rules_in(report: HealthReport) -> str:
    """Return the number of rules and of their different actions, in words."""
    rules = "1 rule" if report.rlas == 1 else f"{report.rlas} rules"
    return f"{rules} of {'1 action' if report.actions == 1 else f'{report.actions} actions'}"


def progress_in(progress: Progress) -> str:
    """Return the progress of the last minute in words: the share driven by RLAs, and questions."""
    if progress.driven_percent is None:
        return "nothing was driven yet"
    asks = "asked what to do once" if progress.asks == 1 else f"asked what to do {progress.asks} times"
    over = "the last minute" if progress.seconds >= WINDOW_S else f"the first {progress.seconds} s"
    return f"{progress.driven_percent} % driven by itself, {asks} in {over}"


_NAMES = {
    "sensors": "sensors silent",
    "bus": "CAN bus",
    "lessons": "saving lessons",
    "disk": "disk",
    "ticks": "ticks missed",
    "lateness": "ticks late",
    "queues": "queues full",
    "machine": "this machine",
    "program": "the program",
}
"""Fault in one or two words, by the subject of a trouble."""


def name_of(trouble: Trouble) -> str:
    """Return the subject of a fault in one or two words, for a headline."""
    return _NAMES.get(trouble.about, trouble.about)


def headline(report: HealthReport) -> str:
    """Return a line with the names of all troubles, or `well`, and the lateness in ms."""
    late = report.punctuality
    punctual = f"late {late.p99_ms:.2f} ms (p99), missed {late.missed}"
    urgent = {name_of(each) for each in report.troubles if each.urgent}
    names = dict.fromkeys(name_of(each) for each in report.troubles)
    named = ", ".join(f"{name} (urgent)" if name in urgent else name for name in names)
    return f"{named or 'well'}; {punctual}"


def lasting(seconds: float) -> str:
    """Return a duration in s as text with at most two of its units, such as days and hours."""
    minutes, rest_s = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    days, hours = divmod(hours, 24)
    if days:
        return f"{days} d {hours} h"
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest_s} s" if minutes else f"{rest_s} s"


def size(count: int) -> str:
    """Return a number of bytes in kB, MB or GB."""
    for unit, bytes_each in (("GB", 10**9), ("MB", 10**6)):
        if count >= bytes_each:
            return f"{count / bytes_each:.{1 if unit == 'GB' else 0}f} {unit}"
    return f"{count / 1000:.0f} kB"


def _ages(ages: SensorAges) -> str:
    named = (("range sensors", ages.infrared_s), ("encoders", ages.encoders_s), ("bumpers", ages.bumpers_s))
    return ", ".join(f"{name} {_age(age_s)}" for name, age_s in named)


def _age(age_s: float | None) -> str:
    if age_s is None:
        return "never heard"
    return f"{age_s * 1000:.0f} ms old" if age_s < 1 else f"{lasting(age_s)} old"


def _level(report: HealthReport, name: str) -> str:
    about = [each for each in report.troubles if each.about == name]
    if any(each.urgent for each in about):
        return URGENT
    return WARNS if about else FINE
