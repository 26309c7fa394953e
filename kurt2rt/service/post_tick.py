"""What the service does after each tick, when the wheels have been told: watch, ask, acknowledge, save, tell."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.decision.decision import withdrawn_rla_in
from kurt2rt.core.decision.standing_text import question_text
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.outcome_text import text_of
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.question import MidQuestion, Question, ask, ask_the_way
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter
from kurt2rt.platform.gc_control import collect_young
from kurt2rt.runs.recording.recorder import RunRecorder
from kurt2rt.runs.recording.run_files import budget_of
from kurt2rt.runtime import Runtime
from kurt2rt.service.health.monitor import HealthMonitor
from kurt2rt.service.settings import ServiceSettings

TickCallback = Callable[[TickRecord], Command | None]
"""Sees each tick's record and may answer with a command, inside the robot's own program."""


@dataclass(frozen=True, slots=True)
class ProgramStatus:
    """How the service stands, for the one who looks at it."""

    record: TickRecord
    runtime: Runtime
    unsaved_lessons: int
    trouble: str | None
    channel_trouble: str
    """What is wrong with the teacher's channel; empty when nothing is, or there is none."""
    recording_trouble: str = ""
    """The same of the recording."""


@dataclass(frozen=True, slots=True)
class ProgramConsole:
    """What the service tells. Called from the loop: none of these may wait."""

    status: Callable[[ProgramStatus], None]
    """Once per status period."""
    question: Callable[[Question | MidQuestion], None]
    """When the robot begins to ask, at most once a second: at the border of R it asks for moments at a time."""
    acknowledged: Callable[[Acknowledgement], None]
    """A lesson is durable, or never can be, and why."""
    taught: Callable[[str], None] = lambda _: None
    """A lesson is durable; in words."""


class PostTick:
    """One round after each tick. Nothing here waits."""

    def __init__(
        self,
        runtime: Runtime,
        writer: JournalWriter,
        stamps: dict[str, str],
        service: ServiceSettings,
        screen: ProgramConsole,
        teacher: TickCallback | None,
        channel: Channel | None,
        health: HealthMonitor | None = None,
        recorder: RunRecorder | None = None,
    ) -> None:
        """`stamps`: when each lesson was written, by command id; goes on here."""
        self._runtime = runtime
        self._writer = writer
        self._stamps = stamps
        self._screen = screen
        self._teacher = teacher
        self._channel = channel
        self._health = health
        self._recorder = recorder
        self._words = words_for(runtime.robot.infrared)
        self._ticks_per_second = round(1 / runtime.robot.can.cycle_s)
        self._set_periods(service)
        self._unsettled: dict[str, str] = {}
        """Lessons that are not durable yet, in words, by command id."""
        self._asking = False
        self._asked_at = -self._ticks_per_second
        self.last: ProgramStatus | None = None
        """The last status that was shown."""

    def __call__(self, record: TickRecord) -> None:
        """The round after one tick."""
        runtime, writer, ticks = self._runtime, self._writer, self._runtime.timer.ticks
        runtime.progress.update(record)
        if self._teacher is not None:
            command = self._teacher(record)
            if command is not None:
                runtime.inbox.put(command)
        for result in record.results:
            if result.lesson:
                self._unsettled[result.command_id] = text_of(result.outcome)
        if self._channel is not None:
            self._channel.after_tick(record)
        if self._health is not None:
            self._health.after_tick(record)
        speed = runtime.handler.authority.speed
        saves = ticks % (self._checkpoint_ticks * speed) == 0
        if self._recorder is not None:
            # Before all that is noted at its time: the question that comes of it, and what became of lessons.
            self._recorder.on_tick(record, saved=saves)
        self._ask(record)
        for acknowledgement in writer.acknowledged():
            self.on_acknowledged(acknowledgement)
        if saves:
            self.save_statistics()
        if ticks % (self._status_ticks * speed) == 0:
            channel_trouble = "" if self._channel is None else self._channel.trouble
            recording_trouble = "" if self._recorder is None else self._recorder.trouble
            self.last = ProgramStatus(
                record, runtime, writer.unwritten, writer.error, channel_trouble, recording_trouble
            )
            self._screen.status(self.last)
        if ticks % self._ticks_per_second == 0:
            collect_young()

    def apply_settings(self, service: ServiceSettings) -> None:
        """Go by these periods, and this budget for recordings, from now on."""
        self._set_periods(service)
        if self._recorder is not None:
            self._recorder.take(budget_of(service.recordings_mb))

    def _set_periods(self, service: ServiceSettings) -> None:
        period_s = self._runtime.robot.can.cycle_s
        self._checkpoint_ticks = round(service.checkpoint_period_s / period_s)
        self._status_ticks = round(service.status_period_s / period_s)

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """A lesson is durable, or never can be."""
        if acknowledgement.stamped_at:
            self._stamps[acknowledgement.command_id] = acknowledgement.stamped_at
        if self._channel is not None:
            self._channel.settled(acknowledgement)
        if self._recorder is not None:
            self._recorder.on_acknowledged(acknowledgement)
        self._screen.acknowledged(acknowledgement)
        text = self._unsettled.pop(acknowledgement.command_id, "")
        if text and acknowledgement.error is None:
            self._screen.taught(text)

    def save_statistics(self) -> None:
        """Hand what was counted, and what the RLAs are worth, to the journal's thread."""
        self._writer.submit_statistics(self._runtime.snapshot())

    def _ask(self, record: TickRecord) -> None:
        if not record.decision.asking:
            self._asking = False
        elif not self._asking and record.tick - self._asked_at >= self._ticks_per_second:
            self._asking = True
            self._asked_at = record.tick
            question = self._question_of(record)
            if self._recorder is not None:
                self._recorder.on_question(question)
            self._screen.question(question)

    def _question_of(self, record: TickRecord) -> Question | MidQuestion:
        runtime, match = self._runtime, record.decision.match
        if runtime.mid is not None and record.decision.asks_at == MID:
            return ask_the_way(match, runtime.mid.settings.situation.words(runtime.mid.vector))
        weights, names = runtime.level.system.weights, runtime.definition.names
        question = ask(match, record.situation.vector, weights, names, record.behaviour, words=self._words)
        blamed = withdrawn_rla_in(record.decision)
        worth = None if blamed is None else float(runtime.reinforcement.worth(blamed))
        return replace(question, worth=worth, touches=question_text(record.standing))
