"""Settings of a base with a lidar on topics of ROS 2."""

from typing import Annotated

from pydantic import Field

from config.settings import Settings, SettingsError
from hal.robot_settings import RobotSettings, Seconds
from kurt2rt.ros.settings import RosName, RosSettings
from kurt2rt.ros.twist_settings import TwistSettings


class TopicSettings(RosSettings):
    """Names of the base's ROS 2 topics, and of the diagnostics that stop it."""

    scan: RosName
    odom: RosName
    cmd_vel: RosName
    diagnostics: RosName
    stops_on_errors_of: tuple[str, ...]
    """Beginnings of the names in /diagnostics whose level ERROR stops the robot."""


class LidarSettings(Settings):
    """Lidar; the simulated one measures all rays at once, the real one while it turns."""

    rays: Annotated[int, Field(ge=24, le=10_000)]
    nearest_m: Annotated[float, Field(gt=0, le=1)]
    farthest_m: Annotated[float, Field(gt=0, le=100)]
    period_s: Seconds
    noise_m: Annotated[float, Field(ge=0, le=1)]
    """Standard deviation of each range."""
    zero_is_far: bool
    """True if a range of 0 means that nothing came back; False if it means nothing."""


class TurtlebotSettings(RobotSettings):
    """Schema of a base of ROS 2 with a laser scanner: topics, twist and lidar."""

    ros: TopicSettings
    twist: TwistSettings
    lidar: LidarSettings
    odometry_period_s: Seconds
    """Period of the simulated base's /odom."""


def require_turtlebot(settings: RobotSettings) -> TurtlebotSettings:
    """Return settings of this kind of robot. Raises config.settings.SettingsError for those of another kind."""
    if not isinstance(settings, TurtlebotSettings):
        raise SettingsError(f"is of kind {settings.kind} (allowed turtlebot)", where=f"robot {settings.name}")
    return settings
