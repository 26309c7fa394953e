"""Step: which of the firmware's speed modes answers?"""

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings, SpeedMode
from kurt2rt.commission.bench import RAN_AWAY, Bench, Drive
from kurt2rt.commission.findings import Findings
from kurt2rt.commission.moving import (
    DRIVE_S,
    TEST_SPEED_M_S,
    TURNS_SHARE,
    leave_to_move,
    rests,
    steady,
    why_it_stood,
)
from kurt2rt.commission.person import SkippedError
from kurt2rt.commission.step import Result

PREFERENCE = (SpeedMode.SPEED_CM, SpeedMode.SPEED, SpeedMode.RAW)
"""Closed loops in the controller before the open one; SPEED_CM is the finer of the two."""
_ACCURATE = (0.6, 1.6)
"""Measured speed against the set point's; outside of it the mode answers, but by another measure."""
_AFTER_RUNAWAY = "an encoder that counts the wrong way does that: go on, step wheels tells which; then repeat this one"


class SpeedModesStep:
    """Tries each mode with a small set point, forward and backward, and watches the encoders."""

    name = "modes"
    title = "Which speed mode answers?"
    why = "Old firmware lacks SPEED_CM, newer firmware may lack SPEED, and there is no acknowledge: only wheels tell."
    what_to_do = f"Each mode turns all wheels at {TEST_SPEED_M_S} m/s, {DRIVE_S} s forward and {DRIVE_S} s backward."
    moves = True
    bars_driving = True

    async def take(self, bench: Bench, findings: Findings) -> Result:
        """Try all three; the first of the preference that answers is the robot's."""
        result = Result(findings.model_copy(update={"speed_mode": None, "full_speed_m_s": None}))
        answering: list[SpeedMode] = []
        for mode in PREFERENCE:
            try:
                await leave_to_move(bench, f"All wheels turn forward, then backward: mode {mode}.")
            except SkippedError:
                result.tell(bench, f"{mode}: left out")
                continue
            drives: list[Drive] = []
            for sign in (1.0, -1.0):
                wanted = WheelSpeeds(sign * TEST_SPEED_M_S, sign * TEST_SPEED_M_S)
                drives.append(await bench.drive(mode, wanted, DRIVE_S))
                if not rests(bench, drives[-1], result):
                    return result
                if why_it_stood(drives[-1]) is not None:
                    break
            said = _judge(mode, drives, bench.settings, result)
            result.tell(bench, said)
            if all(_turned(drive, bench.settings) for drive in drives):
                answering.append(mode)
        if answering:
            result.findings = result.findings.model_copy(update={"speed_mode": answering[0]})
            result.note(f"the robot will be driven in {answering[0]}")
        else:
            result.to_do.append("No speed mode answers: check the motors' supply, their fuses and the emergency switch")
        return result


def _turned(drive: Drive, robot: RobotSettings) -> bool:
    speeds = steady(drive, robot)
    return why_it_stood(drive) is None and max(map(abs, speeds)) >= TURNS_SHARE * TEST_SPEED_M_S


def _judge(mode: SpeedMode, drives: list[Drive], robot: RobotSettings, result: Result) -> str:
    """One line of what came; notes in the result what is wrong, and how fast 100 % is in SPEED mode."""
    for drive in drives:
        stood = why_it_stood(drive)
        if stood == RAN_AWAY:
            result.to_do.append(f"{mode}: {RAN_AWAY} and were braked; {_AFTER_RUNAWAY}")
            return f"{mode}: {RAN_AWAY}"
        if stood is not None:
            result.to_do.append(f"{mode}: the wheels were kept from turning: {stood}")
            return f"{mode}: not tried out, {stood}"
    if not any(_turned(drive, robot) for drive in drives):
        return f"{mode}: no answer within {DRIVE_S} s"
    if not all(_turned(drive, robot) for drive in drives):
        return f"{mode}: answers in one direction only, so it is not used"
    forward, backward = (steady(drive, robot) for drive in drives)
    measured_m_s = sum(map(abs, (*forward, *backward))) / 4
    granted_m_s = abs(drives[0].granted.left_m_s)
    share = measured_m_s / granted_m_s
    said = f"{mode}: answers, {measured_m_s:.3f} m/s by the encoders for a set point of {granted_m_s:.3f} m/s"
    if mode is SpeedMode.SPEED:
        full_speed_m_s = round(robot.motors.full_speed_m_s * share, 3)
        result.findings = result.findings.model_copy(update={"full_speed_m_s": full_speed_m_s})
        said += f"; 100 % is {full_speed_m_s:.2f} m/s"
    elif not _ACCURATE[0] <= share <= _ACCURATE[1]:
        said += "; that is another measure than expected: check geometry.metres_per_tick and motors.raw_speed_m_s"
    return said
