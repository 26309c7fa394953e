"""Observer at the robot's end of a bus that judges by the frames alone whether the robot should stand."""

import math

import can
import numpy as np

from hal.bus import CONTROL_ID
from hal.robot import GuardResult
from hal.robot_settings import BumperEnd
from tests.hal.control_bytes import BRAKE, read_control
from tests.hal.helpers import CODEC, INFRARED_FRAMES, ROBOT, TICK_S

_BUS_OFF = 0x40
_RESOLUTION_M_S = 0.01
_SLACK = 1e-6


class Onlooker:
    """A tap (hal.tap.Tap) with an opinion of its own; it knows the wire's layout, and nothing of Kurt2."""

    def __init__(self) -> None:
        self.frames = 0
        self.moved = 0
        """Ticks in which a wheel was told to turn."""
        self.stands_for: dict[str, int] = {}
        """In how many ticks it should have stood, and why."""
        channels = {sensor.channel for sensor in ROBOT.infrared.sensors}
        self._infrared = {
            CODEC.message(name).frame_id: [
                at for at, signal in enumerate(CODEC.message(name).signals) if signal in channels
            ]
            for name in INFRARED_FRAMES
        }
        self._encoder_id, self._bumper_id = CODEC.message("ENCODER").frame_id, CODEC.message("BUMPERC").frame_id
        self._heard_at_s = dict.fromkeys([*self._infrared, self._encoder_id, self._bumper_id], -math.inf)
        self._bumpers = 0
        self._heard: list[tuple[can.Message, float]] = []
        self._sent: list[bytes] = []
        self._before_m_s = (0.0, 0.0)
        self._braked_before = True

    def on_rx(self, frame: can.Message, age_s: float) -> None:
        self._heard.append((frame, age_s))

    def on_tx(self, frame: can.Message) -> None:
        assert (frame.arbitration_id, frame.is_extended_id, len(frame.data)) == (CONTROL_ID, False, 8)
        self._sent.append(bytes(frame.data))

    def judge(self, now_s: float, grant: GuardResult) -> None:
        """Look at what came and went in a tick."""
        alarm = self._take_in(now_s)
        self.frames += len(self._heard)
        heard, sent = self._heard, self._sent
        self._heard, self._sent = [], []
        assert sent, "a tick without a CONTROL frame"
        payload = np.frombuffer(sent[-1], dtype=np.uint8).reshape(1, 8)
        frames = read_control(ROBOT, payload)
        braked = bool(frames.brakes[0])
        assert braked or frames.set_points[0], f"neither a brake nor a set point: {sent[-1].hex()}"
        assert all(data == bytes(BRAKE) for data in sent[:-1]), "more than one set point in a tick"
        told = (0.0, 0.0) if braked else (float(frames.left.speed_m_s[0]), float(frames.right.speed_m_s[0]))
        assert grant.wheel_speeds == (told[0], told[1])
        assert not alarm or braked, f"no brake, but {alarm}: {[str(frame) for frame, _ in heard]}"
        why = alarm or self._silent(now_s)
        if why:
            self.stands_for[why] = self.stands_for.get(why, 0) + 1
            assert told == (0.0, 0.0), f"drives, but {why}"
        # The first set point after a brake may use what a late tick may: two cycles' worth.
        self._check_motion(told, 2 * TICK_S if self._braked_before else TICK_S)
        self._braked_before = braked
        self.moved += told != (0.0, 0.0)

    def _take_in(self, now_s: float) -> str:
        """Ages as the frames say; returns what must stop the robot at once."""
        alarm = ""
        for frame, age_s in self._heard:
            if frame.is_error_frame:
                alarm = "the bus is off" if frame.arbitration_id & _BUS_OFF else alarm
                continue
            if frame.is_extended_id or frame.is_remote_frame:
                continue
            frame_id, data = frame.arbitration_id, bytes(frame.data)
            if frame_id == CONTROL_ID:
                alarm = "another node sends CONTROL"
            elif frame_id in self._infrared:
                good = len(data) >= 8 and all(data[2 * at] < 4 for at in self._infrared[frame_id])
                self._heard_at_s[frame_id] = now_s - age_s if good else self._heard_at_s[frame_id]
            elif frame_id == self._encoder_id and len(data) >= 4:
                self._heard_at_s[frame_id] = now_s - age_s
            elif frame_id == self._bumper_id and len(data) >= 2:
                self._heard_at_s[frame_id] = now_s - age_s
                self._bumpers = data[0]
        return alarm

    def _silent(self, now_s: float) -> str:
        limits = ROBOT.guard
        ages_s = {frame_id: now_s - heard_at_s - _SLACK for frame_id, heard_at_s in self._heard_at_s.items()}
        if max(ages_s[frame_id] for frame_id in self._infrared) > limits.stale_infrared_s:
            return "infra-red readings are old"
        if ages_s[self._encoder_id] > limits.stale_encoder_s:
            return "encoder readings are old"
        if ages_s[self._bumper_id] > limits.stale_bumper_s:
            return "bumper readings are old"
        return ""

    def _check_motion(self, told: tuple[float, float], elapsed_s: float) -> None:
        limits = ROBOT.guard
        for was, now in zip(self._before_m_s, told, strict=True):
            assert abs(now) <= limits.maximum_speed_m_s + _SLACK
            grown = abs(now) - (abs(was) if was * now > 0.0 else 0.0)
            assert grown <= limits.acceleration_m_s2 * elapsed_s + _RESOLUTION_M_S + _SLACK
            if now != 0.0:
                assert -grown <= limits.braking_m_s2 * elapsed_s + _RESOLUTION_M_S + _SLACK
        for bit, bumper in enumerate(ROBOT.bumpers):
            if self._bumpers >> bit & 1:
                assert all(now <= 0.0 if bumper.end is BumperEnd.FRONT else now >= 0.0 for now in told)
        self._before_m_s = told
