"""Interface of a connection to ROS 2 topics, and one within this process for simulated time."""

from collections import defaultdict
from collections.abc import Callable
from typing import Protocol

from kurt2rt.ros.messages import Message, encode
from kurt2rt.ros.settings import RosSettings
from kurt2rt.ros.topic import Topic, key_expression

OnPayload = Callable[[bytes], None]
"""Receiver of a message's CDR bytes. zenoh calls it in a thread of its own: keep them and return, raise nothing."""


class RosConnectionError(Exception):
    """Connection to the topics that is closed, or that cannot be made."""


class Publisher(Protocol):
    """Sender of the messages of one topic."""

    def publish(self, message: Message) -> None:
        """Send a message without waiting. Raises RosConnectionError or kurt2rt.ros.messages.InvalidMessageError."""
        ...


class RosPort(Protocol):
    """Connection of one program to the topics of a robot."""

    @property
    def connected(self) -> bool:
        """True while the program at the other end, or the router, is connected."""
        ...

    def publisher(self, topic: Topic) -> Publisher:
        """Return the sender of a topic's messages. Raises RosConnectionError."""
        ...

    def subscribe(self, topic: Topic, on_payload: OnPayload) -> None:
        """Call `on_payload` with each message of a topic from now on. Raises RosConnectionError."""
        ...

    def close(self) -> None:
        """Close the connection; may be called twice."""
        ...


class LocalTopics:
    """Topics within this process, with the very bytes that zenoh would carry. They arrive in the call that sends."""

    def __init__(self, settings: RosSettings) -> None:
        """Start without subscriptions; `settings` gives the names."""
        self._settings = settings
        self._receivers: defaultdict[str, list[OnPayload]] = defaultdict(list)
        self.connected = True
        """Set to False to break the connection: messages are lost, and both ends see it."""

    def publisher(self, topic: Topic) -> "_LocalPublisher":
        """Return the sender of a topic's messages."""
        return _LocalPublisher(self, key_expression(topic, self._settings))

    def subscribe(self, topic: Topic, on_payload: OnPayload) -> None:
        """Call `on_payload` with each message of a topic from now on."""
        self._receivers[key_expression(topic, self._settings)].append(on_payload)

    def carry(self, key: str, payload: bytes) -> None:
        """Hand bytes, also invalid ones, to the subscriptions of a key."""
        if self.connected:
            for receive in self._receivers[key]:
                receive(payload)

    def close(self) -> None:
        """Break the connection."""
        self.connected = False


class _LocalPublisher:
    def __init__(self, topics: LocalTopics, key: str) -> None:
        self._topics, self._key = topics, key

    def publish(self, message: Message) -> None:
        self._topics.carry(self._key, encode(message))
