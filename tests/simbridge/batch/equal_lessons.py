"""`make equal-lessons`: whole lessons are given in the batch and on the CAN bus, and must be equal bit by bit.

A task, a teacher and a seed make a lesson. Of the tasks that are taught in rooms or streets, every second robot is
taught in generated ones of its own. Lessons of several shards are others, so a shard may run on another machine.
"""

import argparse
import sys
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, fields
from multiprocessing import get_context

import anyio

from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_lesson import BatchTrainingRun, open_batch_lesson
from kurt2rt.experiments.lockstep.lesson import GivenLesson, TrainingResult, teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from tests.simbridge.batch.both_ways import FACTORY, ROBOT

IN_ROOMS = ("wall_following", "fleeing")
IN_STREETS = ("streets", "straight_on", "turn_left", "turn_right")
TASKS = (*IN_ROOMS, "circle", "circle_repositioned", "eight", *IN_STREETS)
TEACHERS = ("ordinary", "superhuman", "slow", "attentive")
FIRST_SEED = 5010


@dataclass(frozen=True, order=True)
class WholeLesson:
    """One lesson of the sweep."""

    seed: int
    task: str
    teacher: str

    @property
    def world(self) -> str | None:
        """Name of the generated world; None: the task's own."""
        if self.seed % 2 == 0:
            return None
        kind = "rooms" if self.task in IN_ROOMS else "streets" if self.task in IN_STREETS else None
        return None if kind is None else f"{kind}-{self.seed}"

    def settings(self) -> TaskSettings:
        """Return the task, taught by the teacher in the world."""
        changes = {} if self.world is None else {"teaching.world": self.world}
        return taught_by(load_task(self.task, changes=changes), load_teacher(self.teacher))

    def __str__(self) -> str:
        return f"{self.task} in {self.world or 'its own world'} by {self.teacher}, seed {self.seed}"


def main() -> None:
    """Give the lessons of a shard both ways; exit with 1 if one differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lessons", type=int, default=1000, help="of all shards together")
    parser.add_argument("--shard", default="1/1", metavar="K/N", help="which part this is, such as 1/8")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    arguments = parser.parse_args()
    part, parts = (int(number) for number in arguments.shard.split("/"))
    if not 1 <= part <= parts:
        parser.error(f"there is no shard {arguments.shard}")
    ends = [arguments.lessons * each // parts for each in (part - 1, part)]
    chosen = list(whole_lessons(arguments.lessons))[slice(*ends)]
    outcomes: Counter[str] = Counter()
    began_s = time.monotonic()
    with ProcessPoolExecutor(arguments.jobs, get_context("spawn")) as processes:
        for done in as_completed([processes.submit(outcome_of, each) for each in chosen]):
            outcomes[done.result()] += 1
            if outcomes.total() % 20 == 0 or outcomes.total() == len(chosen):
                counts = ", ".join(f"{count} {outcome}" for outcome, count in sorted(outcomes.items()))
                seconds = time.monotonic() - began_s
                print(f"{outcomes.total()} of {len(chosen)} lessons after {seconds:.0f} s: {counts}", flush=True)
    sys.exit(1 if outcomes["different"] else 0)


def whole_lessons(count: int) -> Iterator[WholeLesson]:
    """Yield so many lessons; each seed goes through all tasks and teachers."""
    kinds = [(task, teacher) for task in TASKS for teacher in TEACHERS]
    for place in range(count):
        task, teacher = kinds[place % len(kinds)]
        yield WholeLesson(FIRST_SEED + place // len(kinds), task, teacher)


def outcome_of(lesson: WholeLesson) -> str:
    """Return `equal`, `different`, or `on the bus` of a lesson whose robot left the batch."""
    try:
        return "on the bus" if lesson_in_both(lesson.settings(), lesson.seed) is None else "equal"
    except Exception:  # noqa: BLE001 - the other lessons go on, and this one is counted
        print(f"{lesson}:\n{traceback.format_exc()}", flush=True)
        return "different"


def lesson_in_both(task: TaskSettings, seed: int) -> GivenLesson | None:
    """Give a lesson in the batch and on the CAN bus, check that they are equal, and return it.

    Returns None if the robot leaves the batch, and so belongs on the CAN bus.
    """
    with batch_lesson(task, seed) as run:
        if not run.drive_stretches():
            assert run.robot.trouble
            return None
        in_batch, state_hash = run.given(), run.robot.lesson_hash()
    on_bus, state_hash_on_bus = lesson_on_bus(task, seed)
    require_equal_lessons(in_batch, on_bus)
    assert state_hash == state_hash_on_bus
    return in_batch


def require_equal_lessons(batch: GivenLesson, bus: GivenLesson) -> None:
    """Check that a lesson in the batch had the course and the knowledge of the CAN bus."""
    # The counter of uses has no equality of its own; the saved statistics hold its counts.
    compared = [each.name for each in fields(TrainingResult) if each.compare and each.name != "statistics"]
    assert [name for name in (*compared, "saved") if getattr(batch.result, name) != getattr(bus.result, name)] == []
    assert list(batch.events) == list(bus.events)


def batch_lesson(task: TaskSettings, seed: int) -> AbstractContextManager[BatchTrainingRun]:
    """Return a lesson in the batch that has not begun."""
    return open_batch_lesson(FACTORY, ROBOT, task, seed=seed, on_progress=lambda _: None)


def lesson_on_bus(task: TaskSettings, seed: int) -> tuple[GivenLesson, str]:
    """Give a lesson on the CAN bus; return it and the hash of the simulated robot's state at its end."""
    store = InMemoryEventStore()

    async def lesson() -> GivenLesson:
        result = await teach(simulation, ROBOT, task, TrainingStore(store), seed=seed, on_progress=lambda _: None)
        return GivenLesson(result, store.events)

    with closing(FACTORY.open(task.teaching.world, seed, "lesson")) as simulation:
        return anyio.run(lesson), simulation.simulated_robot.state_hash()


if __name__ == "__main__":
    main()
