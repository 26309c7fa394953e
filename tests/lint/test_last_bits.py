"""The checker of last bits finds its operations, and passes those that are equal on every computer."""

from pathlib import Path

import pytest

from tests.lint.last_bits import ALLOWED, last_bits_findings
from tests.lint.ratchet import ROOT


def names(source: str, path: str = "hal/x.py") -> list[str]:
    return [finding.name for finding in last_bits_findings(path, source)]


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("sum(shares)", "sum"),
        ("sum(each.x_m for each in poses)", "sum"),
        ("forward_m * math.cos(heading_rad)", "math.cos"),
        ("map(math.exp, numbers)", "math.exp"),
        ("np.einsum('ij,ij->i', away, away)", "np.einsum"),
        ("np.linalg.norm(away)", "np.linalg"),
        ("away.dot(away)", "dot"),
        ("away @ away", "@"),
        ("x_m**2", "**"),
    ],
)
def test_operation_with_other_last_bits_is_found(source: str, name: str) -> None:
    assert names(source) == [name]


@pytest.mark.parametrize(
    "source",
    [
        *("sum(each > 0 for each in counts)", "sum(1 for _ in rows)", "sum([len(each) for each in rows])"),
        *("math.fsum(shares)", "math.sqrt(x) + math.hypot(x, y) + math.dist(a, b)"),
        *("round_portable(1.0 - math.exp(-x))", "round(math.sin(x), 6)", "10**6 + 2.0**-32", "cos_sin(heading_rad)"),
    ],
)
def test_operation_with_equal_last_bits_is_not_found(source: str) -> None:
    assert not names(source)


def test_whole_round_hides_nothing() -> None:
    assert names("round(math.sin(x))") == ["math.sin"]


def test_rooms_that_decide_nothing_are_left_out() -> None:
    assert not names("sum(shares)", "kurt2rt/cli/x.py")


@pytest.mark.parametrize("path", ALLOWED)
def test_allowed_place_is_still_there(path: str) -> None:
    text = (Path(ROOT) / path).read_text(encoding="utf-8")
    assert set(ALLOWED[path]) == set(names(text)), "take out of tests/lint/last_bits.toml what is gone"
