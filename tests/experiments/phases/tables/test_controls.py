"""Controls that say nothing."""

from kurt2rt.experiments.phases.steps import ASKS
from kurt2rt.experiments.phases.tables.controls import words_of_controls
from tests.experiments.phases.outcomes import exam, stage, study, teaching


def test_a_control_that_equals_another_is_said_to() -> None:
    words = list(words_of_controls(study(2)))
    assert "asks, unknown is -1: 2 of 2 robots never met the unknown, so no -1 came." in words
    assert "asks only: 2 of 2 robots drive exactly as in 'corrupted, untouched'." in words
    assert not any("no robot asked" in each for each in words)
    silent = [stage(ASKS, exam(progress=7.0), taught=teaching().model_copy(update={"asks": 0})) for _ in range(2)]
    words = list(words_of_controls(study(2, asks_only=silent)))
    assert "asks only: no robot asked anything." in words
    assert not any(each.startswith("asks only: 2 of 2") for each in words)
