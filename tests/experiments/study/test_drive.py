"""Drives of taught robots, judged by the drive of the teacher's policy."""

import anyio
import pytest

from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.study import drive as module
from kurt2rt.experiments.study.drive import Drive, Examiner
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.results import exam_result
from tests.experiments.transfer.outcomes import drive


@pytest.mark.parametrize(
    ("policy", "collisions", "verdict"),
    [
        ("right", 0, ExamVerdict.PASSED),
        ("right", 1, ExamVerdict.FAILED),
        ("collided", 0, ExamVerdict.NOT_JUDGED),
        ("stuck", 0, ExamVerdict.NOT_JUDGED),
    ],
)
def test_policy_that_does_not_pass_judges_no_robot(
    policy: str, collisions: int, verdict: ExamVerdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def drives(*_: object) -> list[object]:
        return [exam_result(laps=2.0, collisions=collisions)]

    monkeypatch.setattr(module, "run_drives", drives)
    examiner = Examiner(STAGE, ROBOT, short_task(), "a", 1, lambda *_: None)
    assert anyio.run(examiner.examine, drive(policy), ()).verdict is verdict


def test_policy_and_pupil_start_from_one_place() -> None:
    examiner = Examiner(STAGE, ROBOT, short_task(exam_s=2.0), "a", 1, lambda *_: None)
    first, again = (anyio.run(examiner.drive_policy) for _ in range(2))
    assert first == again
    assert isinstance(first, Drive)
