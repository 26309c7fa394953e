"""Codes of the guard."""

from hal.guard_reason import GuardReason


def test_routine_is_the_slew_limit_only() -> None:
    assert [each for each in GuardReason if each.routine] == [GuardReason.SLEW_LIMIT]
