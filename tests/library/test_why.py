"""A simulated robot explains any earlier step as it explained it then."""

from collections.abc import Iterator

import can
import pytest

import kurt2rt

_CONTROL = 0x01


@pytest.fixture(scope="module")
def told() -> Iterator[tuple[kurt2rt.SimulatedRobot, list[str]]]:
    """Return a robot with two lessons, and its explanation of each step, taken right after the step."""
    with kurt2rt.SimulatedRobot(world="a", seed=1) as robot:
        told = [robot.why()]
        for step in range(2, 61):
            if step in (4, 40):
                robot.teach("forward" if step == 4 else "back")
            else:
                robot.step()
            told.append(robot.why())
        yield robot, told


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"at": 0.61}, r"at: no time of this robot \(got 0\.61, allowed 0 to 0\.6 s\)"),
        ({"at": float("nan")}, "at: no time"),
        ({"tick": 0}, r"tick: no step of this robot \(got 0, allowed 1 to 60\)"),
        ({"tick": 1.5}, "tick: no step"),
        ({"at": 0.1, "tick": 10}, "allowed one of them"),
    ],
)
def test_why_of_a_step_that_was_not_is_refused(
    wrong: dict[str, float], message: str, told: tuple[kurt2rt.SimulatedRobot, list[str]]
) -> None:
    with pytest.raises(kurt2rt.Error, match=message):
        told[0].why(**wrong)  # type: ignore[arg-type]  # a wrong one on purpose


def test_why_of_a_drive_that_others_changed_is_refused() -> None:
    with (
        can.Bus("changed", interface="virtual") as bus,
        kurt2rt.SimulatedRobot(world="a", seed=1, bus="virtual:changed") as robot,
    ):
        robot.step(5)
        bus.send(can.Message(arbitration_id=_CONTROL, data=bytes(8), is_extended_id=False))  # so the guard stops
        robot.step(4)
        assert robot.why(tick=5)
        with pytest.raises(kurt2rt.Error, match=r"step 10: .* another program sent on its bus"):
            robot.why(tick=10)
