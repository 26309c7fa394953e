"""Scripted teachers that skip ticks give the commands that they give tick by tick."""

import random
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.robot_settings import load_robot
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.core.teaching.commands import Command
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.build import build_teacher

ROBOT = load_robot()
ACTIONS = ("forward", "spin_right", "bear_left")
FREE, WALL, CLOSE = (tuple(row) for row in ([90] * 18, [220] * 18, [520] * 18))


@dataclass
class Course:
    """Views of a robot that drives on whatever its teacher says, with what is right in each."""

    views: list[TeacherView]
    right: list[str]
    place: int = -1
    """Newest view that the teacher has seen."""

    @property
    def ticks(self) -> int:
        return len(self.views) - 1 - self.place

    @property
    def until_question(self) -> int:
        return self._until([view.asking for view in self.views])

    @property
    def until_difference(self) -> int:
        pairs = zip(self.views, self.right, strict=True)
        return self._until([view.asking or (view.driving and view.action != right) for view, right in pairs])

    @property
    def until_change(self) -> int:
        kinds = [(view.action, right) for view, right in zip(self.views, self.right, strict=True)]
        before = [*kinds[:1], *kinds]
        return self._until([kind != last for kind, last in zip(kinds, before, strict=False)])

    def _until(self, flags: list[bool]) -> int:
        rest = flags[self.place + 1 :]
        return rest.index(True) if True in rest else len(rest)


def course(task: TaskSettings, seed: int, ticks: int) -> Course:
    """Return views in runs of random length: driving by some action, asking, or standing."""
    chance, policy = random.Random(seed), task.policy.build(ROBOT.infrared)
    views: list[TeacherView] = []
    while len(views) < ticks:
        counts, kind = chance.choice((FREE, WALL, CLOSE)), chance.random()
        action = chance.choice((*ACTIONS, policy.choose(counts, ""))) if kind < 0.8 else None
        for _ in range(chance.choice((1, 2, 7, 30, 150))):
            tick = len(views) + 1
            views.append(TeacherView(kind > 0.9, action is not None, action, counts, tick=tick, touching=kind < 0.1))
    return Course(views, [policy.choose(view.infrared_counts, "") for view in views])


def teacher_of(task: TaskSettings, phase: Phase) -> BasicTeacher:
    teacher = build_teacher(task, ROBOT, ACTIONS, seed=1, session="s")
    teacher.begin_phase(phase)
    return teacher


@given(seed=st.integers(0, 2**32 - 1))
@pytest.mark.parametrize("phase", [Phase.SUPERVISED, Phase.CORRECTIONS])
@pytest.mark.parametrize("name", ["superhuman", "answers_only", "ordinary", "slow"])
def test_teacher_who_skips_gives_the_same_commands(name: str, phase: Phase, seed: int) -> None:
    task = taught_by(load_task("wall_following"), load_teacher(name))
    drive = course(task, seed, 1500)
    each_tick, skips = teacher_of(task, phase), teacher_of(task, phase)
    expected = [(view.tick, each_tick.update(view)) for view in drive.views]
    given_: list[tuple[int, Command | None]] = []
    visits = 0
    while drive.ticks:
        drive.place += skips.skip(drive)
        if not drive.ticks:
            break
        drive.place += 1
        visits += 1
        view = drive.views[drive.place]
        given_.append((view.tick, skips.update(view)))
    assert [each for each in given_ if each[1]] == [each for each in expected if each[1]]
    assert visits < len(drive.views)
