"""A learner of one's own in a simulated robot."""

from pathlib import Path

import pytest

import kurt2rt
from kurt2rt.core.learner.neighbours import KNearest


class Shy(KNearest):
    """Learner that fails in its second lesson."""

    def lesson(self, *words: object, **more: object) -> None:
        super().lesson(*words, **more)  # type: ignore[arg-type]
        if len(self._actions) > 1:
            raise RuntimeError("two are too many")


def test_learner_decides_in_place_of_the_rlas() -> None:
    with kurt2rt.SimulatedRobot(world="a", seed=1, learner=KNearest) as robot:
        assert robot.question is not None
        robot.teach("back")
        robot.run(seconds=0.2)
        assert robot.action == "back"
        assert isinstance(robot.learner, KNearest)
        assert robot.learner.setting.actions == robot.actions
        assert robot.why() == robot.why(tick=round(robot.seconds * 100))
        earlier = robot.why(tick=1)
    assert "asks" in earlier


def test_learner_keeps_its_lessons_in_a_file_as_of_rlas(tmp_path: Path) -> None:
    with kurt2rt.SimulatedRobot(world="a", seed=1, learner=KNearest) as robot:
        robot.teach("forward")
        saved = robot.save(tmp_path / "lessons.knowledge")
    assert [rla.action for rla in saved.rlas] == ["forward"]


def test_failed_learner_makes_the_robot_stand() -> None:
    with kurt2rt.SimulatedRobot(world="a", seed=1, learner=Shy) as robot:
        robot.teach("forward")
        robot.teach("back")
        robot.step()
        assert robot.action is None
        assert "two are too many" in robot.why()


def test_robot_without_a_learner_has_none(tmp_path: Path) -> None:
    with kurt2rt.SimulatedRobot(world="a", seed=1) as robot:
        assert robot.learner is None
        robot.teach("forward")
        saved = robot.save(tmp_path / "lessons.knowledge")
    with pytest.raises(kurt2rt.Error, match="leave out learner or knowledge"):
        kurt2rt.SimulatedRobot(learner=KNearest, knowledge=saved)
    with pytest.raises(kurt2rt.Error, match="leave out learner or record"):
        kurt2rt.SimulatedRobot(learner=KNearest, record=tmp_path)


def test_setting_of_an_unknown_task_is_one_clear_error() -> None:
    with pytest.raises(kurt2rt.Error, match="no such name in tasks"):
        kurt2rt.learner_setting("walling")
