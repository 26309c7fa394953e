"""Codes of the guard, and their text for users."""

from hal.guard_reason import GuardReason, reasons_text


def test_routine_is_the_slew_limit_only() -> None:
    assert [each for each in GuardReason if each.routine] == [GuardReason.SLEW_LIMIT]


def test_reasons_text_names_range_sensors() -> None:
    reasons = (GuardReason.INFRARED_STALE, GuardReason.FRONT_BUMPER, GuardReason.INFRARED_FROZEN)
    assert reasons_text(reasons) == "range sensors stale, front bumper, range sensors frozen"
    assert reasons_text(()) == ""
