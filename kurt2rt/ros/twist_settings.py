"""Settings of the twists that a base takes."""

from typing import Annotated

from pydantic import Field

from config.settings import Settings


class TwistSettings(Settings):
    """Form of the twists that a base takes: message type, steps in m/s and rad/s, fastest turn."""

    stamped: bool
    """True for geometry_msgs/TwistStamped, False for geometry_msgs/Twist."""
    linear_step_m_s: Annotated[float, Field(gt=0, le=0.1)]
    """Steps to which the base cuts speeds off."""
    angular_step_rad_s: Annotated[float, Field(gt=0, le=0.1)]
    maximum_rad_s: Annotated[float, Field(gt=0, le=20)]
