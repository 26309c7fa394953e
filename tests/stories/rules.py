"""Rules that hold in every story, whatever fails, by code that shares nothing with the guard."""

import math
from pathlib import Path

from hal.guard_reason import GuardReason
from hal.points import Point
from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import ASKING, StandReason
from kurt2rt.core.rla.rla import AUTONOMOUS
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal import Journal
from tests.stories.device import Device
from tests.stories.story import CALM_S, Story
from tests.stories.table import TABLE, Fault
from tests.stories.witness import Witness

WORKS_AGAIN_S = 5.0
"""Time after the last fault in which the robot drives again, or asks."""
LASTING_S = 3.0
"""Time after a fault in which the robot may still stand because of it: until a teacher has said Go."""
_ALWAYS = frozenset({"stopped", "unknown", "teacher", "unattended", "front bumper", "rear bumper", "touches", "blind"})
"""Reasons to stand that need no fault: a teacher's, a question, what is in the way; blind is told by its sensors."""
_DROVE_S = 0.3
_ROUNDING_S = 1e-6
_SILENT_S = 0.35
"""Time after the teachers' last message in which the robot may drive, before phase 5."""
_PICTURE_TICKS = 37
"""Ticks since the newest state that its teachers saw in which the robot may drive, before phase 5."""
_UNSAVED_S = 0.05
"""Time after a disk's refusal in which the robot may drive: some ticks."""
_MANOEUVRE = 4.0
"""Factor of the time in which wheels show that they disobey, for a robot that turns and stops in between."""
_ROLLS_S = 0.5
"""Time after it was put elsewhere in which wheels that stand seem to disobey."""
_STARTS_S = 0.1
"""Time after a start in which readings arrive."""
_BECAUSE: dict[Point, frozenset[str]] = {
    "frames wait a cycle": frozenset({"bus blocked"}),
    "the send queue is full": frozenset({"bus lost"}),
    "the disk is late": frozenset({"unsaved"}),
    "the file is locked": frozenset({"unsaved"}),
    "a durable commit fails": frozenset({"unsaved"}),
}
"""Reasons to stand because of what happens at a point."""
_SPEAKS_S = 0.5
"""Time for which the guard may hold the robot before its teacher is told why."""
_LIMITS = frozenset({"speed limit", "slew limit"})


