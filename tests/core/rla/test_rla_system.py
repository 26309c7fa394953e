"""RLA system: matching, lessons, fingerprint."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import EventFault, InvalidEventError, TeachingEvent
from kurt2rt.core.rla.matching import exact_distances
from kurt2rt.core.rla.rla import CRITIC, MID, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import (
    created,
    deleted,
    named,
    origin,
    refused_by,
    replaced,
    rewarded,
    session,
    system_of,
    undone,
)


def everything(system: RlaSystem) -> tuple[object, ...]:
    """All that can be told of a system, to see that it did not change."""
    return (
        system.rlas,
        system.next_id,
        system.knowledge_hash(),
        system.match(np.zeros(2)),
        system.history.records,
        system.history.standing,
        system.history.last_standing,
        system.appraisal(1),
        system.appraisal(2),
        system.teaching_ticks,
    )


def actions(system: RlaSystem) -> dict[int, str]:
    return {rla.rla_id: rla.action for rla in system.rlas}


def test_match_returns_nearest_and_runner_up() -> None:
    system = system_of(created(1, (0.0, 0.0), "back"), created(2, (10.0, 0.0)), created(3, (0.0, 30.0)))
    match = system.match(np.array([7.0, 4.0]))
    assert match is not None
    assert match.rla.rla_id == 2
    assert match.distance == 5.0
    assert match.radius == 5.0
    assert match.known  # the border belongs to the RLA
    assert match.runner_up is not None
    assert match.runner_up.rla_id == 1
    assert match.runner_up_distance == pytest.approx(math.sqrt(65), rel=1e-6)


@given(st.integers(0, 2**32))
def test_match_known_up_to_the_exact_radius(seed: int) -> None:
    chance = np.random.default_rng(seed)
    rows = chance.integers(60, 560, (20, 72)) / chance.choice((1, 1000))
    situation = rows[3] + chance.uniform(-9, 9, 72)
    distance = float(exact_distances(rows, situation).min())
    for radius, known in (
        (distance, True),
        (math.nextafter(distance, 0), False),
        (math.nextafter(distance, 1e9), True),
    ):
        system = RlaSystem(72, radius)
        system.apply_all(created(number, tuple(row)) for number, row in enumerate(rows.tolist(), start=1))
        match = system.match(situation)
        assert match is not None
        assert (match.distance, match.known) == (distance, known)


@pytest.mark.parametrize(
    ("event", "fault"),
    [
        (created(2, (5.0, 5.0), command_id="again"), EventFault.RLA_EXISTS),
        (created(0, (5.0, 5.0)), EventFault.RLA_EXISTS),
        (created(3, (5.0,)), EventFault.BAD_CONDITION),
        (created(3, (5.0, 5.0, 5.0)), EventFault.BAD_CONDITION),
        (created(3, (5.0, math.nan)), EventFault.BAD_CONDITION),
        (replaced(1, "back", "forward"), EventFault.NO_RLA),
        (replaced(7, "back", "forward"), EventFault.NO_RLA),
        (deleted(1, "again"), EventFault.NO_RLA),
        (deleted(7), EventFault.NO_RLA),
        (rewarded(1), EventFault.NO_RLA),
        (rewarded(2, 0, "again"), EventFault.BAD_REWARD),
        (created(3, (5.0, 5.0), command_id="lesson-2"), EventFault.LESSON_EXISTS),
        (undone("lesson-9"), EventFault.NOT_UNDOABLE),
        (undone("lesson-1"), EventFault.NOT_UNDOABLE),
        (undone("reward-2"), EventFault.NOT_UNDOABLE),
    ],
)
def test_apply_unfit_event_is_refused_and_changes_nothing(event: TeachingEvent, fault: EventFault) -> None:
    system = system_of(
        created(1, (0.0, 0.0)), created(2, (9.0, 0.0)), deleted(1), rewarded(2), undone("reward-2"), *session(7)
    )
    before = everything(system)
    assert refused_by(system, event).fault is fault
    assert everything(system) == before


_ACTS = st.lists(
    st.tuples(st.sampled_from("cccrd"), st.integers(0, 9), st.sampled_from(("forward", "back"))), max_size=40
)


@given(_ACTS, st.integers(0, 9))
def test_apply_random_lessons_equals_a_dictionary(acts: list[tuple[str, int, str]], at: int) -> None:
    system, living, taught = system_of(radius=100.0), dict[int, tuple[float, str]](), 0
    for count, (act, number, action) in enumerate(acts):
        rla_id = number % (taught + 1) + 1
        if act == "c":
            taught += 1
            system.apply(created(taught, (float(number), 0.0), action))
            living[taught] = (float(number), action)
        elif act == "r" and rla_id in living:
            system.apply(replaced(rla_id, action, living[rla_id][1], f"act-{count}"))
            living[rla_id] = (living[rla_id][0], action)
        elif act == "d" and rla_id in living:
            system.apply(deleted(rla_id))
            del living[rla_id]
    assert actions(system) == {rla_id: action for rla_id, (_, action) in living.items()}
    assert [rla.rla_id for rla in system.rlas] == sorted(living)
    assert system.next_id == taught + 1
    match = system.match(np.array([float(at), 0.0]))
    nearest = min(living, key=lambda rla_id: (abs(living[rla_id][0] - at), rla_id), default=None)
    assert (None if match is None else match.rla.rla_id) == nearest


def test_knowledge_hash_differs_for_each_difference() -> None:
    first = created(1, (1.0, 2.0), "forward")
    base = system_of(first)
    others = [
        system_of(),
        system_of(created(2, (1.0, 2.0), "forward")),
        system_of(created(1, (1.0, math.nextafter(2.0, 3.0)), "forward")),
        system_of(created(1, (1.0, 2.0), "back")),
        system_of(created(1, (1.0, 2.0), "forward", radius=5.0)),
        system_of(created(1, (1.0, 2.0), "forward", behaviour="turn_left")),
        system_of(created(1, (1.0, 2.0), "forward", behaviour="turn_right")),
        system_of(first, created(2, (3.0, 4.0))),
    ]
    assert len({system.knowledge_hash() for system in (base, *others)}) == len(others) + 1


def test_knowledge_hash_ignores_teachers_and_history() -> None:
    direct = system_of(created(2, (1.0, 2.0), "back"))
    by_bob = replace(origin("bobs"), teacher="Bob", phase=Phase.CORRECTIONS, tick=99)
    detour = system_of(created(1, (5.0, 5.0)), created(2, (1.0, 2.0)), deleted(1))
    detour.apply(replace(replaced(2, "back", "forward"), origin=by_bob))
    assert detour.knowledge_hash() == direct.knowledge_hash()


def test_knowledge_hash_unnamed_behaviour_is_unchanged() -> None:
    system = system_of(created(1, (1.0, 2.0), "forward"), created(2, (3.0, 4.0), "back", radius=5.0))
    assert system.knowledge_hash() == "b9a93b6acbee93fddd099ccc5652afdfc5d62e6f1f64db3d67a8c0b3e27715b9"


_BEHAVIOURS = ("straight_on", "turn_left", "turn_right")
_STEPS = st.lists(st.tuples(st.sampled_from("ccccrdu"), st.integers(0, 40), st.sampled_from(_BEHAVIOURS)), max_size=40)


@given(_STEPS)
def test_behaviours_in_one_system_equal_separate_systems(steps: list[tuple[str, int, str]]) -> None:
    together, alone = system_of(), {name: system_of() for name in _BEHAVIOURS}
    for count, (act, number, behaviour) in enumerate(steps):
        name, living, lessons = f"step-{count}", together.rlas, together.history.records
        event: TeachingEvent
        if act == "c":
            point = (number % 5 / 3, number % 2 * 1e-9)  # few places, so that many are equally near
            event = created(together.next_id, point, "forward", command_id=name, behaviour=behaviour)
        elif act == "u" and lessons:
            event = undone(lessons[-1 - number % len(lessons)].event.origin.command_id)
            behaviour = lessons[-1 - number % len(lessons)].behaviour
        elif living and act in "rd":
            rla, behaviour = living[number % len(living)], living[number % len(living)].behaviour
            event = replaced(rla.rla_id, "back", rla.action, name) if act == "r" else deleted(rla.rla_id, name)
        else:
            continue
        try:
            together.apply(event)
        except InvalidEventError:  # an undo that may not be: nor may it there
            with pytest.raises(InvalidEventError):
                alone[behaviour].apply(event)
        else:
            alone[behaviour].apply(event)

    for behaviour, system in alone.items():
        assert tuple(rla for rla in together.rlas if rla.behaviour == behaviour) == system.rlas
        for situation in ([0.0, 0.0], [1 / 3, 0.0], [0.4, 1e-9], [-7.0, 1e5]):
            here = np.array(situation)
            assert together.match(here, behaviour) == system.match(here, behaviour)  # bit for bit
    assert together.history.standing == sum(system.history.standing for system in alone.values())
    assert [rla.rla_id for rla in together.rlas] == sorted(rla.rla_id for rla in together.rlas)


@pytest.mark.parametrize("most", [1, 2, 3, 5, 8, 20])
def test_nearest_first_limit_is_a_prefix(most: int) -> None:
    places = (3.0, -3.0, 0.0, 7.0, 3.0, 1.0, -1.0, 3.0)
    system = system_of(*(created(place, (at, 0.0)) for place, at in enumerate(places, start=1)))
    assert system.candidate_count() == len(places)
    whole = system.nearest_first(np.array([0.0, 0.0]))
    assert [rla.rla_id for rla, _ in whole] == [3, 6, 7, 1, 2, 5, 8, 4]
    assert system.nearest_first(np.array([0.0, 0.0]), limit=most) == whole[:most]
    lost = system.nearest_first(np.array([math.nan, 0.0]), limit=most)
    assert lost == tuple((rla, math.inf) for rla in system.rlas)[:most]


def around(system: RlaSystem, rla_id: int, count: int) -> list[int]:
    rla = system.get(rla_id)
    assert rla is not None
    return [each.rla_id for each in system.neighbours(rla, count)]


def test_neighbours_have_other_conditions_nearest_first() -> None:
    system = RlaSystem(2, 5.0, others={CRITIC: Space(2, 1.0)})
    for event in (
        *(created(1, (0.0, 0.0)), created(2, (0.0, 0.0), "back"), created(3, (3.0, 0.0)), created(4, (-1.0, 0.0))),
        *(created(5, (3.0, 0.0), "left"), created(6, (0.0, 9.0)), created(7, (0.1, 0.0), behaviour="turn_left")),
        created(8, (0.1, 0.0), "bad", level=CRITIC),
    ):
        system.apply(event)
    assert around(system, 1, 9) == around(system, 2, 9) == [4, 3, 5, 6]  # of equally near ones the older first
    assert around(system, 1, 2) == [4, 3]
    assert around(system, 7, 9) == around(system, 8, 9) == around(system, 1, 0) == []


def test_named_situation_unfit_for_level_is_refused() -> None:
    knows = RlaSystem(2, 5.0, others={MID: Space(3, 0.5)})
    assert refused_by(knows, named("door", (1.0, 2.0), MID)).fault is EventFault.BAD_SITUATION
    assert refused_by(knows, named("door", (1.0, math.nan, 0.0), MID)).fault is EventFault.NOT_FINITE
    assert knows.history.records == ()
