"""Levels: RLAs of the critic and of the basic level in one history of lessons; and actions that were withdrawn."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import EventFault, TeachingEvent
from kurt2rt.core.rla.rla import ASK, CRITIC
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, deleted, refused_by, replaced, undone, withdrawn
from tests.examples import examples

CRITICS = Space(3, 0.5, np.array([1.0, 1.0, 0.0]))


def system_of(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0, others={CRITIC: CRITICS})
    system.apply_all(events)
    return system


def test_critic_rlas_without_critic_are_kept_unmatched() -> None:
    system = RlaSystem(2, 5.0)
    whole = system_of()
    lessons = (created(1, (0.0,) * 3, "bad", level=CRITIC), created(2, (0.0, 0.0)), replaced(1, "good", "bad"))
    for each in (system, whole):
        each.apply_all(lessons)
    (appraisal,) = system.rlas_at(CRITIC)
    assert system.match(np.zeros(3), level=CRITIC) is None
    assert (system.competitors(appraisal), system.neighbours(appraisal, 3)) == ((appraisal,), ())
    assert system.knowledge_hash() == whole.knowledge_hash()
    system.apply_all([deleted(1), undone("deletion-1"), undone("correction-1")])
    assert [rla.action for rla in system.rlas_at(CRITIC)] == ["bad"]


def test_knowledge_hash_differs_by_level_and_withdrawal() -> None:
    taught = [
        system_of(created(1, (1.0, 2.0, 3.0), "bad", level=CRITIC)),
        system_of(created(1, (1.0, 2.0, 3.0), "good", level=CRITIC)),
        system_of(created(1, (1.0, 2.0), "bad")),
        system_of(created(1, (1.0, 2.0), "bad"), withdrawn(1, "bad")),
    ]
    assert len({system.knowledge_hash() for system in taught}) == len(taught)


@pytest.mark.parametrize(
    ("event", "fault"),
    [
        (created(2, (1.0, 0.0), ASK), EventFault.BAD_ACTION),
        (replaced(1, ASK, "forward"), EventFault.BAD_ACTION),
        (withdrawn(7), EventFault.NO_RLA),
        (withdrawn(1, command_id="again"), EventFault.WITHDRAWN_ALREADY),
    ],
)
def test_ask_is_no_teachable_action(event: TeachingEvent, fault: EventFault) -> None:
    system = system_of(created(1, (0.0, 0.0)), withdrawn(1))
    before = system.knowledge_hash(), system.history.records, system.next_id
    assert refused_by(system, event).fault is fault
    assert (system.knowledge_hash(), system.history.records, system.next_id) == before


@examples(60)
@given(st.lists(st.tuples(st.integers(-5, 5), st.booleans()), min_size=1, max_size=12), st.integers(-6, 6))
def test_match_without_withdrawn_equals_their_absence(taught: list[tuple[int, bool]], place: int) -> None:
    every = [created(number, (float(x), 0.0)) for number, (x, _) in enumerate(taught, 1)]
    asking = [number for number, (_, asks) in enumerate(taught, 1) if asks]
    system = system_of(*every, *(withdrawn(number) for number in asking))
    without = system_of(*every, *(deleted(number) for number in asking))
    here = np.array([float(place), 1.0])
    passed_over, expected = system.match(here, include_withdrawn=False), without.match(here)
    assert (passed_over is None) == (expected is None)
    if passed_over is not None and expected is not None:
        assert passed_over.rla == expected.rla
        assert (passed_over.distance, passed_over.radius) == (expected.distance, expected.radius)
        if not system.match(here).rla.is_withdrawn:  # type: ignore[union-attr] # there is one
            return  # who is behind the nearest is told as ever
        assert passed_over.runner_up == expected.runner_up
        assert passed_over.runner_up_distance == expected.runner_up_distance
