"""What the controls of the branches did not show."""

from collections.abc import Iterator

from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    CORRUPTED,
    CRITIC_ALONE,
    REWARDS,
    SHUFFLED,
    TITLES,
    UNKNOWN_BAD,
)
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.summary import alike
from kurt2rt.experiments.phases.tables.taught import taught_of


def words_of_controls(study: PhasesStudy) -> Iterator[str]:
    """Sentences on controls that say nothing, because what they are to show did not happen."""
    stages = study.stages
    robots = len(stages[ASKS])
    if not any(each.asks for each in taught_of(stages[ASKS])):
        yield f"{TITLES[ASKS]}: no robot asked anything."
    never = sum(each.blame == 0 for each in taught_of(stages[UNKNOWN_BAD]))
    if never:
        yield f"{TITLES[UNKNOWN_BAD]}: {never} of {robots} robots never met the unknown, so no -1 came."
    for one, other in (
        (ASKS, CORRUPTED),
        (UNKNOWN_BAD, ASKS),
        (BLAME_BY_CHANCE, ASKS),
        (REWARDS, ASKS),
        (CRITIC_ALONE, CORRUPTED),
        (SHUFFLED, CORRUPTED),
    ):
        same = alike(stages[one], stages[other])
        if same:
            yield f"{TITLES[one]}: {same} of {robots} robots drive exactly as in '{TITLES[other]}'."
