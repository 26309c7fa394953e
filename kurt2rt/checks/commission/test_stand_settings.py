"""Robot settings for the test stand: slow, tolerant, without missing parts."""

from collections.abc import Collection

from hal.kurt2_settings import Kurt2Settings, SpeedMode

MAXIMUM_SPEED_M_S = 0.2
ACCELERATION_M_S2 = 0.5
PATIENCE_S = 0.5
"""Allowed silence of infra-red and bumpers.

With the wheels in the air they are not needed, and the checklist must find controllers with other periods.
"""


def test_stand_settings(
    robot: Kurt2Settings, mode: SpeedMode, channels: Collection[str], *, has_bumpers: bool
) -> Kurt2Settings:
    """Return the guard settings for wheel tests in a speed mode, with the received analog channels only.

    Without any channel the sensor table stays, and the guard will not let the wheels turn.
    """
    sensors = tuple(sensor for sensor in robot.infrared.sensors if sensor.channel in channels)
    limits = robot.guard
    guard = limits.model_copy(
        update={
            "maximum_speed_m_s": min(MAXIMUM_SPEED_M_S, limits.maximum_speed_m_s),
            "acceleration_m_s2": min(ACCELERATION_M_S2, limits.acceleration_m_s2),
            "stale_infrared_s": PATIENCE_S,
            "stale_bumper_s": PATIENCE_S,
            # Wheels that disobey, and boards that hang, are what the checklist looks for: it must see them at work.
            "wheel_error_m_s": 3.0,
            "frozen_infrared_s": 3600.0,
        }
    )
    return robot.model_copy(
        update={
            "can": robot.can.model_copy(update={"speed_mode": mode}),
            "guard": guard,
            "infrared": robot.infrared.model_copy(update={"sensors": sensors or robot.infrared.sensors}),
            "bumpers": robot.bumpers if has_bumpers else (),
        }
    )
