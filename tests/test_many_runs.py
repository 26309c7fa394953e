"""The table of many runs: what counts as a failed run."""

import pytest

from tests.many_runs import Run, parse

WELL = "........ [100%]\n8190 passed, 2 skipped in 250.10s (0:04:10)\n"
ILL = "FAILED tests/a.py::test_b[c] - AssertionError\nERROR tests/d.py::test_e\n1 failed, 7 passed, 1 error in 3.00s\n"


@pytest.mark.parametrize(
    ("output", "exit_code", "run"),
    [
        (WELL, 0, Run(8190, 0, 3.0, ())),
        (ILL, 1, Run(7, 2, 3.0, ("tests/a.py::test_b[c]", "tests/d.py::test_e"))),
        ("INTERNALERROR> 3 passed the time\nbroken\n", 3, Run(0, 1, 3.0, ())),
    ],
)
def test_parse_output_counts_failures_and_broken_runs(output: str, exit_code: int, run: Run) -> None:
    assert parse(output, exit_code, 3.0) == run
