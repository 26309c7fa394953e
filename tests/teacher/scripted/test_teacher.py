"""The scripted teacher: consistent, with a reaction time, patience, and errors where they are asked for."""

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from hal.robot import STANDSTILL, GuardResult
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, DeleteRla, Pursue, SetPhase, Teach
from kurt2rt.core.tick import TickRecord
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher, picture_of
from tests.core.helpers import sensed

NAME = "scripted teacher"
REACTION_TICKS, PATIENCE_TICKS = 100, 50
FAR, NEAR = 100, 500


class NearIsB:
    """Says b where the first count is high, else a; for the behaviour `other` c."""

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        if behaviour == "other":
            return "c"
        return "b" if infrared_counts[0] > 300 else "a"


def teacher(phase: Phase = Phase.CORRECTIONS, *, seed: int = 1, **changes: Any) -> ScriptedTeacher:
    settings = TeacherSettings(**{"reaction_s": 1.0, "patience_s": 0.5, "error_rate": 0.0, **changes})
    person = ScriptedTeacher(
        NearIsB(), "abcd", settings, replace_within_share=0.1, period_s=0.01, seed=seed, session="s"
    )
    if phase is not Phase.SUPERVISED:
        person.enter(phase)
    return person


def record(
    count: int, cause: Cause, action: str | None = None, nearest: int = 1, share_of_radius: float = 0.0
) -> TickRecord:
    """A tick as the teacher sees it: RLA 1 drives, if any does, and `nearest` is so near."""
    rla_id = None if action is None else 1
    rla = Rla(nearest, (0.0,), action or "a", None, Origin("t", NAME, Phase.SUPERVISED, 1))
    match = None if action is None else Match(rla, 500.0 * share_of_radius, 500.0, None, math.inf)
    decision = Decision(STANDSTILL, cause, action, rla_id, match)
    situation = Situation(np.zeros(1), history_frozen=action is None)
    return TickRecord(1, 0.01, sensed(count), situation, decision, GuardResult(STANDSTILL, (), latched=False), ())


def asking(count: int = FAR) -> TickRecord:
    return record(count, Cause.UNKNOWN)


def doing(action: str, count: int = FAR, cause: Cause = Cause.RLA) -> TickRecord:
    return record(count, cause, action)


def said(person: ScriptedTeacher, records: Sequence[TickRecord]) -> dict[int, Command]:
    """What it says in which tick, counted from 1."""
    heard = {number: person.watch(picture_of(each)) for number, each in enumerate(records, start=1)}
    return {number: command for number, command in heard.items() if command is not None}


def test_it_answers_a_question_after_its_reaction_time_with_what_the_policy_says_then() -> None:
    person = teacher(Phase.SUPERVISED)
    records = [asking(FAR)] * (REACTION_TICKS - 1) + [asking(NEAR)]
    assert said(person, records) == {REACTION_TICKS: Teach("s-1", NAME, "b")}


def test_asked_again_it_takes_its_reaction_time_again() -> None:
    person = teacher(Phase.SUPERVISED)
    answers = said(person, [asking()] * (2 * REACTION_TICKS))
    assert answers == {REACTION_TICKS: Teach("s-1", NAME, "a"), 2 * REACTION_TICKS: Teach("s-2", NAME, "a")}


def test_without_reaction_time_it_answers_in_the_first_tick() -> None:
    assert said(teacher(reaction_s=0.0), [asking()]) == {1: Teach("s-2", NAME, "a")}


def test_a_question_of_today_does_not_hurry_the_answer_of_tomorrow() -> None:
    person = teacher(Phase.SUPERVISED)
    said(person, [asking()] * REACTION_TICKS)
    said(person, [doing("a")] * 300)
    assert list(said(person, [asking()] * REACTION_TICKS)) == [REACTION_TICKS]


def test_in_phase_1_it_does_not_correct() -> None:
    assert said(teacher(Phase.SUPERVISED), [doing("b", FAR)] * 500) == {}


def test_in_phase_2_it_corrects_after_its_patience() -> None:
    answers = said(teacher(), [doing("b", FAR)] * PATIENCE_TICKS)
    assert answers == {PATIENCE_TICKS: Correct("s-2", NAME, "a")}


def test_a_held_action_tries_its_patience_as_well() -> None:
    assert list(said(teacher(), [doing("b", FAR, Cause.HELD)] * PATIENCE_TICKS)) == [PATIENCE_TICKS]


def test_in_phase_2_it_still_answers_questions() -> None:
    assert list(said(teacher(), [asking()] * REACTION_TICKS)) == [REACTION_TICKS]


def test_one_right_tick_gives_its_patience_back() -> None:
    records = [doing("b")] * (PATIENCE_TICKS - 1) + [doing("a")] + [doing("b")] * (PATIENCE_TICKS - 1)
    assert said(teacher(), records) == {}


def test_a_question_gives_its_patience_back() -> None:
    person = teacher()
    said(person, [doing("b")] * (PATIENCE_TICKS - 1))
    said(person, [asking()] * REACTION_TICKS)
    assert list(said(person, [doing("b")] * PATIENCE_TICKS)) == [PATIENCE_TICKS]


def test_patience_runs_for_one_opinion_at_a_time() -> None:
    flicker = [doing("c", FAR if tick % 2 else NEAR) for tick in range(10 * PATIENCE_TICKS)]
    assert said(teacher(), flicker) == {}


