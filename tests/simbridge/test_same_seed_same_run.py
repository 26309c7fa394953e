import pytest

from tests.cli.helpers import ROOT, started
from tests.processors import OF_2004
from tests.simbridge import turning_run
from tests.simbridge.same_run import hashes


@pytest.fixture(scope="module")
def first() -> list[str]:
    return hashes()


def test_run_same_seed_is_equal_to_the_last_bit(first: list[str]) -> None:
    assert first == hashes()
    assert len(set(first)) == len(first)


def test_run_in_another_process_is_equal(first: list[str]) -> None:
    # Forked from another interpreter than this one: it hashes text otherwise.
    with started("tests.simbridge.same_run", folder=ROOT) as other:
        said, complaints = other.communicate()
    assert (said.split(), complaints) == (first, "")


@pytest.mark.deep
def test_run_without_fused_multiply_add_is_equal() -> None:
    with started("tests.simbridge.turning_run", folder=ROOT, environment=OF_2004, fresh=True) as other:
        said, complaints = other.communicate()
    assert (said.split(), complaints) == (turning_run.hashes(), "")
