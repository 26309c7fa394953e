"""Times at which a robot forgets obstacles."""

import pytest

from kurt2rt.core.teaching.commands import Command, Resume
from kurt2rt.core.teaching.inbox import RobotRepositioned
from tests.core.test_tick import Corridor
from tests.teacher.helpers import teach


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
