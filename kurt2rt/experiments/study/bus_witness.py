"""Witness of a job in the batch: the CAN bus drives the same robot, and must come to the same result."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import ValidationError

from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.engine import ON_BUS, BatchDiffersError
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.results import Outcome, Progress, Results, StudyError
from kurt2rt.knowledge.journal.loading import read_knowledge

_MOST_NAMED = 5
_WITNESSES = "witnesses"
"""Folder, within that of the results, of comparisons of the batch with the CAN bus."""


class BusWitnessOutcome(Outcome):
    """Witness: the comparison of one robot that the batch drove with the same robot on the CAN bus.

    One differing part refuses all results of the folder.
    """

    job: str
    """Name of the job that was compared."""
    differing: tuple[str, ...]
    """Parts of result and knowledge that differ, at most 5; none if both are equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BusWitnessJob(StudyJob):
    """Job that is done in the batch and on the CAN bus."""

    outcome = BusWitnessOutcome
    keeps_knowledge: ClassVar[bool] = False
    replaces_others: ClassVar[bool] = True
    of: StudyJob
    """Job that a compiled engine drives."""

    @classmethod
    def witness_of(cls, job: StudyJob) -> Self:
        """Return the witness of a job. It takes the longest of all jobs, and so a difference shows early."""
        return cls(
            factory=job.factory,
            robot=job.robot,
            results=job.results,
            task=job.task,
            seed=job.seed,
            made_of=job.made_of,
            name=f"{job.name}, witness on the CAN bus",
            stem=f"{_WITNESSES}/{job.stem}",
            robot_time_s=2 * job.robot_time_s,
            wave=job.wave,
            of=job,
        )

    async def measure(self, knowledge: Path, report: Report) -> BusWitnessOutcome:
        """Do the job twice and return the comparison; files next to `knowledge` are taught into.

        Raises the errors of the job.
        """
        batch, bus = (knowledge.with_name(name) for name in ("batch", "bus"))
        outcomes = [await self.of.measure(batch, report), await replace(self.of, engines=ON_BUS).measure(bus, report)]
        differing = list(_differing_parts("", *(json.loads(each.model_dump_json()) for each in outcomes)))
        taught = [read_knowledge(file, self.robot, self.task) if file.exists() else None for file in (batch, bus)]
        if taught[0] != taught[1]:
            differing.append("lessons or statistics in the knowledge file")
        return BusWitnessOutcome(
            made_of=self.made_of, seed=self.seed, job=self.of.name, differing=tuple(differing[:_MOST_NAMED])
        )

    def run(self, on_progress: Progress) -> None:
        """Run the job and store the comparison; `on_progress` gets robot time in s.

        Raises BatchDiffersError if batch and CAN bus differ, the errors of `measure`, and OSError.
        """
        super(BusWitnessJob, self).run(on_progress)
        _require_equal(self.results.read(self, BusWitnessOutcome))


def require_no_difference(results: Results, sources: Iterable[str]) -> None:
    """Refuse a folder of results in which a witness found that the batch differs from the CAN bus.

    `sources`: hashes of the program's source whose results are wanted. Raises BatchDiffersError, StudyError.
    """
    wanted = set(sources)
    for path in sorted((results.folder / "results" / _WITNESSES).rglob("*.json")):
        try:
            outcome = BusWitnessOutcome.model_validate_json(path.read_bytes())
        except ValidationError as error:
            raise StudyError("is not a witness of this program", where=path, do="delete it, and run again") from error
        if outcome.made_of.source in wanted:
            _require_equal(outcome)


def _require_equal(outcome: BusWitnessOutcome) -> None:
    if outcome.differing:
        raise BatchDiffersError(
            f"the batch and the CAN bus differ in {', '.join(outcome.differing)}; all results of the batch are refused",
            where=outcome.job,
            do="report it, and give --engine can, and a new folder with --out",
        )


def _differing_parts(name: str, batch: Any, bus: Any) -> Iterator[str]:
    """Yield the names of the parts that differ, such as `drives.0.progress`."""
    match batch, bus:
        case dict(), dict():
            pairs = [(key, batch.get(key), bus.get(key)) for key in batch | bus]
        case list(), list() if len(batch) == len(bus):
            pairs = [(str(place), *each) for place, each in enumerate(zip(batch, bus, strict=True))]
        case _:
            if batch != bus:
                yield name
            return
    for key, one, other in pairs:
        yield from _differing_parts(f"{name}.{key}" if name else key, one, other)