def test_after_a_correction_patience_begins_anew() -> None:
    answers = said(teacher(), [doing("b")] * (3 * PATIENCE_TICKS - 1))
    assert list(answers) == [PATIENCE_TICKS, 2 * PATIENCE_TICKS]


def test_a_stopped_robot_is_not_corrected() -> None:
    for cause in (Cause.STOPPED, Cause.UNSAVED):
        assert said(teacher(), [record(NEAR, cause)] * 500) == {}


def test_entering_a_phase_is_a_command() -> None:
    person = teacher(Phase.SUPERVISED)
    assert person.enter(Phase.CORRECTIONS) == SetPhase("s-1", NAME, Phase.CORRECTIONS)
    assert person.phase is Phase.CORRECTIONS


def test_every_command_has_an_id_of_its_own_and_the_same_one_in_every_run() -> None:
    def ids() -> list[str]:
        person = teacher(Phase.SUPERVISED, error_rate=0.3)
        commands = [person.enter(Phase.CORRECTIONS)]
        for _ in range(5):
            commands += said(person, [asking()] * REACTION_TICKS + [doing("b")] * PATIENCE_TICKS).values()
        return [command.command_id for command in commands if isinstance(command, Teach | Correct | SetPhase)]

    assert ids() == ids() == [f"s-{number}" for number in range(1, 12)]


def answers_to(person: ScriptedTeacher, questions: int) -> list[str]:
    commands = said(person, [asking()] * questions)
    return [command.action for command in commands.values() if isinstance(command, Teach)]


def test_an_error_names_any_other_action_as_often_as_the_rate_says() -> None:
    counted = Counter(answers_to(teacher(reaction_s=0.0, error_rate=0.25), 4000))
    assert sum(counted.values()) == 4000
    assert abs(counted["a"] / 4000 - 0.75) < 0.03
    for wrong in "bcd":
        assert abs(counted[wrong] / 4000 - 0.25 / 3) < 0.02


def test_corrections_err_as_answers_do() -> None:
    commands = said(teacher(patience_s=0.0, error_rate=0.25), [doing("d")] * 4000)
    right = sum(isinstance(command, Correct) and command.action == "a" for command in commands.values())
    assert abs(right / 4000 - 0.75) < 0.03


def test_without_errors_it_is_always_right_and_with_rate_1_never() -> None:
    assert set(answers_to(teacher(reaction_s=0.0), 300)) == {"a"}
    assert set(answers_to(teacher(reaction_s=0.0, error_rate=1.0), 300)) == {"b", "c", "d"}


def test_its_errors_are_those_of_its_seed() -> None:
    first, again, other = (answers_to(teacher(reaction_s=0.0, error_rate=0.5, seed=seed), 100) for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_an_rla_whose_action_was_replaced_often_enough_is_deleted_when_it_is_wrong_again() -> None:
    person = teacher(delete_after=2)
    wrong = [
        *(doing(action, FAR) for action in "bcd" for _ in range(PATIENCE_TICKS)),  # b was replaced by c, c by d
        *(doing("a", FAR) for _ in range(2 * PATIENCE_TICKS)),  # the right one
    ]
    assert [type(command) for command in said(person, wrong).values()] == [Correct, Correct, DeleteRla]
    assert said(teacher(delete_after=2), wrong)[3 * PATIENCE_TICKS] == DeleteRla("s-4", NAME, 1)


def deletions(last: Sequence[TickRecord]) -> int:
    """How often RLA 1, which was replaced twice, is deleted in what comes then."""
    replaced = [doing(action) for action in "bcd"]
    return sum(isinstance(each, DeleteRla) for each in said(teacher(delete_after=2), [*replaced, *last]).values())


def test_it_deletes_only_where_a_correction_would_replace() -> None:
    beside = [record(FAR, Cause.RLA, "d", share_of_radius=0.2)] * PATIENCE_TICKS
    held = [record(FAR, Cause.HELD, "d", nearest=2)] * PATIENCE_TICKS
    assert deletions([record(FAR, Cause.RLA, "d", share_of_radius=0.1)] * PATIENCE_TICKS) == 1
    assert deletions(beside) == 0
    assert deletions(held) == 0


def test_without_such_a_setting_it_corrects_for_ever() -> None:
    wrong = [doing(action, FAR) for action in "bcdbcd" for _ in range(PATIENCE_TICKS)]
    assert {type(command) for command in said(teacher(), wrong).values()} == {Correct}


def test_what_is_wanted_now_is_said_like_everything_else() -> None:
    assert teacher().pursue("turn_left") == Pursue("s-2", NAME, "turn_left")


def wanting(behaviour: str, seen: TickRecord) -> TickRecord:
    return seen._replace(behaviour=behaviour)


def test_it_answers_for_the_behaviour_that_is_wanted() -> None:
    answers = said(teacher(), [wanting("other", asking())] * REACTION_TICKS)
    assert answers == {REACTION_TICKS: Teach("s-2", NAME, "c")}


def test_when_another_behaviour_is_wanted_what_was_asked_and_what_was_wrong_is_over() -> None:
    person = teacher()
    said(person, [asking()] * (REACTION_TICKS - 1))
    assert said(person, [wanting("other", doing("c"))] * REACTION_TICKS) == {}
    said(person, [doing("b")] * (PATIENCE_TICKS - 1))
    assert list(said(person, [wanting("other", doing("b"))] * PATIENCE_TICKS)) == [PATIENCE_TICKS]
