"""Topics and services, and their key expressions on zenoh (docs/other-robots.md#names-on-zenoh)."""

from typing import NamedTuple

from config.errors import UserError
from kurt2rt.ros.messages import TRIGGER, Message, type_hash
from kurt2rt.ros.settings import Naming, RosSettings, is_ros_name

_DEFAULT_QOS = "::,7:,:,:,,"
"""Default quality of service but for the history's depth, as rmw_zenoh's qos_to_keyexpr writes it."""


class Topic(NamedTuple):
    """Name and type of a topic or service."""

    name: str
    """Relative ("scan") or absolute ("/scan"); an absolute name has no namespace before it."""
    type_name: str
    """Such as "sensor_msgs/msg/LaserScan"."""


def topic_of(name: str, kind: type[Message]) -> Topic:
    """Return the topic of a name that carries messages of class `kind`. Raises UserError for an impossible name."""
    return Topic(_checked(name), kind.__msgtype__)


def trigger_service(name: str) -> Topic:
    """Return the std_srvs/srv/Trigger service of a name. Raises UserError for an impossible name."""
    return Topic(_checked(name), TRIGGER)


def full_name(topic: Topic, settings: RosSettings) -> str:
    """Return the absolute name without its first slash, such as "robot1/scan"."""
    if topic.name.startswith("/") or not settings.namespace:
        return topic.name.lstrip("/")
    return f"{settings.namespace.strip('/')}/{topic.name}"


def key_expression(topic: Topic, settings: RosSettings) -> str:
    """Return the key on which zenoh carries a topic's messages or a service's requests."""
    name = full_name(topic, settings)
    if settings.naming is Naming.BRIDGE:
        return name
    return f"{settings.domain}/{name}/{_type_and_hash(topic, settings.naming)}"


def liveliness_key(topic: Topic, settings: RosSettings, session_id: str, kind: str, entity: int) -> str:
    """Return the key of the token by which `ros2 topic list` sees an entity of rmw_zenoh.

    `kind` is MP (publisher), MS (subscription) or SS (service); `entity` is its number in this session, from 1.
    """
    node = _node_key(settings, session_id, entity, kind)
    mangled = "%" + full_name(topic, settings).replace("/", "%")
    return f"{node}/{mangled}/{_type_and_hash(topic, settings.naming)}/{_DEFAULT_QOS}"


def node_liveliness_key(settings: RosSettings, session_id: str) -> str:
    """Return the key of the token by which `ros2 node list` sees this session."""
    return _node_key(settings, session_id, 0, "NN")


def _node_key(settings: RosSettings, session_id: str, entity: int, kind: str) -> str:
    namespace = "%" + settings.namespace.strip("/").replace("/", "%")
    return f"@ros2_lv/{settings.domain}/{session_id}/0/{entity}/{kind}/%/{namespace}/{settings.node}"


def _type_and_hash(topic: Topic, naming: Naming) -> str:
    package, group, name = topic.type_name.split("/")
    hash_text = "TypeHashNotSupported" if naming is Naming.RMW_ZENOH_HUMBLE else type_hash(topic.type_name)
    return f"{package}::{group}::dds_::{name}_/{hash_text}"


def _checked(name: str) -> str:
    if not is_ros_name(name):
        raise UserError(f"{name!r} is not a name of ROS", where="topic", do="use letters, digits and _, joined by /")
    return name
