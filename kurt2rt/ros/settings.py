"""Settings of a connection to ROS 2: which names its topics have on zenoh."""

import re
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from config.settings import Settings

_NAME = re.compile(r"(/?[A-Za-z_][A-Za-z0-9_]*)(/[A-Za-z_][A-Za-z0-9_]*)*")
"""Names of topics and services (design.ros2.org, "Topic and Service name mapping to DDS")."""


def is_ros_name(name: str) -> bool:
    """Return whether a text is a name of a topic, service or namespace."""
    return _NAME.fullmatch(name) is not None


def _require_name(name: str) -> str:
    if not is_ros_name(name):
        raise ValueError(f"{name!r} is not a name of ROS (letters, digits and _, joined by /)")
    return name


RosName = Annotated[str, AfterValidator(_require_name)]
"""Name of a topic, service, node or namespace."""


class Naming(StrEnum):
    """Names of topics on zenoh, by the program at the other end."""

    BRIDGE = "bridge"
    """zenoh-bridge-ros2dds: the topic's name alone, such as `scan`."""
    RMW_ZENOH = "rmw_zenoh"
    """rmw_zenoh_cpp from Jazzy on: `<domain>/<topic>/<type>/<hash>`, with an attachment."""
    RMW_ZENOH_HUMBLE = "rmw_zenoh_humble"
    """The same in Humble, whose types have no hash."""


class RosSettings(Settings):
    """Domain, namespace and naming of a robot's topics on ROS 2, and the name of this program's node."""

    naming: Naming = Field(default=Naming.BRIDGE, strict=False)
    domain: Annotated[int, Field(ge=0, le=232)] = 0
    """ROS_DOMAIN_ID; rmw_zenoh has it in each key."""
    namespace: RosName | Literal[""] = ""
    """Namespace before each relative name, such as "robot1"."""
    node: RosName = "kurt2rt"
    """Name of this program's node in `ros2 node list` (rmw_zenoh alone)."""
