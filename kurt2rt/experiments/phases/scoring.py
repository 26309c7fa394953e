"""The critic beside the judge, tick by tick, while nothing is taught."""

from collections import Counter
from collections.abc import Iterator

from behaviors.judges.judge import Judge
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.phases.outcome import Judgement


class Scoring:
    """Counts what the critic says of what the judge thinks, while something drives the robot."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._ticks: Counter[tuple[int, int | None]] = Counter()

    def look(self, record: TickRecord) -> None:
        """Take in one tick."""
        if record.appraisal_features is None or not record.decision.driving:
            return
        said = None if record.opinion is None else record.opinion.said
        self._ticks[self._judge.judge(record.appraisal_features), said] += 1

    @property
    def judgements(self) -> Iterator[Judgement]:
        """Each pair of opinions that came."""
        for judged, said in sorted(self._ticks, key=str):
            yield Judgement(judged=judged, said=said, ticks=self._ticks[judged, said])
