"""Inbox of one topic: order, ages, junk, and limits against floods."""

from kurt2rt.ros.inbox import Inbox
from kurt2rt.ros.messages import InvalidMessageError, String, TwistStamped, encode
from kurt2rt.ros.port import LocalTopics
from kurt2rt.ros.settings import RosSettings
from kurt2rt.ros.topic import topic_of
from tests.ros.examples import HEADER, TWIST

WORDS = topic_of("words", String)


class SetClock:
    """Clock that the test sets."""

    now = 5.0
    wall = 1_700_000_001.5

    def now_s(self) -> float:
        return self.now

    def wall_s(self) -> float:
        return self.wall


def inbox_of_words(topics: LocalTopics) -> Inbox[String]:
    return Inbox(topics.join(), WORDS, String, SetClock())


def text_of(message: String, _age_s: float) -> str:
    return message.data


def test_inbox_age_is_of_stamp_and_waiting_together() -> None:
    topics, clock = LocalTopics(RosSettings()), SetClock()
    twists = topic_of("twists", TwistStamped)
    inbox = Inbox(topics.join(), twists, TwistStamped, clock, one_sender=True)
    topics.join().publisher(twists).publish(TwistStamped(HEADER, TWIST))  # stamped 0.25 s before its arrival
    clock.now += 0.5
    assert list(inbox.take(lambda _, age_s: age_s)) == [0.75]


def test_inbox_invalid_huge_and_refused_messages_are_junk() -> None:
    topics = LocalTopics(RosSettings())
    inbox = inbox_of_words(topics)

    def refuse(message: String, age_s: float) -> str:
        if message.data == "no":
            raise InvalidMessageError("refused")
        return text_of(message, age_s)

    for payload in (b"", encode(String("x" * 200_000)), encode(String("no")), encode(String("yes"))):
        topics.carry("words", payload)
    assert list(inbox.take(refuse)) == ["yes"]
    assert inbox.junk == 3
