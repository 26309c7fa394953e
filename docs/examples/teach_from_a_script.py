"""Teach a robot from a script: answer what it asks, correct what it does wrong, then let it drive alone.

    python docs/examples/teach_from_a_script.py

starts a simulated robot, teaches it for 60 s, watches it for 30 s, and ends. With the folder of a pairing it teaches a
robot that runs already, which `kurt2rt run` starts:

    python docs/examples/teach_from_a_script.py var/devices/local

The teacher is the policy of the task wall_following; put your own in `what_is_right`.
"""

import argparse
import sys
from contextlib import ExitStack

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Correct, Resume, Take, Teach
from kurt2rt.teacher import RobotProcess, Teacher
from kurt2rt.teacher.client.answer import NoAnswerError

PATIENCE = 4
"""States in a row, 20 a second, in which the robot does something else before it is corrected."""

_policy = load_task("wall_following").policy.build(load_robot().infrared)


def what_is_right(state: State) -> str:
    """Return the action that is right for what the robot senses now: put your own teacher here.

    `state.infrared_counts` has s1 to s18 of config/robots/kurt2.yaml; high counts are near.
    """
    return _policy.choose(state.infrared_counts, state.behaviour)


def teach(teacher: Teacher, seconds: float) -> int:
    """Answer and correct for some seconds; return the number of lessons."""
    lessons, wrong, ends = 0, 0, None
    for state in teacher.states():
        ends = ends or state.tick + round(100 * seconds)
        if state.tick >= ends:
            return lessons
        right = what_is_right(state)
        wrong = wrong + 1 if state.cause == "rla" and state.action != right else 0
        if state.standing.needs_resume:
            print(f"tick {state.tick}: it stands ({state.standing.reason}); {teacher.send(Resume).text}")
            continue
        if state.standing.asks:
            answer = teacher.send(Teach, action=right, decision_tick=state.tick)
        elif wrong == PATIENCE:
            answer = teacher.send(Correct, action=right, decision_tick=state.tick)
        else:
            continue
        print(f"tick {state.tick}: {answer.text}")
        lessons += answer.accepted
    return lessons


def watch(teacher: Teacher, seconds: float) -> float:
    """Watch the robot for some seconds; return the share of states in which it drove by itself."""
    drove = [state.cause == "rla" for state, _ in zip(teacher.states(), range(round(20 * seconds)), strict=False)]
    return sum(drove) / len(drove)


def main() -> None:
    """Read the command line and run the lesson."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("device", nargs="?", help="folder of a pairing; default: start a simulated robot")
    parser.add_argument("--seconds", type=float, default=60.0, help="of teaching; half of it is watched afterwards")
    given = parser.parse_args()
    with ExitStack() as stack:
        device = given.device or stack.enter_context(RobotProcess()).device
        teacher = stack.enter_context(Teacher(device))
        print(teacher.send(Take).text)
        teacher.send(Resume)
        lessons = teach(teacher, given.seconds)
        share = watch(teacher, given.seconds / 2)
        print(f"{lessons} lessons, {teacher.state.rlas} RLAs; then it drove by itself {share:.0%} of the time")


if __name__ == "__main__":
    try:
        main()
    except (ChannelError, NoAnswerError) as error:
        sys.exit(str(error))
