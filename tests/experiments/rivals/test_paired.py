import pytest

from kurt2rt.experiments.rivals.paired import Pairs, holm, mcnemar_p, pairs_of
from tests.experiments.rivals.outcomes import robot


@pytest.mark.parametrize(
    ("pairs", "p_value"),
    [
        (Pairs(0, 0), 1.0),
        (Pairs(3, 3), 1.0),
        (Pairs(1, 5), 14 / 64),  # 2 (1 + 6) / 2^6
        (Pairs(5, 1), 14 / 64),
        (Pairs(0, 10), 2 / 1024),
    ],
)
def test_mcnemar_is_the_two_sided_binomial_of_half(pairs: Pairs, p_value: float) -> None:
    assert mcnemar_p(pairs) == pytest.approx(p_value)


def test_holm_multiplies_by_the_tests_left_and_never_falls() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []


def test_pairs_count_judged_robots_that_one_rival_passes_with() -> None:
    ours = [robot(1, "right"), robot(2, "right"), robot(3, "stuck"), robot(4, "not judged"), robot(5, "stuck")]
    theirs = [robot(1, "stuck"), robot(2, "right"), robot(3, "right"), robot(4, "right"), robot(5, "stuck")]
    assert pairs_of(ours, theirs) == Pairs(1, 1)
