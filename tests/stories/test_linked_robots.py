"""Stories of the robots without CAN: what they are told is read right, and a guard or a link that lets go is seen."""

from pathlib import Path

import pytest

from hal.linked_robot import LinkedRobot
from kurt2rt.robots.school.lines import encode as line_of
from kurt2rt.robots.turtlebot.settings import require_turtlebot
from kurt2rt.ros.messages import encode
from kurt2rt.ros.twist import PlaneTwist, Twists
from tests.stories.rig import ROBOTS
from tests.stories.story import Event, Story
from tests.stories.table import Kind, RobotKind, Target
from tests.stories.teller import tell
from tests.stories.wire import BRAKE, WheelCommand, decode_line, decode_twist

TARGETS: dict[RobotKind, Target] = {"school": "serial", "turtlebot": "topics"}


def test_it_reads_what_the_school_robot_reads() -> None:
    assert decode_line(line_of("drive", 17, 80, -70)) == WheelCommand(0.08, -0.07, brake=False)
    assert decode_line(line_of("brake", 18)) == BRAKE
    assert decode_line(line_of("school", 0, 1)) is None
    assert decode_line(b"drive 17 80 -80*D5CD\n") is None


def test_it_reads_what_the_base_reads() -> None:
    robot = require_turtlebot(ROBOTS["turtlebot"])
    twists = Twists(robot.twist, robot)
    told = decode_twist(encode(twists.message(PlaneTwist(0.1, -0.5), 12.0)))
    assert told is not None
    assert told == pytest.approx((0.14, 0.06, False))
    assert decode_twist(encode(twists.message(PlaneTwist(0.0, 0.0), 12.0))) == BRAKE
    assert decode_twist(bytes(76)) is None


@pytest.mark.parametrize("kind", ["school", "turtlebot"])
@pytest.mark.parametrize(
    ("limits", "complaint"),
    [({"acceleration_m_s2": 10.0}, "jumps from"), ({"stale_infrared_s": 5.0, "stale_encoder_s": 5.0}, "were silent")],
)
async def test_a_guard_that_lets_go_is_seen(
    kind: RobotKind, limits: dict[str, float], complaint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    guard = ROBOTS[kind].guard.model_copy(update=limits)
    monkeypatch.setitem(ROBOTS, kind, ROBOTS[kind].model_copy(update={"guard": guard}))
    lost = Event(at_s=6.0, target=TARGETS[kind], kind="restart", lasts_s=1.5)
    problems = (await tell(Story(seed=2, lasts_s=10.0, robot=kind, faults=(lost,)), tmp_path)).problems
    assert any(complaint in each for each in problems), problems


@pytest.mark.parametrize(
    ("robot", "target", "kind"),
    [("turtlebot", "topics", "alarm"), ("turtlebot", "topics", "stranger"), ("school", "serial", "stuck")],
)
async def test_a_driver_that_does_not_listen_is_seen(
    robot: RobotKind, target: Target, kind: Kind, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(LinkedRobot, "_sound_alarms", lambda *_, **__: None)
    faults = tuple(Event(at_s=at_s, target=target, kind=kind, lasts_s=2.5) for at_s in (3.0, 7.0, 11.0))
    story = Story(seed=2, lasts_s=20.0, robot=robot, task="fleeing", taught=True, faults=faults)
    assert f"{target} {kind}: it did not stand" in (await tell(story, tmp_path)).problems
