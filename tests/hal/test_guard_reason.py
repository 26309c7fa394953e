"""Codes of the guard, and their values in recordings."""

from hal.guard_reason import GuardReason, guard_reason, reasons_text


def test_guard_reason_known_value_is_its_code() -> None:
    assert [guard_reason(each.value) for each in GuardReason] == list(GuardReason)


def test_guard_reason_unknown_value_is_other() -> None:
    assert guard_reason("battery empty") is GuardReason.OTHER


def test_routine_is_the_slew_limit_only() -> None:
    assert [each for each in GuardReason if each.routine] == [GuardReason.SLEW_LIMIT]


def test_reasons_text_names_range_sensors() -> None:
    reasons = (GuardReason.INFRARED_STALE, GuardReason.FRONT_BUMPER, GuardReason.INFRARED_FROZEN)
    assert reasons_text(reasons) == "range sensors stale, front bumper, range sensors frozen"
    assert reasons_text(()) == ""
