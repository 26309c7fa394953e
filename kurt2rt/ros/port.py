"""Interface of a connection to ROS 2 topics, and one within this process for simulated time."""

from collections import defaultdict
from collections.abc import Callable
from typing import Protocol

from hal.bus import BusError
from kurt2rt.ros.messages import Message, encode
from kurt2rt.ros.settings import RosSettings
from kurt2rt.ros.topic import Topic, key_expression

OnPayload = Callable[[bytes], None]
"""Receiver of a message's CDR bytes. zenoh calls it in a thread of its own: keep them and return, raise nothing."""


class RosConnectionError(BusError):
    """Connection to the topics that is closed, or that cannot be made."""


class Publisher(Protocol):
    """Sender of one topic's messages, from `RosPort.publisher`."""

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
        """Call `on_payload` with each message of a topic that another program sends. Raises RosConnectionError."""
        ...

    def close(self) -> None:
        """Close the connection; may be called twice."""
        ...


class LocalTopics:
    """Topics within this process, with the very bytes that zenoh would carry. They arrive in the call that sends."""

    def __init__(self, settings: RosSettings) -> None:
        """Start without ends; `settings` gives the names."""
        self.settings = settings
        self.connected = True
        """Set to False to break the connection: messages are lost, and all ends see it."""
        self._receivers: defaultdict[str, list[tuple[LocalPort, OnPayload]]] = defaultdict(list)

    def join(self) -> "LocalPort":
        """Return a new end, for one program."""
        return LocalPort(self)

    def add(self, key: str, end: "LocalPort", on_payload: OnPayload) -> None:
        """Call `on_payload` with the messages of a key that other ends send."""
        self._receivers[key].append((end, on_payload))

    def carry(self, key: str, payload: bytes, sender: "LocalPort | None" = None) -> None:
        """Hand bytes, also invalid ones, to the subscriptions of a key at all ends but the sender's."""
        if self.connected:
            for end, receive in self._receivers[key]:
                if end is not sender:
                    receive(payload)


class LocalPort:
    """One program's connection to topics in memory, for tests and simulations (RosPort)."""

    def __init__(self, topics: LocalTopics) -> None:
        self._topics = topics

    @property
    def connected(self) -> bool:
        """True until the connection is broken."""
        return self._topics.connected

    def publisher(self, topic: Topic) -> "_LocalPublisher":
        """Return the sender of a topic's messages."""
        return _LocalPublisher(self._topics, key_expression(topic, self._topics.settings), self)

    def subscribe(self, topic: Topic, on_payload: OnPayload) -> None:
        """Call `on_payload` with each message of a topic that another end sends from now on."""
        self._topics.add(key_expression(topic, self._topics.settings), self, on_payload)

    def close(self) -> None:
        """Do nothing: the topics are in memory."""


class _LocalPublisher:
    def __init__(self, topics: LocalTopics, key: str, sender: LocalPort) -> None:
        self._topics, self._key, self._sender = topics, key, sender

    def publish(self, message: Message) -> None:
        self._topics.carry(self._key, encode(message), self._sender)
