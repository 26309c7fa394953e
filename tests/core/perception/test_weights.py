"""Weights of features in a distance."""

import anyio
import pytest

from config.settings import SettingsError
from kurt2rt.core.perception.definition import feature_weights, load_situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import FeatureWeight, load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime
from tests.core.rla.helpers import created
from tests.experiments.helpers import ROBOT, STAGE

DEFINITION = load_situation("basic", ROBOT.infrared.names)
NAMES = DEFINITION.names


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ([(("s19",), 2.0)], "task mine: learning.weights.0.features: .*'s19'; .*: s1, s2, "),
        ([(("s1 (10 s average)",), 2.0)], r"'s1 \(10 s average\)'"),
        ([(("s1", "s2"), 2.0), (("s2",), 3.0)], "task mine: learning.weights.1.features: 's2' "),
        ([(tuple(each.name for each in DEFINITION.features), 0.0)], "task mine: learning.weights: .*0;"),
    ],
)
def test_feature_weights_unknown_or_double_is_refused(changed: list[tuple[tuple[str, ...], float]], told: str) -> None:
    with pytest.raises(SettingsError, match=told):
        feature_weights(DEFINITION, changed, 1.0, "mine")


def first_tick(*taught: TeachingEvent, weights: tuple[FeatureWeight, ...] = ()) -> TickRecord:
    """Return the first tick of a robot at a fixed place with these lessons."""
    task = load_task("fleeing")
    task = task.model_copy(update={"learning": task.learning.model_copy(update={"weights": weights})})
    simulation = STAGE.open("a", 1, "exam")
    records: list[TickRecord] = []
    try:
        runtime = build_runtime(
            simulation.robot, ROBOT, task, taught, NoTeachingAllowed(), LockstepClock(simulation.step)
        )
        anyio.run(runtime.scheduler.run, 1, records.append)
    finally:
        simulation.close()
    return records[0]


def test_feature_weights_decide_which_rla_drives() -> None:
    here = first_tick().situation.vector

    def unlike_in(feature: str, counts: float) -> tuple[float, ...]:
        condition = here.copy()
        condition[NAMES.index(feature)] += counts
        return tuple(condition.tolist())

    taught = (created(1, unlike_in("s15", 100.0), "forward"), created(2, unlike_in("s2", 120.0), "back"))
    assert first_tick(*taught).decision.action == "forward"
    heavy = FeatureWeight(weight=2.0, features=("s15",))
    assert first_tick(*taught, weights=(heavy,)).decision.action == "back"
    light = FeatureWeight(weight=0.0, features=("s2",))
    assert first_tick(*taught, weights=(light,)).decision.action == "back"
