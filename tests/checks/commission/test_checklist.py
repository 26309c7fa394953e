"""The checklist from end to end: a robot on a block, an operator who does as asked, and the stored progress."""

from pathlib import Path

import pytest

from config.settings import SettingsError
from hal.codec import SIMULATED_HARDWARE_ID
from hal.kurt2_settings import SpeedMode
from kurt2rt.checks.commission.checklist import STEPS, WORDS, blocking_failures, open_steps, step_named
from kurt2rt.checks.commission.fault import SkipCode
from kurt2rt.checks.commission.operator import SKIP, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Progress, StepOutcome, load_progress
from kurt2rt.checks.commission.report import as_text
from kurt2rt.checks.commission.test_stand import MAXIMUM_SPEED_M_S
from tests.checks.commission.wired_end import Wiring
from tests.checks.commission.workshop import TODAY, Instead, Session, Workshop, leaves_at


async def test_wheels_turn_only_after_the_words_and_a_key(tmp_path: Path) -> None:
    moved: dict[QuestionKind, float] = {}
    asked_before = QuestionKind.BEGIN

    def note(question: OperatorQuestion) -> None:
        """Store the fastest wheel speed since the question before, by that question's kind."""
        nonlocal asked_before
        fastest_m_s = max(map(abs, workshop.take_peaks()))
        moved[asked_before] = max(moved.get(asked_before, 0.0), fastest_m_s)
        asked_before = question.about

    with Workshop() as workshop:
        session = Session(workshop, tmp_path, note)
        session.knows(speed_mode=SpeedMode.SPEED_CM)
        await session.run("identity", "stop", "bumpers")
    assert {about for about, fastest_m_s in moved.items() if fastest_m_s > 0.0} == {QuestionKind.MOVE}
    assert moved[QuestionKind.MOVE] <= MAXIMUM_SPEED_M_S


async def test_without_the_words_no_control_frame_is_sent_at_all(tmp_path: Path) -> None:
    with Workshop() as workshop:
        session = Session(workshop, tmp_path, lambda question: SKIP if question.about is QuestionKind.LIFTED else None)
        await session.run("identity", "modes", "wheels", "stop", "bumpers")
        assert workshop.wiring.controls == 0
    assert {session.outcome(step) for step in ("lifted", "modes", "wheels", "stop")} == {StepOutcome.SKIPPED}
    assert session.skipped("modes") is SkipCode.NOT_LIFTED
    assert session.outcome("bumpers") is StepOutcome.PASSED


async def test_other_words_are_asked_for_again(tmp_path: Path) -> None:
    words = iter(["yes", "", "wheels  up "])
    with Workshop() as workshop:
        session = Session(
            workshop, tmp_path, lambda question: next(words) if question.about is QuestionKind.LIFTED else None
        )
        await session.run("lifted")
    assert [line.split("'")[1::2] for line in session.person.lines(Tone.BAD)] == [["yes", WORDS], ["", WORDS]]
    assert session.outcome("lifted") is StepOutcome.PASSED


async def test_checklist_left_session_brakes_a_standing_robot(tmp_path: Path) -> None:
    with Workshop() as workshop:
        session = Session(workshop, tmp_path, leaves_at(QuestionKind.SEEN))
        session.knows(speed_mode=SpeedMode.SPEED)
        await session.run("wheels")
        workshop.step()
        assert workshop.robot.controller.commands == (0.0, 0.0, True, True)


def skips_what_failed(again: str) -> Instead:
    """Return answers that skip a failed step: when it begins again (`again`: "r"), or at once in another session."""
    failed = not again

    def skip(question: OperatorQuestion) -> str | None:
        nonlocal failed
        if question.about is QuestionKind.AFTER_FAILURE:
            failed = True
            return again
        return SKIP if failed and question.about is QuestionKind.BEGIN else None

    return skip


async def test_failed_step_skipped_later_stays_failed(tmp_path: Path) -> None:
    """Otherwise a robot with a wheel known to turn the wrong way would get its settings file."""
    with Workshop(wiring=Wiring(reversed_motors=(1,))) as workshop:
        session = Session(workshop, tmp_path, skips_what_failed(again="r"))
        session.knows(speed_mode=SpeedMode.SPEED_CM)
        await session.run("wheels")
        assert [step.name for step in blocking_failures(session.progress)] == ["wheels"]
        another_day = Session(workshop, tmp_path, skips_what_failed(again=""))
        another_day.progress = session.progress
        await another_day.run("wheels", "bumpers")
    assert [step.name for step in blocking_failures(another_day.progress)] == ["wheels"]
    (stands,) = another_day.person.lines(Tone.BAD)
    assert stands.startswith(step_named("wheels").title)
    assert f"{StepOutcome.FAILED} on {TODAY}" in stands


async def test_findings_of_another_robot_are_refused(tmp_path: Path) -> None:
    with Workshop() as workshop:
        rehearsal = Session(workshop, tmp_path)
        await rehearsal.run("identity", "modes")
        real = Session(workshop, tmp_path)
        real.progress = rehearsal.progress
        real.knows(hardware_id=7)
        with pytest.raises(SettingsError, match=f"7.*{SIMULATED_HARDWARE_ID}") as refused:
            await real.run("wheels", skipped=("sensors",))
        assert refused.value.where == str(real.path)
        assert real.person.asked == []
        assert "sensors" not in real.progress.steps


async def test_skipped_steps_are_noted_and_do_not_wait_any_longer(tmp_path: Path) -> None:
    with Workshop() as workshop:
        session = Session(workshop, tmp_path)
        await session.run("identity", skipped=("sensors", "infrared"))
        await session.run("lifted", skipped=("identity",))
    assert session.outcome("identity") is StepOutcome.PASSED
    assert [step.name for step in open_steps(session.progress)] == ["modes", "wheels", "stop", "bumpers"]
    assert as_text(session.progress, STEPS).splitlines()[0].endswith(": not passed")


def test_a_damaged_progress_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "robot.json"
    Progress(name="tested", base="kurt2", bus="can0").save(path)
    path.write_text(path.read_text()[:20])
    with pytest.raises(SettingsError) as refused:
        load_progress(path)
    assert refused.value.where == str(path)
