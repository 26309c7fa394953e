"""Numbers of a rival's lesson, and questions at random."""

import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Label, Why
from kurt2rt.core.rla.events import ActionReplaced, RlaCreated, TeachingEvent
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.rivals.following import followed_by_rlas
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.learners.vote_without_gate import VoteWithoutGate
from kurt2rt.experiments.rivals.lesson import ticks_to_change
from kurt2rt.experiments.rivals.random_questions import RandomlyAskingTeam
from tests.core.learner.helpers import SETTING, Parrot
from tests.experiments.helpers import ROBOT, short_task


class Stubborn(Parrot):
    """Parrot that repeats its first lesson for ever."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - a parrot
        return self.said[0] if self.said else None


def test_clock_counts_lessons_that_act_at_once() -> None:
    clock = LearnerClock()
    learner = clock.timed(Stubborn)(SETTING)
    for action in "ab":
        learner.lesson(np.zeros(1), action, Why.ANSWER)
    learner.lesson(np.zeros(1), "c", Why.DROVE)
    assert learner.decide(np.zeros(1), taught=True) == "a"
    assert (clock.lessons, clock.followed) == (2, 1)


@pytest.mark.parametrize(("corrections", "ticks"), [((1,), (2,)), ((1, 3, 4), (2, 1)), ((2, 5), (1,)), ((), ())])
def test_ticks_to_change_count_to_another_action(corrections: tuple[int, ...], ticks: tuple[int, ...]) -> None:
    assert ticks_to_change(corrections, [None, "a", "a", "b", None, "b"]) == ticks


def test_rlas_follow_the_newest_lesson_alone() -> None:
    origins = [Origin(f"t-{number}", "Ann", Phase.SUPERVISED, number) for number in range(3)]
    rlas = [Rla(number + 1, (0.0,), action, None, origins[number]) for number, action in enumerate("ab")]
    assert followed_by_rlas(RlaSystem(1, 10.0), []) is None
    twins = [RlaCreated(rlas[0]), RlaCreated(rlas[1])]
    assert followed_by_rlas(RlaSystem(1, 10.0), twins) == 0.5  # of two on one condition the older one answers
    replaced: list[TeachingEvent] = [twins[0], ActionReplaced(1, "c", "a", origins[2])]
    assert followed_by_rlas(RlaSystem(1, 10.0), replaced) == 1.0


def test_team_asks_at_random_until_a_lesson() -> None:
    task = taught_by(short_task(4.0, 1.0), load_teacher("ordinary"))
    team, twin = (RandomlyAskingTeam("it", VoteWithoutGate, task, ROBOT, seed=1, every_s=0.5) for _ in range(2))
    here = np.zeros(72)
    lessons = [Label(here, "", "forward", Why.ANSWER, f"t-{number}") for number in range(20)]
    team.teach(lessons[0])
    twin.teach(lessons[0])
    assert {team.decide("", here, taught=False) for _ in range(500)} == {"forward"}
    driven = []
    for lesson in lessons[1:]:
        ticks = iter(range(10_000))
        driven.append(next(tick for tick in ticks if team.decide("", here, taught=True) is None))
        assert team.decide("", here, taught=True) is None
        team.teach(lesson)
    assert len(set(driven)) > 10
    assert 20 < sum(driven) / len(driven) < 100
    asked = [twin.decide("", here, taught=True) is None for _ in range(driven[0] + 800)]
    assert asked == [False] * driven[0] + [True] * 800
