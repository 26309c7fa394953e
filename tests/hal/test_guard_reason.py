"""Codes of the guard, and their values in recordings."""

from hal.guard_reason import GuardReason, guard_reason


def test_guard_reason_known_value_is_its_code() -> None:
    assert [guard_reason(each.value) for each in GuardReason] == list(GuardReason)


def test_guard_reason_unknown_value_is_other() -> None:
    assert guard_reason("battery empty") is GuardReason.OTHER


def test_routine_is_the_slew_limit_only() -> None:
    assert [each for each in GuardReason if each.routine] == [GuardReason.SLEW_LIMIT]
