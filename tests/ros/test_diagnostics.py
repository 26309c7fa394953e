"""Errors of a base: which status ends one, and how many are held."""

import pytest

from kurt2rt.ros.diagnostics import DiagnosticErrors
from kurt2rt.ros.messages import DiagnosticArray, DiagnosticStatus
from tests.ros.examples import HEADER


def told(errors: DiagnosticErrors, level: int, *names: str) -> str:
    errors.update(DiagnosticArray(HEADER, [DiagnosticStatus(level, name, "hot", "", []) for name in names]))
    return errors.text


@pytest.mark.parametrize(("level", "text"), [(0, ""), (1, ""), (3, "motors: hot"), (7, "motors: hot")])
def test_error_lasts_until_its_name_is_known_to_be_well(level: int, text: str) -> None:
    errors = DiagnosticErrors(["motors"])
    assert told(errors, 2, "motors") == "motors: hot"
    assert told(errors, level, "motors") == text


def test_errors_of_endless_names_are_held_as_64_and_one_more() -> None:
    errors, names = DiagnosticErrors(["motor"]), [f"motor {number}" for number in range(2000)]
    assert told(errors, 2, *names) == "motor 0: hot"
    assert len(errors._errors) == 65
    assert told(errors, 0, *names) == "more than 64 parts: mend them, and start the program again"
