"""Minute log of the robot's activity and the program's resources."""

from hal.robot import STANDSTILL
from kurt2rt.checks.soak.disk_list import Spool
from kurt2rt.checks.soak.program_run import ProgramRun
from kurt2rt.checks.soak.resource_usage import open_files, resident_mb, threads
from kurt2rt.checks.soak.result import SoakMinute
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.tick_record import TickRecord


class MinuteLog:
    """Counter of ticks, summed up each minute."""

    def __init__(self) -> None:
        self.minutes: Spool[SoakMinute] = Spool()
        self._ticks = self._drives = self._asks = self._stopped = self._missed = 0
        self._worst_late_s = 0.0

    def on_tick(self, record: TickRecord, late_s: float, missed: int) -> None:
        """Count a tick: its lateness in s, and the number of ticks missed before it."""
        self._ticks += 1
        self._drives += record.guard_result.wheel_speeds != STANDSTILL
        self._asks += record.decision.asking
        self._stopped += record.guard_result.latched or record.decision.cause in (
            DecisionCause.STOPPED,
            DecisionCause.UNATTENDED,
        )
        self._missed += missed
        self._worst_late_s = max(self._worst_late_s, late_s)

    def end_minute(self, at_s: float, program: ProgramRun, mood: str) -> None:
        """Append the sums of the minute that ends at `at_s`, in s, and start the next ones from 0.

        `program`: running program. `mood`: of the teacher.
        """
        ticks = max(1, self._ticks)
        self.minutes.append(
            SoakMinute(
                at_s=at_s,
                resident_mb=round(resident_mb(), 3),
                open_files=open_files(),
                threads=threads(),
                rlas=len(program.runtime.level.system),
                lessons=program.knowledge.lessons,
                drives=round(self._drives / ticks, 4),
                asks=round(self._asks / ticks, 4),
                stopped=round(self._stopped / ticks, 4),
                worst_late_s=round(self._worst_late_s, 6),
                missed_ticks=self._missed,
                mood=mood,
            )
        )
        self._ticks = self._drives = self._asks = self._stopped = self._missed = 0
        self._worst_late_s = 0.0
