"""Inbox of commands for the next tick."""

import pytest

from kurt2rt.core.teaching.inbox import InboxFullError, RobotRepositioned, TeacherInbox
from tests.teacher.helpers import resume, stop, teach


def test_a_stop_finds_room_in_a_full_inbox() -> None:
    inbox = TeacherInbox(capacity=1)
    inbox.put(teach("a"))
    inbox.put(stop())
    with pytest.raises(InboxFullError):
        inbox.put(teach("b"))
    assert inbox.pop_all() == (teach("a"), stop())


def test_a_replay_says_exactly_what_the_next_tick_takes() -> None:
    inbox = TeacherInbox(capacity=1)
    inbox.put(stop())
    taken = (teach("a"), RobotRepositioned(), resume())
    inbox.replace_pending(taken)
    assert inbox.pop_all() == taken
    assert inbox.pop_all() == ()
