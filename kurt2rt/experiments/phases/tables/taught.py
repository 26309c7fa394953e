"""What was done in a stage, of all robots."""

from collections.abc import Sequence

from kurt2rt.experiments.phases.outcome import StageOutcome, TeachingOutcome


def taught_of(stages: Sequence[StageOutcome]) -> list[TeachingOutcome]:
    """Of those in which something was done since the stage before."""
    return [stage.teaching for stage in stages if stage.teaching is not None]
