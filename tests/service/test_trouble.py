"""Troubles while the robot runs: it stands, says why, and goes on as soon as it can."""

import resource
from collections.abc import Callable
from pathlib import Path

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.teaching.commands import Command, Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal_file import log_of
from tests.knowledge.reading import events_in
from tests.service.rig import end_service, rig, scripted

Step = Callable[[TickRecord], bool]


class Story:
    """Steps in order, each as soon as the one before has seen what it waited for; then the service ends."""

    def __init__(self, *steps: Step) -> None:
        self._steps = list(steps)

    @property
    def over(self) -> bool:
        return not self._steps

    def see(self, record: TickRecord) -> None:
        if self._steps and self._steps[0](record):
            self._steps.pop(0)
        if self.over:
            end_service()


def largest_file(size_bytes: int) -> None:
    """No file of this process may grow beyond: writes fail for real, as they do on a full disk."""
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))


async def test_serve_failing_disk_stops_until_lessons_are_saved(tmp_path: Path) -> None:
    knowledge = tmp_path / "knowledge"
    soft, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
    teacher = scripted()
    acting: list[str] = []
    unsaved: list[TickRecord] = []

    def a_lesson_is_saved(_record: TickRecord) -> bool:
        if not acting or log_of(knowledge).stat().st_size == 0:
            return False
        largest_file(log_of(knowledge).stat().st_size)
        return True

    def it_stands_for_a_while(record: TickRecord) -> bool:
        if record.decision.cause is DecisionCause.UNSAVED:
            unsaved.append(record)
        if len(unsaved) < 20:
            return False
        largest_file(soft)
        return True

    def it_goes_on(record: TickRecord) -> bool:
        if record.decision.cause is DecisionCause.UNSAVED:
            unsaved.append(record)
        return record.decision.cause is not DecisionCause.UNSAVED and record.decision.driving

    story = Story(a_lesson_is_saved, it_stands_for_a_while, it_goes_on)

    def watch(record: TickRecord) -> Command | None:
        acting.extend(result.command_id for result in record.results if result.code is ResultCode.RLA_TAUGHT)
        story.see(record)
        return teacher(record)

    with rig() as here:
        try:
            await here.serve(knowledge, watch)
        finally:
            largest_file(soft)
    assert story.over
    assert all(record.decision.wheel_speeds == STANDSTILL for record in unsaved)
    assert all(record.guard_result.wheel_speeds == STANDSTILL for record in unsaved)
    assert [event.origin.command_id for event in events_in(knowledge)] == acting


async def test_serve_lost_bus_stops_until_resume(tmp_path: Path) -> None:
    teacher = scripted()
    lost: list[TickRecord] = []
    said: list[Command] = []

    def it_drives(record: TickRecord) -> bool:
        if record.guard_result.wheel_speeds == STANDSTILL:
            return False
        here.robot_bus.shutdown()
        return True

    def the_bus_is_back(record: TickRecord) -> bool:
        lost.append(record)
        fresh = record.readings.infrared_age_s < 0.05 and record.readings.encoder_age_s < 0.05
        if not fresh or len(lost) < 20:
            return False
        said.append(Resume("resume-1", "scripted teacher"))
        return True

    def it_drives_again(record: TickRecord) -> bool:
        return record.guard_result.wheel_speeds != STANDSTILL

    story = Story(it_drives, the_bus_is_back, it_drives_again)

    def watch(record: TickRecord) -> Command | None:
        story.see(record)
        return said.pop() if said else teacher(record)

    with rig() as here:
        await here.serve(tmp_path / "knowledge", watch)
        assert story.over
        assert here.robot.health.receive_failures > 0
    assert all(record.guard_result.latched for record in lost)
    assert all(record.guard_result.wheel_speeds == STANDSTILL for record in lost)
    assert {record.guard_result.reasons for record in lost} == {("bus lost",)}
