"""Names on zenoh: the examples of rmw_zenoh's design document, and the bridge's plain names."""

import pytest

from config.errors import UserError
from kurt2rt.ros.messages import LaserScan, String
from kurt2rt.ros.settings import Naming, RosSettings
from kurt2rt.ros.topic import Topic, key_expression, liveliness_key, node_liveliness_key, topic_of

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
CHATTER = topic_of("chatter", String)


@pytest.mark.parametrize(
    ("settings", "topic", "key"),
    [
        (RosSettings(), topic_of("/scan", LaserScan), "scan"),
        (RosSettings(namespace="robot1"), topic_of("scan", LaserScan), "robot1/scan"),
        (
            RosSettings(naming=Naming.RMW_ZENOH, namespace="robot1"),
            CHATTER,
            f"0/robot1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}",
        ),
        (
            RosSettings(naming=Naming.RMW_ZENOH_HUMBLE, domain=7),
            CHATTER,
            "7/chatter/std_msgs::msg::dds_::String_/TypeHashNotSupported",
        ),
    ],
)
def test_key_of_a_topic_follows_the_naming(settings: RosSettings, topic: Topic, key: str) -> None:
    assert key_expression(topic, settings) == key


def test_tokens_are_those_of_the_design_document() -> None:
    settings = RosSettings(naming=Naming.RMW_ZENOH, domain=2, node="talker")
    session = "8b20917502ee955ac4476e0266340d5c"
    assert node_liveliness_key(settings, session) == f"@ros2_lv/2/{session}/0/0/NN/%/%/talker"
    assert (
        liveliness_key(CHATTER, settings, session, "MP", 10)
        == f"@ros2_lv/2/{session}/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{STRING_HASH}/::,7:,:,:,,"
    )


@pytest.mark.parametrize("name", ["", "/", "a//b", "*", "scan/**", "1scan", "a b", "scan/"])
def test_topic_impossible_name_is_refused(name: str) -> None:
    with pytest.raises(UserError, match="is not a name of ROS"):
        topic_of(name, String)