class Rules:
    """Judge of one story, besides its witness at the bus: why and when the robot stands, and what it keeps."""

    def __init__(self, story: Story, witness: Witness, device: Device) -> None:
        self.problems: list[str] = []
        """Broken rules, in order."""
        self.begun: list[Fault] = []
        """Faults that are under way, or over for less than LASTING_S."""
        self._story, self._witness, self._device = story, witness, device
        self._started_s = 0.0
        self._works = False
        self._reasons: frozenset[str] = frozenset()
        self._spoke_at_s = 0.0
        self.set_down_s = -math.inf
        """Time at which it was put elsewhere, its wheels at rest."""

    def on_start(self, now_s: float) -> None:
        """Note a start of the program."""
        self._started_s = self._spoke_at_s = now_s

    def on_error(self, error: str) -> None:
        """Complain of an error that ended the program, unless a clock or a tick failed for good."""
        if not any(
            fault.target in ("clock", "tick") and TABLE.cases[fault.target][fault.kind].ends_by == "restart"
            for fault in self.begun
        ):
            self.problems.append(f"the program ended by {error}")

    def on_tick(self, record: TickRecord, now_s: float, *, unsaved_s: float) -> None:
        """Judge a tick; times are simulated. `unsaved_s`: when lessons could no more be saved, or infinity."""
        story, over_s = self._story, self._story.over_s
        moves = record.guard_result.wheel_speeds != STANDSTILL
        if now_s <= max(over_s, story.lasts_s - CALM_S) + WORKS_AGAIN_S:
            # An action that a teacher taught by mistake may be to stand.
            acts = record.decision.driving and _LIMITS.issuperset(record.guard_result.reasons)
            self._works = now_s >= over_s and (self._works or acts or record.decision.cause in ASKING)
        if moves and story.teaching.phase < AUTONOMOUS:
            self._require_teacher(now_s)
        if moves and now_s - unsaved_s > _UNSAVED_S:
            self.problems.append(f"at {now_s:.2f} s: it drives though lessons cannot be saved since {unsaved_s:.2f} s")
        self._explain(record, now_s)
        self._require_words(record, now_s)

    def on_fault(self, fault: Fault) -> None:
        """Note the beginning of a fault."""
        if all(each.end_s < fault.begin_s for each in self.begun):
            self._witness.watch()
        self.begun.append(fault)

    def on_fault_over(self, fault: Fault) -> None:
        """Complain unless the robot stood as the table demands, where nothing else failed and it drove before."""
        witness, row = self._witness, TABLE.row(fault.target, fault.kind)
        within_s = row.stands_within_s
        # A disk stops it only by a lesson, a hand only one that drives.
        if within_s is None or fault.target in ("disk", "teacher_link"):
            return
        if row.latches == GuardReason.WHEELS_DISOBEY:
            # Until it is told to change its speed, and while a loose contact holds.
            within_s = within_s * _MANOEUVRE + (row.period_s if fault.kind == "intermittent" else 0.0)
        from_s, until_s = fault.begin_s - _DROVE_S, fault.begin_s + within_s
        alone = all(each is fault or each.end_s < from_s or each.begin_s > until_s for each in self.begun)
        if not alone or self._started_s > from_s or fault.end_s < until_s or not fault.acts(fault.begin_s):
            return
        if witness.slowest_m_s(from_s, until_s) < witness.limits.shows_m_s:
            return
        # If it is not reached, the robot's own watchdog makes it stand.
        is_long = fault.end_s - fault.begin_s >= witness.limits.controller_watchdog_s
        if is_long and not witness.standstills(fault.begin_s, fault.end_s):
            self.problems.append(f"{fault}: it did not stand")
        latched = witness.latched
        if row.latches is not None and (latched is None or latched[0] > until_s + _ROUNDING_S):
            self.problems.append(f"{fault}: it was to be stopped because of {row.latches}, was {latched}")

    def on_end(self, knowledge: Path) -> None:
        """Judge the end of the story: that it works again, and that `knowledge` has every lesson once."""
        self.problems += self._device.judge.problems
        if not self._works:
            self.problems.append(f"it neither drove nor asked within {WORKS_AGAIN_S:g} s after the last fault")
        with Journal.read_only(knowledge) as journal:
            stored = [entry.event.origin.command_id for entry in journal.iter_entries()]
        if lost := self._device.saved - set(stored):
            self.problems.append(f"{len(lost)} lessons that a teacher was told to be durable are gone")
        if len(set(stored)) != len(stored):
            self.problems.append("a lesson stands twice in the knowledge")

    def _require_teacher(self, now_s: float) -> None:
        """Complain of a robot that drives though its teachers are silent, or saw nothing for long."""
        judge = self._device.judge
        silent_s = now_s - judge.heard_at_s
        # A lease counts by the program's clock.
        if silent_s > _SILENT_S * self._witness.clock_slowness(LASTING_S):
            self.problems.append(f"at {now_s:.2f} s: it drives {silent_s:.2f} s after its teachers' last message")
        if judge.picture_ticks > _PICTURE_TICKS:
            self.problems.append(f"at {now_s:.2f} s: it drives, unseen for {_PICTURE_TICKS} ticks")

    def _require_words(self, record: TickRecord, now_s: float) -> None:
        """Complain of a robot that is held back and tells its teacher that it drives, or that it needs no resume."""
        wants = record.decision.driving and record.decision.wheel_speeds != STANDSTILL
        is_held = wants and record.guard_result.wheel_speeds == STANDSTILL
        if not is_held or record.standing.reason is not StandReason.DRIVES:
            self._spoke_at_s = now_s
        if now_s - self._spoke_at_s > _SPEAKS_S:
            self.problems.append(f"at {now_s:.2f} s: it says that it drives, held by {record.guard_result.reasons}")
        if record.guard_result.latched and not record.standing.needs_resume:
            self.problems.append(f"at {now_s:.2f} s: it is stopped for good and says that it needs no resume")

    def _explain(self, record: TickRecord, now_s: float) -> None:
        """Complain of a new reason to stand that no fault gives; one that holds on was explained as it came."""
        cause = () if record.decision.driving else (record.decision.cause,)
        reasons = frozenset((*cause, *record.guard_result.reasons)) - _ALWAYS - _LIMITS
        new, self._reasons = reasons - self._reasons, reasons
        for fault in self.begun:
            new -= TABLE.row(fault.target, fault.kind).reasons
        if now_s - self.set_down_s < _ROLLS_S:
            new -= {GuardReason.WHEELS_DISOBEY}
        for point in self._story.points:
            new -= _BECAUSE.get(point, frozenset())
        if new and now_s - self._started_s > _STARTS_S:
            self.problems.append(f"at {now_s:.2f} s: it stands because of {', '.join(sorted(new))}, why?")
