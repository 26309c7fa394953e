"""Undo of lessons."""

from collections.abc import Iterator

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.events import InvalidEventError, Lesson, TeachingEvent
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import ASK
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import (
    created,
    deleted,
    refused_by,
    replaced,
    rewarded,
    session,
    system_of,
    undone,
    withdrawn,
)
from tests.examples import examples

FIRST = created(1, (0.0, 0.0))
SECOND = created(2, (0.0, 0.0), "back")


def winner(system: RlaSystem, x: float, y: float) -> tuple[int, str]:
    match = system.match(np.array([x, y]))
    assert match is not None
    return match.rla.rla_id, match.rla.action


def test_undo_withdrawal_restores_the_action() -> None:
    system = system_of(FIRST, withdrawn(1), replaced(1, "back", ASK), undone("correction-1"))
    rla = system.get(1)
    assert rla is not None
    assert (rla.action, rla.origin.command_id) == (ASK, "withdrawal-1")
    system.apply(undone("withdrawal-1"))
    assert system.rlas == (FIRST.rla,)
    assert winner(system, 0.0, 0.0) == (1, "forward")


def test_undo_of_older_lesson_names_the_newest() -> None:
    system = system_of(FIRST, replaced(1, "back", "forward", "phone-7"), SECOND)
    refusal = refused_by(system, undone("lesson-1")).refusal
    says = "RLA 1 corrected: back instead of forward"
    assert refusal == Outcome.of(RefusalCode.TAUGHT_AFTER, later="phone-7", lesson="lesson-1", says=says)
    system.apply(undone("phone-7"))  # though the lesson of another RLA came after it
    assert system.history.why_not_undo("lesson-1") is None
    system.apply(undone("lesson-1"))
    assert system.rlas == (SECOND.rla,)


def test_undo_twice_is_refused() -> None:
    system = system_of(FIRST, undone("lesson-1"))
    twice = refused_by(system, undone("lesson-1")).refusal
    assert twice == Outcome.of(RefusalCode.UNDONE_ALREADY, lesson="lesson-1")
    no_lesson = refused_by(system, undone("undo-lesson-1")).refusal
    assert no_lesson == Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson="undo-lesson-1")


def test_lessons_list_all_with_their_state() -> None:
    system = system_of()
    assert (system.history.records, system.history.standing, system.history.last_standing) == ((), 0, None)
    praise = rewarded(2)
    system.apply_all([FIRST, SECOND, praise, *session(100), undone("lesson-1")])
    assert system.history.records == (LessonRecord(FIRST, undone=True), LessonRecord(SECOND), LessonRecord(praise))
    assert (system.history.standing, system.history.last_standing) == (2, "reward-2")
    assert system.history.get("lesson-1") == LessonRecord(FIRST, undone=True)
    assert system.history.get("begin") is None
    system.apply(undone("reward-2"))
    assert (system.history.standing, system.history.last_standing) == (1, "lesson-2")
    system.apply(undone("lesson-2"))
    assert (system.history.standing, system.history.last_standing) == (0, None)


_STEPS = st.lists(
    st.tuples(st.sampled_from("ccrdwwaauuu"), st.integers(0, 30), st.sampled_from(("forward", "back"))), max_size=50
)


def lessons_and_undos(steps: list[tuple[str, int, str]], system: RlaSystem) -> Iterator[TeachingEvent]:
    """Events that fit the system, and undos of any lesson, which may not."""
    for number, (act, which, action) in enumerate(steps):
        command_id = f"step-{number}"
        living = system.rlas
        if act == "u":
            if system.history.records:
                yield undone(system.history.records[-1 - which % len(system.history.records)].event.origin.command_id)
        elif act == "c":
            # Few places, so that many RLAs are equally near; one so far off that float32 gives up.
            point = (1e20, 0.0) if which == 30 else (which % 3 / 3, which % 2 * 1e-9)
            yield created(system.next_id, point, action, command_id=command_id)
        elif living:
            rla = living[which % len(living)]
            if act == "r":
                yield replaced(rla.rla_id, action, rla.action, command_id)
            elif act == "d":
                yield deleted(rla.rla_id, command_id)
            elif act == "a":
                yield withdrawn(rla.rla_id, rla.action, command_id)
            else:
                yield rewarded(rla.rla_id, 1 if which % 2 else -1, command_id)


@given(_STEPS)
@examples(400)
def test_undo_random_sequences_equal_standing_lessons(steps: list[tuple[str, int, str]]) -> None:
    system, standing, undos = system_of(), dict[str, Lesson](), 0
    for event in lessons_and_undos(steps, system):
        try:
            system.apply(event)
        except InvalidEventError:
            continue
        for record in system.history.records:
            name = record.event.origin.command_id
            if not record.undone:
                standing[name] = record.event
            elif name in standing:
                del standing[name]
                undos += 1
    direct = system_of(*standing.values())

    assert system.rlas == direct.rlas  # who taught it and when included
    assert system.knowledge_hash() == direct.knowledge_hash()
    assert [system.appraisal(rla.rla_id) for rla in system.rlas] == [
        direct.appraisal(rla.rla_id) for rla in direct.rlas
    ]
    assert (system.history.standing, len(system.history.records)) == (len(standing), len(standing) + undos)
    assert system.history.last_standing == (list(standing)[-1] if standing else None)
    for situation in ([0.0, 0.0], [1 / 3, 0.0], [0.4, 1e-9], [3e19, 0.0], [-7.0, 1e5]):
        assert system.match(np.array(situation)) == direct.match(np.array(situation))  # bit for bit
    for rla in system.rlas:
        assert system.competitors(rla) == direct.competitors(rla)
        assert system.competitors(rla) == tuple(each for each in system.rlas if each.condition == rla.condition)
