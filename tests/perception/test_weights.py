"""What each feature counts in a distance."""

import numpy as np
import pytest

from hal.robot_settings import load_robot
from hal.settings import SettingsError
from kurt2rt.perception.definition import load_situation
from kurt2rt.perception.weights import weights_of

DEFINITION = load_situation("basic", load_robot().infrared.names)
NAMES = DEFINITION.names


def test_all_recent_features_weigh_one_and_their_averages_a_share_of_it() -> None:
    weights = weights_of(DEFINITION, (), 0.25)
    assert weights.tolist() == [1.0] * 36 + [0.25] * 36


def test_some_weigh_something_else_in_both_halves() -> None:
    weights = dict(
        zip(NAMES, weights_of(DEFINITION, [(("s15", "maximum front"), 3.0), (("s2",), 0.0)], 0.5), strict=True)
    )
    assert weights["s15"] == weights["maximum front"] == 3.0
    assert weights["s15 (10 s average)"] == 1.5
    assert weights["s2"] == weights["s2 (10 s average)"] == 0.0
    assert np.isclose(sum(weights.values()), (33 + 6) * 1.5)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ([(("s19",), 2.0)], "has no feature 's19'; it has: s1, s2, "),
        ([(("s1 (10 s average)",), 2.0)], "has no feature 's1 (10 s average)'"),
        ([(("s1", "s2"), 2.0), (("s2",), 3.0)], "'s2' is given two weights"),
    ],
)
def test_a_feature_that_is_not_there_or_twice_is_refused(
    changed: list[tuple[tuple[str, ...], float]], told: str
) -> None:
    with pytest.raises(SettingsError) as caught:
        weights_of(DEFINITION, changed, 1.0)
    assert told in str(caught.value)
