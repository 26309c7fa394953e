"""Fixture of the benchmarks: a robot in its world, a task, and knowledge to drive with."""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from hal.batch import BatchFactory
from hal.kurt2_settings import Kurt2Settings
from hal.simulation import Simulation
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.lesson import teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now

OnProgress = Callable[[float], None]
"""Callback with the finished share of the work, 0 to 1."""

SEED = 1


@dataclass(frozen=True, slots=True)
class BenchFixture:
    """Robot, world and knowledge."""

    settings: Kurt2Settings
    task: TaskSettings
    open_simulation: Callable[[str], Simulation]
    """Start the simulation in the task's teaching world, for a named purpose."""
    events: tuple[TeachingEvent, ...] = ()
    batches: BatchFactory | None = None
    """Opens batches; None where none is measured."""


async def learn(fixture: BenchFixture, duration_s: float, on_progress: OnProgress) -> BenchFixture:
    """Return the fixture taught in lockstep for `duration_s`, two thirds of it with corrections."""
    notebook = InMemoryEventStore()
    task = with_duration(fixture.task, supervised_s=duration_s / 3, corrections_s=duration_s * 2 / 3)
    with closing(fixture.open_simulation("lesson")) as simulation:
        await teach(
            simulation,
            fixture.settings,
            task,
            TrainingStore(notebook),
            seed=SEED,
            on_progress=lambda done_s: on_progress(done_s / duration_s),
        )
    return replace(fixture, events=tuple(notebook.events))


def with_duration(task: TaskSettings, *, supervised_s: float, corrections_s: float) -> TaskSettings:
    """Return a copy of the task with other durations of phase 1 (`supervised_s`) and phase 2 (`corrections_s`)."""
    teaching = task.teaching.model_copy(update={"supervised_s": supervised_s, "corrections_s": corrections_s})
    return task.model_copy(update={"teaching": teaching})


@contextmanager
def open_writer(fixture: BenchFixture, path: Path) -> Iterator[JournalWriter]:
    """Open a writer on a new knowledge file with the fixture's lessons. Raises KnowledgeError."""
    with open_knowledge(path, fixture.settings, fixture.task) as journal:
        journal.append([JournalEntry(event, utc_now()) for event in fixture.events])
        with JournalWriter(journal, utc_now) as writer:
            yield writer
