"""The steps that turn wheels, on robots with the mistakes that real ones have."""

import re
from pathlib import Path

import pytest

from hal.bus import open_bus
from hal.guard_reason import GuardReason
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from kurt2rt.checks.commission.checklist import blocking_failures
from kurt2rt.checks.commission.fault import FaultCode, SkipCode, StepFault
from kurt2rt.checks.commission.operator import SKIP, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import StepOutcome
from kurt2rt.checks.commission.stopping import SILENT_S
from kurt2rt.checks.commission.test_stand import RAN_AWAY, UNANSWERED
from kurt2rt.checks.commission.wheel_steps import DRIVE_S
from kurt2rt.checks.commission.wiring import Motion, WheelTrial, parse_seen, wiring_faults
from tests.checks.commission.wired_end import Wiring
from tests.checks.commission.workshop import BASE, Instead, Session, Workshop

LEFT_ENCODER_REVERSED = StepFault.of(FaultCode.ENCODER_REVERSED, side="left")


async def turned(
    tmp_path: Path,
    *steps: str,
    wiring: Wiring | None = None,
    true: Kurt2Settings = BASE,
    instead: Instead = lambda _: None,
) -> Session:
    """Run a session and return it; steps after `modes` begin with a mode that answers."""
    with Workshop(true, wiring) as workshop:
        session = Session(workshop, tmp_path, instead)
        if "modes" not in steps:
            session.knows(speed_mode=SpeedMode.SPEED_CM)
        await session.run(*steps)
    return session


# Which mode answers


async def test_no_mode_answers_on_a_robot_without_its_motors_supply(tmp_path: Path) -> None:
    session = await turned(tmp_path, "modes", "wheels", wiring=Wiring(modes=()))
    assert session.faults("modes") == (StepFault(FaultCode.MODE_MISSING),)
    assert session.skipped("wheels") is SkipCode.NO_SPEED_MODE
    assert [step.name for step in blocking_failures(session.progress)] == ["modes"]


async def test_speed_mode_full_speed_is_measured(tmp_path: Path) -> None:
    quicker = BASE.model_copy(update={"motors": BASE.motors.model_copy(update={"full_speed_m_s": 0.80})})
    session = await turned(tmp_path, "modes", wiring=Wiring(modes=[SpeedMode.SPEED]), true=quicker)
    assert session.progress.findings.full_speed_m_s == pytest.approx(0.80, abs=0.01)


async def test_wheels_that_run_away_are_braked_at_once(tmp_path: Path) -> None:
    with Workshop(wiring=Wiring(wild_modes=[SpeedMode.SPEED_CM])) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("modes")
        assert max(map(abs, workshop.take_peaks())) < 0.6
    assert session.faults("modes") == (StepFault.of(FaultCode.MODE_RAN_AWAY, mode="SPEED_CM", cause=RAN_AWAY),)


async def test_runaway_speed_loops_encoder_is_found_in_open_loop(tmp_path: Path) -> None:
    closed = (SpeedMode.SPEED_CM, SpeedMode.SPEED)
    session = await turned(tmp_path, "modes", "wheels", wiring=Wiring(wild_modes=closed, reversed_encoders=[0]))
    assert session.progress.findings.speed_mode is SpeedMode.RAW
    assert [each.code for each in session.faults("modes")] == [FaultCode.MODE_RAN_AWAY] * 2
    assert session.faults("wheels") == (LEFT_ENCODER_REVERSED,)


async def test_modes_step_other_encoders_name_the_settings_to_change(tmp_path: Path) -> None:
    """The high-speed variant has 5120 ticks in a turn, not 21950."""
    coarse = BASE.model_copy(update={"geometry": BASE.geometry.model_copy(update={"metres_per_tick": 0.000074})})
    session = await turned(tmp_path, "modes", true=coarse)
    (fault,) = session.faults("modes")
    assert fault.code is FaultCode.MODE_SPEED
    assert fault.fields["ratio"] == pytest.approx(0.23, abs=0.005)
    assert fault.fields["ticks"] == pytest.approx(21938, abs=0.5)
    assert session.progress.findings.speed_mode is SpeedMode.SPEED_CM
    assert [step.name for step in blocking_failures(session.progress)] == ["modes"]


async def test_modes_step_skipped_mode_is_left_out(tmp_path: Path) -> None:
    """Skip a mode, for example one that made the controller crash."""

    def leave_out(question: OperatorQuestion) -> str | None:
        return SKIP if question.about is QuestionKind.MOVE and "SPEED_CM" in question.text else None

    session = await turned(tmp_path, "modes", instead=leave_out)
    assert session.measured("modes")[0].startswith("SPEED_CM: ")
    assert session.progress.findings.speed_mode is SpeedMode.SPEED


