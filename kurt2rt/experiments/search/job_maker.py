"""Maker of the jobs of a search."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from kurt2rt.experiments.lockstep.drive_loop import DriveLoops, choose_witnesses
from kurt2rt.experiments.search.jobs import SearchJob, label_of
from kurt2rt.experiments.search.settings import Robots, SearchSettings
from kurt2rt.experiments.search.space import TaskSpace, Values
from kurt2rt.experiments.study.bus_witness import BusWitnessJob
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints


@dataclass(frozen=True, slots=True)
class JobMaker:
    """Maker of the jobs of one search."""

    search: SearchSettings
    space: TaskSpace
    parts: JobParts
    fingerprints: Fingerprints

    def trial(self, values: Values, trial: int) -> tuple[SearchJob, ...]:
        """Return the jobs of a trial, in the order in which its robots are taught."""
        return self._jobs("trials", label_of(trial), values, self.search.search)

    def check(self, values: Values, label: str, robots: Robots) -> tuple[SearchJob, ...]:
        """Return the jobs of the check of one set of settings."""
        return self._jobs("check", label, values, robots)

    def witnesses_of_trials(self, jobs: Sequence[SearchJob]) -> tuple[BusWitnessJob, ...]:
        """Return the witnesses of these jobs: of 1 % of all trials, and of three of the first, which has all robots."""
        seeds, of_trials = self.search.search.seeds.seeds, [label_of(trial) for trial in range(self.search.trials)]
        chosen = {
            name
            for labels in (of_trials[:1], of_trials)
            for name in choose_witnesses([f"{label}, seed {seed}" for label in labels for seed in seeds], "trials")
        }
        return self._witnesses(job for job in jobs if f"{job.label}, seed {job.seed}" in chosen)

    def witnesses_of_check(self, jobs: Sequence[SearchJob]) -> tuple[BusWitnessJob, ...]:
        """Return the witnesses of the check, whose jobs these are."""
        chosen = choose_witnesses([job.stem for job in jobs], "check")
        return self._witnesses(job for job in jobs if job.stem in chosen)

    def _witnesses(self, jobs: Iterable[SearchJob]) -> tuple[BusWitnessJob, ...]:
        return tuple(map(BusWitnessJob.witness_of, (job for job in jobs if job.loops.in_batch)))

    def _jobs(self, part: str, label: str, values: Values, robots: Robots) -> tuple[SearchJob, ...]:
        jobs, task = [], self.space.task(values)
        loops = DriveLoops(self.search.lessons, self.search.exams)
        for seed in robots.seeds.seeds:
            worlds = robots.worlds_of(seed)
            own = task.model_copy(update={"exam": task.exam.model_copy(update={"worlds": worlds})})
            made = self.fingerprints.of(own, (task.teaching.world, *worlds))
            jobs.append(SearchJob(part=part, label=label, task=own, seed=seed, loops=loops, made_of=made, **self.parts))
        return tuple(jobs)
