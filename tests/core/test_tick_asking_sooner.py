"""Robot that asks sooner while it is taught, and beyond R otherwise."""

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from tests.core.test_tick import RADIUS, Corridor
from tests.teacher.helpers import correct, set_phase, teach

SHARE = 0.5
TAUGHT_AT = 100
BETWEEN = 118
"""Counts at which the distance to the lesson lies between the share of R and R."""


def taught(*, asked: bool = True) -> Corridor:
    """Return a robot that learned forward at 100 counts, and asks beyond half of R while it is taught."""
    corridor = Corridor(asked=asked, ask_radius_fraction=SHARE)
    corridor.run(TAUGHT_AT, teach("forward", "first"))
    corridor.run(TAUGHT_AT)
    return corridor


def cause_between(corridor: Corridor) -> DecisionCause:
    """Return why the robot drives or stands between the share of R and R."""
    record = corridor.run(BETWEEN)
    match = record.decision.match
    assert match is not None
    assert SHARE * RADIUS < match.distance <= RADIUS
    return record.decision.cause


@pytest.mark.parametrize("phase", [Phase.SUPERVISED, Phase.CORRECTIONS])
def test_taught_robot_asks_beyond_the_share(phase: Phase) -> None:
    corridor = taught()
    corridor.run(TAUGHT_AT, set_phase(phase))
    assert cause_between(corridor) is DecisionCause.UNKNOWN


@pytest.mark.parametrize("phase", [Phase.REINFORCEMENT, Phase.CRITIC, Phase.AUTONOMOUS])
def test_robot_of_a_later_phase_asks_beyond_its_radius(phase: Phase) -> None:
    corridor = taught()
    corridor.run(TAUGHT_AT, set_phase(phase))
    assert cause_between(corridor) is DecisionCause.RLA


def test_robot_without_a_teacher_asks_beyond_its_radius() -> None:
    assert cause_between(taught(asked=False)) is DecisionCause.RLA


def test_correction_within_its_share_of_whole_radius_replaces() -> None:
    """A correction at 0.3 R replaces the RLA, as half of R says, and not half of the half that counts now."""
    corridor = taught()
    corridor.run(TAUGHT_AT, set_phase(Phase.CORRECTIONS))
    corridor.run(TAUGHT_AT + 8, correct("back"))
    assert [rla.action for rla in corridor.system.rlas] == ["back"]