async def test_a_controller_that_crashes_is_not_driven_on(tmp_path: Path) -> None:
    with Workshop() as workshop:

        def crash(question: OperatorQuestion) -> None:
            if question.about is QuestionKind.MOVE:
                workshop.robot.controller.crashed = True

        session = Session(workshop, tmp_path, crash)
        await session.run("modes")
    assert session.faults("modes") == (StepFault(FaultCode.BRAKE_UNHEARD),)
    assert [question.about for question in session.person.asked].count(QuestionKind.MOVE) == 1


async def test_modes_step_foreign_control_ends_the_drive(tmp_path: Path) -> None:
    with Workshop() as workshop:
        session = Session(workshop, tmp_path)
        workshop.stranger = open_bus(workshop.spec)
        await session.run("modes")
    assert any(GuardReason.FOREIGN_CONTROL in str(each.fields.get("cause")) for each in session.faults("modes"))
    assert session.outcome("modes") is StepOutcome.FAILED


# Sides and directions


@pytest.mark.parametrize(
    ("wiring", "faults"),
    [
        pytest.param(Wiring(motors_exchanged=True), [StepFault(FaultCode.MOTORS_SWAPPED)], id="motors exchanged"),
        pytest.param(Wiring(encoders_exchanged=True), [StepFault(FaultCode.ENCODERS_SWAPPED)], id="encoders exchanged"),
        pytest.param(
            Wiring(motors_exchanged=True, encoders_exchanged=True),
            [StepFault(FaultCode.MOTORS_SWAPPED), StepFault(FaultCode.ENCODERS_SWAPPED)],
            id="both exchanged",
            marks=pytest.mark.deep,
        ),
        pytest.param(
            Wiring(reversed_motors=[0]),
            [StepFault.of(FaultCode.MOTOR_REVERSED, side="left")],
            id="left motor reversed",
            marks=pytest.mark.deep,
        ),
        pytest.param(
            Wiring(reversed_encoders=[1]),
            [StepFault.of(FaultCode.ENCODER_REVERSED, side="right")],
            id="right encoder reversed",
        ),
        pytest.param(
            Wiring(reversed_motors=[0], reversed_encoders=[0]),
            [StepFault.of(FaultCode.MOTOR_REVERSED, side="left"), LEFT_ENCODER_REVERSED],
            id="left reversed twice",
            marks=pytest.mark.deep,
        ),
        pytest.param(
            Wiring(motors_exchanged=True, reversed_motors=[1]),
            [StepFault(FaultCode.MOTORS_SWAPPED), StepFault.of(FaultCode.MOTOR_REVERSED, side="right")],
            id="exchanged and reversed",
        ),
        pytest.param(
            Wiring(dead_encoders=[0]), [StepFault.of(FaultCode.ENCODER_DEAD, side="left")], id="left encoder dead"
        ),
    ],
)
async def test_wiring_faults_names_the_faulty_part(tmp_path: Path, wiring: Wiring, faults: list[StepFault]) -> None:
    session = await turned(tmp_path, "wheels", wiring=wiring)
    assert list(session.faults("wheels")) == faults
    assert [step.name for step in blocking_failures(session.progress)] == ["wheels"]


async def test_wheels_step_dead_encoder_side_turns_only_briefly(tmp_path: Path) -> None:
    """The speed loop of a real controller would turn it faster and faster."""
    asked_s: dict[QuestionKind, list[float]] = {}
    with Workshop(wiring=Wiring(dead_encoders=[0])) as workshop:

        def note(question: OperatorQuestion) -> None:
            asked_s.setdefault(question.about, []).append(workshop.robot.time_s)

        session = Session(workshop, tmp_path, note)
        session.knows(speed_mode=SpeedMode.SPEED_CM)
        await session.run("wheels", "stop")
    took_s = [
        seen_s - move_s for move_s, seen_s in zip(asked_s[QuestionKind.MOVE], asked_s[QuestionKind.SEEN], strict=False)
    ]
    assert max(took_s[:2]) < DRIVE_S < min(took_s[2:])
    assert session.faults("stop") == (StepFault.of(FaultCode.NOTHING_TO_STOP, cause=UNANSWERED),)


async def test_wheels_step_both_exchanged_is_seen_by_the_operator(tmp_path: Path) -> None:
    """Motors and encoders exchanged: the counts look right, and the robot would turn the wrong way."""
    wiring = Wiring(motors_exchanged=True, encoders_exchanged=True)
    session = await turned(tmp_path, "wheels", wiring=wiring)
    first = session.measured("wheels")[0]
    assert re.findall("(?:left|right) forward", first) == ["left forward", "right forward", "left forward"]


