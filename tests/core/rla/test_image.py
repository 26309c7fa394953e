"""An RLA of a mirrored system answers in two places, and is one RLA."""

import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.expectations.expectations import Expectations
from kurt2rt.core.expectations.tracker import BasicTransitionTracker
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.condition import Condition, Space
from kurt2rt.core.rla.events import LessonUndone, RlaCreated, TeachingEvent
from kurt2rt.core.rla.image import Image
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from tests.core.helpers import MINIMUM_TICKS, Counted, sensed
from tests.core.rla.helpers import created, deleted, origin, replaced, withdrawn
from tests.teacher.helpers import correct

LEFT, RIGHT = (9.0, 0.0), (0.0, 9.0)


def _exchanged(situation: NDArray[np.float64]) -> NDArray[np.float64]:
    return situation[::-1]


MIRROR = Image("mirrored", _exchanged, _exchanged, False, {"left": "right", "right": "left", "turn_left": "turn_right"})
TWICE = Image("x2", lambda situation: situation * 2, lambda situation: situation / 2, True, {})


def system_of(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0, images=(MIRROR,))
    system.apply_all(events)
    return system


def level_of(system: RlaSystem) -> BasicLevel:
    actions = {name: Counted() for name in ("left", "right", "forward")}
    return BasicLevel(system, actions, MINIMUM_TICKS, ActiveBehaviour(("",)))


def school_of(system: RlaSystem) -> CommandHandler:
    level = level_of(system)
    authority = ControlAuthority(level.repertoire, attended=False)
    return CommandHandler(level, authority, insert_radius_fraction=0.5, handled_command_ids=())


def matched(system: RlaSystem, at: Condition, behaviour: str = "") -> Match:
    match = system.match(np.array(at), behaviour)
    assert match is not None
    return match


def test_it_answers_on_both_sides_with_one_id_and_counts_once() -> None:
    system = system_of(created(1, LEFT, "left"))
    near, image = matched(system, (9.0, 1.0)), matched(system, (1.0, 9.0))
    assert (near.rla.rla_id, near.rla.action, near.rla.image, near.distance) == (1, "left", "", 1.0)
    assert (image.rla.rla_id, image.rla.action, image.rla.image, image.distance) == (1, "right", "mirrored", 1.0)
    assert tuple(image.rla.condition) == RIGHT
    assert image.rla.title == "RLA 1 mirrored"
    assert near.runner_up == image.rla
    assert len(system) == system.candidate_count() == 1
    assert [rla.image for rla in system.candidates()] == ["", "mirrored"]
    assert system.knowledge_hash() == _without_mirror(created(1, LEFT, "left")).knowledge_hash()


def _without_mirror(*events: TeachingEvent) -> RlaSystem:
    system = RlaSystem(2, 5.0)
    system.apply_all(events)
    return system


def test_a_correction_an_undo_and_a_deletion_act_on_both_sides() -> None:
    system = system_of(created(1, LEFT, "left"), replaced(1, "forward", "left"))
    assert [matched(system, each).rla.action for each in (LEFT, RIGHT)] == ["forward", "forward"]
    system.apply(LessonUndone("correction-1", origin("undo-1")))
    assert [matched(system, each).rla.action for each in (LEFT, RIGHT)] == ["left", "right"]
    system.apply(withdrawn(1, "left"))
    assert [matched(system, each).known for each in (LEFT, RIGHT)] == [False, False]
    system.apply(deleted(1))
    assert system.match(np.array(LEFT)) is system.match(np.array(RIGHT)) is None


def test_older_one_wins_and_each_before_its_image() -> None:
    system = system_of(created(1, LEFT, "left"), created(2, RIGHT, "forward"))
    assert matched(system, RIGHT).rla.rla_id == 1
    assert matched(system, (3.0, 3.0)).rla.image == ""


def test_its_image_belongs_to_the_mirrored_behaviour() -> None:
    system = system_of(created(1, LEFT, "left", behaviour="turn_left"))
    assert matched(system, RIGHT, "turn_right").rla.action == "right"
    assert matched(system, RIGHT, "turn_left").distance > 9.0


def test_other_levels_have_no_images() -> None:
    system = RlaSystem(2, 5.0, images=(MIRROR,))
    system.apply(created(1, LEFT, "left", level=MID))
    assert system.candidates() == ()


@pytest.mark.parametrize(("here", "stays"), [((18.0, 1.0), "forward"), ((18.0, 0.0), "left")])
def test_correction_at_another_width_leaves_the_lesson_of_home(here: Condition, stays: str) -> None:
    system = RlaSystem(2, 5.0, images=(TWICE,))
    system.apply(created(1, LEFT, "forward"))
    situation = Situation(np.array(here), history_frozen=False)
    _, (event,) = school_of(system).handle(correct("left"), situation, 9)
    assert matched(system, LEFT).rla.action == stays  # at its very condition no second one would ever win
    assert matched(system, here).rla.action == "left"
    assert isinstance(event, RlaCreated) is (stays == "forward")


@pytest.mark.parametrize(("at", "opposite"), [(LEFT, "left"), (RIGHT, "right")])
def test_corrected_image_does_on_its_side_what_was_pressed(at: Condition, opposite: str) -> None:
    system = system_of(created(1, LEFT, "forward"))
    here = Situation(np.array(at), history_frozen=False)
    assert level_of(system).decide(here, sensed(), None).image == ("mirrored" if at == RIGHT else "")
    pressed = {"left": "right", "right": "left"}[opposite]
    result, (event,) = school_of(system).handle(correct(pressed), here, 9)
    assert matched(system, at).rla.action == pressed
    assert matched(system, tuple(reversed(at))).rla.action == opposite
    assert ("RLA 1 mirrored" in text_of(result.outcome)) is (at == RIGHT)
    system.apply(LessonUndone(event.origin.command_id, origin("undo-1")))
    assert matched(system, at).rla.action == "forward"


def test_end_of_an_image_is_learned_as_its_mirror_image() -> None:
    system = system_of(created(1, LEFT, "left"), created(2, (5.0, 5.0)))
    expectations = Expectations(BASIC, system, Space(2, 5.0), {})
    tracker = BasicTransitionTracker(expectations)
    tracker.update(1, 1, np.array(RIGHT), "", "mirrored")
    tracker.update(9, 2, np.array([3.0, 7.0]), "")
    learned = expectations.get(1)
    assert learned is not None
    assert learned.mean.tolist() == [7.0, 3.0]


def test_competitors_of_an_image_are_images() -> None:
    system = system_of(created(1, LEFT, "left"), created(2, LEFT, "right"))
    group = system.competitors(matched(system, RIGHT).rla)
    assert [(each.rla_id, each.action, tuple(each.condition)) for each in group] == [
        (1, "right", RIGHT),
        (2, "left", RIGHT),
    ]


def test_image_of_an_image_has_both_names_and_changes() -> None:
    both = MIRROR.then(TWICE)
    system = RlaSystem(2, 5.0, images=(MIRROR, TWICE, both))
    system.apply(created(1, LEFT, "left"))
    found = matched(system, (0.0, 18.0)).rla
    assert (found.title, found.action, tuple(found.condition)) == ("RLA 1 mirrored x2", "right", (0.0, 18.0))
    assert matched(system, (18.0, 0.0)).rla.title == "RLA 1 x2"
    assert both.as_taught(np.array((0.0, 18.0))).tolist() == list(LEFT)
