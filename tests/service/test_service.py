from pathlib import Path

import pytest

from config.settings import SettingsError
from hal.control import encode_brake
from hal.guard_reason import GuardReason
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.question import Question
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from tests.knowledge.reading import events_in
from tests.service.rig import Rig, eager_task, end_service, rig, scripted


async def teach_until(lessons: int, here: Rig, knowledge: Path) -> list[str]:
    """Let the scripted teacher answer until so many lessons act, then end the service; returns their command ids."""
    teacher = scripted()
    acting: list[str] = []

    def watch(record: TickRecord) -> Command | None:
        acting.extend(result.command_id for result in record.results if result.code is ResultCode.RLA_TAUGHT)
        if len(acting) >= lessons:
            end_service()
            return None
        return teacher(record)

    await here.serve(knowledge, watch)
    return acting


def commands_in(knowledge: Path) -> list[str]:
    return [event.origin.command_id for event in events_in(knowledge)]


async def test_serve_teaches_brakes_at_its_end_and_goes_on_later(tmp_path: Path) -> None:
    knowledge = tmp_path / "var" / "new.knowledge"
    with rig() as here:
        first = await teach_until(2, here, knowledge)
        payloads = here.control_payloads()
        assert here.robot.health.latched is GuardReason.SERVICE_ENDS
    assert payloads[-1] == bytes(encode_brake().data)
    assert any(payload != payloads[-1] for payload in payloads)
    assert here.records[0].decision.asking
    assert any(record.decision.driving for record in here.records)
    assert isinstance(here.questions[0], Question)
    assert here.questions[0].nearest_rla is None
    with rig() as here:
        second = await teach_until(1, here, knowledge)
    assert commands_in(knowledge) == first + second
    assert not here.records[0].decision.asking or here.records[0].decision.match is not None
    with Journal.read_only(knowledge) as journal:
        statistics = journal.statistics()
        assert statistics.uses.keys() <= {rla.rla_id for rla in fold_journal(journal, 1.0).rlas}
        assert statistics.uses[1] >= 1


async def test_serve_unknown_action_is_refused_before_driving(tmp_path: Path) -> None:
    knowledge = tmp_path / "knowledge"
    with rig() as here:
        await teach_until(1, here, knowledge)
    task = eager_task()
    with rig() as here:
        with pytest.raises(SettingsError, match="repertoires"):
            await here.serve(knowledge, lambda _: None, task=task.model_copy(update={"repertoire": "other"}))
        assert here.records == []
        assert here.control_payloads() == []
    assert len(events_in(knowledge)) == 1