async def test_enter_alone_is_no_answer_to_what_was_seen(tmp_path: Path) -> None:
    hurried = iter(["", "y"])

    def hurry(question: OperatorQuestion) -> str | None:
        return next(hurried, None) if question.about is QuestionKind.SEEN else None

    session = await turned(tmp_path, "wheels", instead=hurry)
    (again,) = session.person.lines(Tone.BAD)
    assert again.endswith(" y.")
    assert session.outcome("wheels") is StepOutcome.PASSED


async def test_wheels_step_refuses_yes_if_encoders_disagree(tmp_path: Path) -> None:
    hurried = iter(["y", "dunno", "left", "left forward"])

    def hurry(question: OperatorQuestion) -> str | None:
        return next(hurried, None) if question.about is QuestionKind.SEEN else None

    session = await turned(tmp_path, "wheels", wiring=Wiring(reversed_encoders=[0]), instead=hurry)
    assert len([line for line in session.person.lines(Tone.BAD) if line.endswith(" none.")]) == 3
    assert session.faults("wheels") == (LEFT_ENCODER_REVERSED,)


@pytest.mark.parametrize(
    ("answer", "seen"),
    [
        *(("left forward", Motion(1, 0)), ("r b", Motion(0, -1)), ("both backward", Motion(-1, -1))),
        *(("none", Motion(0, 0)), ("n", Motion(0, 0)), ("", None), ("left", None), ("none forward", None)),
        *(("left sideways", None), ("up forward", None)),
    ],
)
def test_parse_seen_reads_two_words(answer: str, seen: Motion | None) -> None:
    assert parse_seen(answer) == seen


def test_wiring_faults_order_turning_both_names_both_motors() -> None:
    both = [
        WheelTrial(ordered, Motion(sign, sign), Motion(sign, sign))
        for sign in (1, -1)
        for ordered in (Motion(sign, 0), Motion(0, sign))
    ]
    assert [(each.code, each.fields["side"]) for each in wiring_faults(both)] == [
        (FaultCode.MOTOR_ODD, "left"),
        (FaultCode.MOTOR_ODD, "right"),
    ]


# Stopping


async def test_brake_and_watchdog_are_timed(tmp_path: Path) -> None:
    slow = BASE.model_copy(update={"motors": BASE.motors.model_copy(update={"controller_watchdog_s": 0.45})})
    session = await turned(tmp_path, "stop", true=slow)
    assert session.outcome("stop") is StepOutcome.PASSED
    assert session.progress.findings.controller_watchdog_s == pytest.approx(0.45, abs=0.03)
    braked, silent = session.measured("stop")
    assert re.findall(r"\d+ ms", braked) == ["50 ms"]
    assert 420 <= int(re.findall(r"(\d+) ms", silent)[0]) <= 480


async def test_stop_step_endless_controller_is_braked_and_fails(tmp_path: Path) -> None:
    endless = BASE.model_copy(update={"motors": BASE.motors.model_copy(update={"controller_watchdog_s": 9.0})})
    with Workshop(endless) as workshop:
        session = Session(workshop, tmp_path)
        session.knows(speed_mode=SpeedMode.RAW)
        await session.run("stop")
        assert tuple(workshop.robot.wheel_speeds) == (0.0, 0.0)
    assert session.faults("stop") == (StepFault.of(FaultCode.WATCHDOG_MISSING, silent_s=SILENT_S),)
    assert [step.name for step in blocking_failures(session.progress)] == ["stop"]


async def test_modes_step_failed_brake_asks_to_switch_the_motors_off(tmp_path: Path) -> None:
    never = BASE.model_copy(update={"motors": BASE.motors.model_copy(update={"controller_watchdog_s": 9.0})})
    session = await turned(tmp_path, "modes", wiring=Wiring(brake_works=False), true=never)
    assert session.faults("modes") == (StepFault(FaultCode.BRAKE_FAILS),)
    assert session.person.lines(Tone.BAD)[0] == StepFault(FaultCode.BRAKE_FAILS).text
    assert session.outcome("modes") is StepOutcome.FAILED


async def test_stop_step_guard_brake_is_not_taken_for_the_watchdog(tmp_path: Path) -> None:
    never = BASE.model_copy(update={"motors": BASE.motors.model_copy(update={"controller_watchdog_s": 9.0})})
    with Workshop(never) as workshop:
        session = Session(workshop, tmp_path)
        session.knows(speed_mode=SpeedMode.SPEED_CM)
        workshop.stranger = open_bus(workshop.spec)
        workshop.stranger_waits_s = 2 * DRIVE_S + 0.2  # some cycles after the second drive
        await session.run("stop")
    (fault,) = session.faults("stop")
    assert GuardReason.FOREIGN_CONTROL in str(fault.fields["cause"])
    assert session.progress.findings.controller_watchdog_s is None
