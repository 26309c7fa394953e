import json
from typing import Any

from kurt2rt.teacher.page.page_connection import PageConnection


def sent_by(connection: PageConnection, now_s: float = 0.0) -> list[dict[str, Any]]:
    found = []
    while (text := connection.pop(now_s)) is not None:
        found.append(json.loads(text))
    return found


def visible() -> PageConnection:
    connection = PageConnection(1)
    connection.visible = True
    return connection


def test_pop_slow_page_gets_the_newest_state_next() -> None:
    connection = visible()
    sent: list[dict[str, Any]] = []
    for tick in range(100):
        connection.set_state(b"boot", {"kind": "state", "tick": tick})
        sent += sent_by(connection)
    assert len(sent) == 8
    connection.states.acknowledge(sent[-1]["picture"])
    assert [each["tick"] for each in sent_by(connection)] == [99]


def test_send_of_one_topic_replaces_the_message_that_waits() -> None:
    connection = PageConnection(1)
    for number in range(1000):
        connection.send({"kind": "lessons", "number": number}, topic="lessons")
    connection.send({"kind": "answer"})
    assert [each.get("number") for each in sent_by(connection)] == [999, None]
    assert not connection.lost


def test_send_to_a_full_queue_loses_the_page() -> None:
    connection = PageConnection(1)
    for number in range(1000):
        connection.send({"kind": "answer", "number": number})
    assert connection.lost
    assert len(sent_by(connection)) == 64
