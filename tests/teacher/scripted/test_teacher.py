"""ScriptedTeacher: reaction time, patience, errors and deletions."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hal.robot import STANDSTILL, GuardResult
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, SetPhase, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher
from tests.core.helpers import sensed

NAME = "scripted teacher"
REACTION_TICKS, PATIENCE_TICKS = 100, 50
FAR, NEAR = 100, 500


class NearIsB:
    """Policy: b if the first count is high, else a; c for the behaviour `other`."""

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        if behaviour == "other":
            return "c"
        return "b" if infrared_counts[0] > 300 else "a"


def teacher(phase: Phase = Phase.CORRECTIONS, *, seed: int = 1, **changes: Any) -> ScriptedTeacher:
    settings = TeacherSettings(**{"reaction_s": 1.0, "patience_s": 0.5, "error_rate": 0.0, **changes})
    person = ScriptedTeacher(NearIsB(), "abcd", settings, period_s=0.01, seed=seed, session="s")
    if phase is not Phase.SUPERVISED:
        person.begin_phase(phase)
    return person


def record_of(decision: Decision, count: int = FAR, *, tick: int = 1, **more: Any) -> TickRecord:
    """Return a tick with this decision, in which all sensors of the robot count the same."""
    situation = Situation(np.zeros(1), history_frozen=decision.action is None)
    grant = GuardResult(STANDSTILL, (), latched=False)
    return TickRecord(tick, 0.01 * tick, sensed(count), situation, decision, grant, (), **more)


def asking(count: int = FAR) -> TickRecord:
    return record_of(Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None), count)


def doing(action: str, count: int = FAR) -> TickRecord:
    return record_of(Decision(STANDSTILL, DecisionCause.RLA, action, 1, None), count)


def given(person: ScriptedTeacher, records: Sequence[TickRecord]) -> dict[int, Command]:
    """Return the commands by tick, counted from 1."""
    heard = {number: person.update(view_of_tick(each)) for number, each in enumerate(records, start=1)}
    return {number: command for number, command in heard.items() if command is not None}


def test_update_asking_answers_after_the_reaction_time() -> None:
    person = teacher(Phase.SUPERVISED)
    records = [asking(FAR)] * (REACTION_TICKS - 1) + [asking(NEAR)]
    assert given(person, records) == {REACTION_TICKS: Teach("s-1", NAME, "b")}


def test_update_phase_2_corrects_after_the_patience() -> None:
    answers = given(teacher(), [doing("b", FAR)] * PATIENCE_TICKS)
    assert answers == {PATIENCE_TICKS: Correct("s-2", NAME, "a")}


def test_command_ids_are_unique_and_equal_in_each_run() -> None:
    def ids() -> list[str]:
        person = teacher(Phase.SUPERVISED, error_rate=0.3)
        commands = [person.begin_phase(Phase.CORRECTIONS)]
        for _ in range(5):
            commands += given(person, [asking()] * REACTION_TICKS + [doing("b")] * PATIENCE_TICKS).values()
        return [command.command_id for command in commands if isinstance(command, Teach | Correct | SetPhase)]

    assert ids() == ids() == [f"s-{number}" for number in range(1, 12)]


def test_corrections_with_errors_err_at_the_rate() -> None:
    commands = given(teacher(patience_s=0.0, error_rate=0.25), [doing("d")] * 4000)
    right = sum(isinstance(command, Correct) and command.action == "a" for command in commands.values())
    assert abs(right / 4000 - 0.75) < 0.03


def wanting(behaviour: str, seen: TickRecord) -> TickRecord:
    return seen._replace(behaviour=behaviour)


def test_update_other_behaviour_resets_question_and_patience() -> None:
    person = teacher()
    given(person, [asking()] * (REACTION_TICKS - 1))
    assert given(person, [wanting("other", doing("c"))] * REACTION_TICKS) == {}
    given(person, [doing("b")] * (PATIENCE_TICKS - 1))
    assert list(given(person, [wanting("other", doing("b"))] * PATIENCE_TICKS)) == [PATIENCE_TICKS]
