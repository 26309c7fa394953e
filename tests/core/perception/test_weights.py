"""Weights of features in a distance."""

import anyio
import numpy as np
import pytest

from hal.settings import SettingsError
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


def test_feature_weights_averages_have_a_share() -> None:
    weights = feature_weights(DEFINITION, (), 0.25, "mine")
    assert weights.tolist() == [1.0] * 36 + [0.25] * 36


def test_feature_weights_changed_in_both_halves() -> None:
    weights = dict(
        zip(
            NAMES,
            feature_weights(DEFINITION, [(("s15", "maximum front"), 3.0), (("s2",), 0.0)], 0.5, "mine"),
            strict=True,
        )
    )
    assert weights["s15"] == weights["maximum front"] == 3.0
    assert weights["s15 (10 s average)"] == 1.5
    assert weights["s2"] == weights["s2 (10 s average)"] == 0.0
    assert np.isclose(sum(weights.values()), (33 + 6) * 1.5)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            [(("s19",), 2.0)],
            "task mine: learning.weights.0.features: .*'s19'; .*: s1, s2, ",
        ),
        ([(("s1 (10 s average)",), 2.0)], r"'s1 \(10 s average\)'"),
        ([(("s1", "s2"), 2.0), (("s2",), 3.0)], "task mine: learning.weights.1.features: 's2' "),
        (
            [(tuple(each.name for each in DEFINITION.features), 0.0)],
            "task mine: learning.weights: .*0;",
        ),
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


MIRRORED = {"s1": "s5", "s2": "s6", "s3": "s7", "s4": "s8", "s9": "s10", "s12": "s13", "s15": "s16", "s17": "s18"}
"""Sensors that the robot has on both sides, left to right."""


def mirrored(feature: str) -> str:
    """Return the feature that a robot sees in place of another one in the mirrored world."""
    swap = {**MIRRORED, **{right: left for left, right in MIRRORED.items()}, "left": "right", "right": "left"}
    return " ".join(">".join(swap.get(name, name) for name in word.split(">")) for word in feature.split(" "))


def test_weights_of_fleeing_are_symmetric() -> None:
    learning = load_task("fleeing").learning
    changed = [(each.features, each.weight) for each in learning.weights]
    values = feature_weights(DEFINITION, changed, learning.history_weight, "fleeing")
    weights = dict(zip(NAMES[:34], values, strict=False))
    assert {feature: weights[mirrored(feature)] for feature in weights} == weights
    assert len(set(weights.values())) > 1
