"""The tick as a story, continued: a robot that touches something, and is to drive on toward it, asks."""

from pathlib import Path

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import ASKS_AFTER_TICKS, Standing
from kurt2rt.core.teaching.commands import Resume, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from simbridge.contracts.simulation import Pose
from tests.core.test_tick import BACK, Corridor
from tests.core.test_tick_by_hand import watch
from tests.runs.replay.stories import NAME, Scene, record_story
from tests.teacher.helpers import teach


def test_bumper_blocked_robot_asks_after_half_a_second(driving: Corridor) -> None:
    driving.robot.touches_in_front = True
    for _ in range(ASKS_AFTER_TICKS - 1):
        before = driving.run()
    assert (before.decision.cause, before.standing) == (DecisionCause.RLA, Standing(StandReason.FRONT_BUMPER))
    record = driving.run()
    decision = record.decision
    assert (decision.cause, decision.asking, decision.driving) == (DecisionCause.TOUCHES, True, False)
    assert (decision.wheel_speeds, record.guard_result.wheel_speeds) == (STANDSTILL, STANDSTILL)
    assert record.standing == Standing(StandReason.FRONT_BUMPER, asks=True)
    assert decision.match is not None
    assert decision.match.rla.rla_id == 1  # who goes on toward it
    assert all(driving.run().decision.cause is DecisionCause.TOUCHES for _ in range(100))


def test_a_robot_that_is_held_and_loses_its_teacher_waits_for_go() -> None:
    corridor = Corridor(attended=True)
    corridor.run(100, teach("forward", "first"), watch(corridor))
    corridor.robot.touches_in_front = True
    for _ in range(ASKS_AFTER_TICKS):
        record = corridor.run(None, watch(corridor))
    assert record.decision.cause is DecisionCause.TOUCHES
    for _ in range(24):
        record = corridor.run()
    corridor.robot.touches_in_front = False
    record = corridor.run(None, watch(corridor))
    assert (record.decision.cause, record.standing.needs_resume) == (DecisionCause.STOPPED, True)


def drives_into_a_wall(scene: Scene, record: TickRecord) -> None:
    """Taught to drive forward whatever it sees; half a second after it asks what to do at the wall, to drive back."""
    inbox, tick = scene.runtime.inbox, record.tick
    if tick == 1:
        scene.simulation.put(Pose(2.5, 2.0, 0.0))
        inbox.put(Resume("go", NAME))
    inbox.put(Watch(NAME, tick))
    if record.decision.cause is DecisionCause.UNKNOWN and tick % 20 == 0:
        inbox.put(Teach(f"t{tick}", NAME, "forward"))
    scene.presses += record.decision.cause is DecisionCause.TOUCHES
    if scene.presses == 50 and record.decision.cause is DecisionCause.TOUCHES:
        inbox.put(Teach("back", NAME, "back"))


def test_a_run_into_a_wall_is_decided_again_as_it_was(tmp_path: Path) -> None:
    run = read_run(record_story("walls", tmp_path, seconds=5, other=drives_into_a_wall))
    asked, after = 0, WheelSpeeds(0.0, 0.0)
    for entry, record in Replay(run):
        assert list(compare(entry, record)) == []
        if entry.decision.cause is DecisionCause.TOUCHES:
            asked += 1
        elif asked:
            after = min(after, entry.grant.wheel_speeds)
    assert asked >= 50
    assert after == BACK
