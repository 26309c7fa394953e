"""Correction by rewind: stop, look back, name the action; the robot drives on."""

from itertools import count

from kurt2rt.core.teacher_settings import LogNormalDelay
from kurt2rt.core.teaching.commands import Command, Correct
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from kurt2rt.teacher.scripted.human_limits import DelaySampler
from kurt2rt.teacher.scripted.look_back import LookBack, Mistake
from tests.teacher.scripted.test_person import asking, doing, standing

PERIOD_S = 0.01
TAKES_S = 2.0


class Rewinding:
    """A person who looks back for a mistake that began in tick 40."""

    def __init__(self, *, is_slip: bool = False) -> None:
        takes = LogNormalDelay(kind="log_normal", median_s=TAKES_S, spread=0.0, longest_s=60.0)
        delay = DelaySampler(takes, slower_per_minute=0.0, period_s=PERIOD_S, seed="s")
        self.look_back = LookBack(Mistake(40, "b", is_slip=is_slip), delay, PERIOD_S)
        self._ids = (f"s-{number}" for number in count(1))

    def see(self, tick: int, view: TeacherView) -> Command | None:
        return self.look_back.update(tick, view._replace(tick=tick), lambda: next(self._ids))

    def wait_for_command(self, start: int) -> tuple[int, Command]:
        """Show a standing robot from a tick on; return the tick of the next command, and the command."""
        for tick in range(start, start + 1000):
            command = self.see(tick, standing())
            if command is not None:
                return tick, command
        raise AssertionError("no command within 10 s")


def test_update_names_the_action_of_the_moment_after_looking() -> None:
    person = Rewinding()
    person.see(100, doing("a"))
    tick, command = person.wait_for_command(110)
    assert tick == 110 + round(TAKES_S / PERIOD_S)
    assert isinstance(command, Correct)
    assert (command.action, command.decision_tick) == ("b", 40)
    assert person.look_back.slip is None


def test_update_is_over_when_the_robot_drives_or_asks() -> None:
    for view in (doing("a"), asking()):
        person = Rewinding()
        person.see(100, doing("a"))
        taught, _ = person.wait_for_command(110)
        resumed, _ = person.wait_for_command(taught + 1)
        assert person.see(resumed + 1, view) is None
        assert person.look_back.over
