import json
from typing import Any

from kurt2rt.teacher.page.page_connection import PageConnection


def taken(visitor: PageConnection, now_s: float = 0.0) -> list[dict[str, Any]]:
    found = []
    while (text := visitor.take(now_s)) is not None:
        found.append(json.loads(text))
    return found


def visible() -> PageConnection:
    visitor = PageConnection(1)
    visitor.visible = True
    return visitor


def test_of_the_robot_s_state_only_the_newest_waits() -> None:
    visitor = visible()
    for tick in range(10):
        visitor.show(b"boot", {"kind": "state", "tick": tick})
    assert [each["tick"] for each in taken(visitor)] == [9]


def test_a_page_that_nobody_sees_gets_no_pictures_but_hears_the_rest() -> None:
    visitor = PageConnection(1)
    visitor.show(b"boot", {"kind": "state", "tick": 1})
    visitor.tell({"kind": "hello"})
    assert [each["kind"] for each in taken(visitor)] == ["hello"]
    visitor.visible = True
    assert [each["kind"] for each in taken(visitor)] == ["state"]


def test_a_slow_page_is_sent_nothing_old_when_it_wakes_up() -> None:
    visitor = visible()
    sent: list[dict[str, Any]] = []
    for tick in range(100):
        visitor.show(b"boot", {"kind": "state", "tick": tick})
        sent += taken(visitor)
    assert len(sent) == 8
    visitor.pictures.see(sent[-1]["picture"])
    assert [each["tick"] for each in taken(visitor)] == [99]


def test_of_what_is_about_the_same_thing_the_last_word_counts() -> None:
    visitor = PageConnection(1)
    for number in range(1000):
        visitor.tell({"kind": "lessons", "number": number}, about="lessons")
    visitor.tell({"kind": "answer"})
    assert [each.get("number") for each in taken(visitor)] == [999, None]
    assert not visitor.lost


def test_a_page_that_takes_no_answers_is_lost() -> None:
    visitor = PageConnection(1)
    for number in range(1000):
        visitor.tell({"kind": "answer", "number": number})
    assert visitor.lost
    assert len(taken(visitor)) == 64


def test_a_heartbeat_is_sent_back_for_the_round_trip() -> None:
    visitor = visible()
    visitor.beat = (5000.0, 10.0)
    visitor.show(b"boot", {"kind": "state", "tick": 1})
    assert taken(visitor, now_s=10.02)[0]["echo"] == [5000.0, 20.0]
