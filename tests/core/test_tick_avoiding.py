"""Times at which a robot avoids obstacles, and forgets them."""

import pytest

from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.teaching.commands import Command, Resume
from kurt2rt.core.teaching.system_events import RobotRepositioned
from tests.core.test_tick import Corridor
from tests.teacher.helpers import set_phase, teach


@pytest.mark.parametrize("phase", Phase)
def test_robot_avoids_obstacles_except_while_it_is_taught(phase: Phase) -> None:
    corridor = Corridor()
    corridor.run(100, set_phase(phase))
    assert corridor.level.avoids is (phase not in {Phase.SUPERVISED, Phase.CORRECTIONS})


def test_robot_without_a_teacher_avoids_obstacles() -> None:
    corridor = Corridor(asked=False)
    corridor.run(100)
    assert corridor.level.avoids


@pytest.mark.parametrize(
    ("message", "times"), [(RobotRepositioned(), 1), (Resume("go", "Ann"), 1), (teach("back", "other"), 0)]
)
def test_robot_forgets_obstacles_when_it_was_moved(
    message: Command | RobotRepositioned, times: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    corridor = Corridor()
    corridor.run(100, teach("forward", "first"))
    forgot: list[int] = []
    monkeypatch.setattr(corridor.level, "forget_obstacles", lambda: forgot.append(corridor.ticks))
    corridor.inbox.put(message)
    corridor.run(100)
    assert forgot == [corridor.ticks] * times
