"""A key folder that is put back from a backup uses no number twice, and lets no message be replayed."""

import json
import random
import shutil
from pathlib import Path

import pytest
from aiocoap import oscore

from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.pairing import Pairing
from tests.channel.clock import Clock
from tests.channel.sides import Sides, answer_challenge, ask, carried

_MOST_PER_S = 200
"""A device says no more: the robot hears no more of one."""


def _paired_s(folder: Path) -> float:
    return float(json.loads((folder / "settings.json").read_text(encoding="utf-8"))["paired-at"])


class Life:
    """A folder in use over weeks: programs come, send, end or die; copies are kept and put back."""

    def __init__(self, folder: Path, clock: Clock, backups: Path) -> None:
        self.folder = folder
        self.clock = clock
        self.used: list[int] = []
        self._backups = backups
        self._count = 0

    def run(self, seconds: float, per_s: int, *, dies: bool) -> None:
        """Run a program from its start to its end."""
        context = OscoreContext(self.folder, now=self.clock)
        for _ in range(10):
            self.used += [context.new_sequence_number() for _ in range(round(seconds * per_s / 10))]
            self.clock.now_s += seconds / 10
        if dies:
            context.abandon()
        else:
            context.close()

    def back_up(self) -> None:
        shutil.copytree(self.folder, self._backups / str(self._count))
        self._count += 1

    def restore(self, chance: random.Random) -> None:
        """Any of the copies; its files are new ones, with a time of their own."""
        shutil.rmtree(self.folder)
        shutil.copytree(self._backups / str(chance.randrange(self._count)), self.folder, copy_function=shutil.copyfile)


@pytest.mark.parametrize("side", ["robot", "device"])
def test_put_back_a_hundred_times_no_number_is_used_twice(pairing: Pairing, tmp_path: Path, side: str) -> None:
    folder = pairing.teacher if side == "robot" else pairing.device.folder
    chance, clock = random.Random(side), Clock()
    clock.now_s = _paired_s(folder)
    life = Life(folder, clock, tmp_path / "backups")
    life.back_up()
    for _ in range(100):
        for _ in range(chance.randrange(1, 4)):
            life.run(chance.uniform(0.1, 5.0), chance.randrange(_MOST_PER_S), dies=chance.random() < 0.5)
            clock.now_s += 1.0  # systemd's, or a person's
        if chance.random() < 0.5:
            life.back_up()
        if chance.random() < 0.2:
            clock.now_s += chance.uniform(0.0, 30 * 86_400.0)
        life.restore(chance)
    assert len(life.used) > 10_000
    assert len(set(life.used)) == len(life.used)
    assert life.used == sorted(life.used)


def test_a_clock_that_is_set_back_uses_no_number_twice(pairing: Pairing) -> None:
    first_s = _paired_s(pairing.device.folder) + 3600.0
    used, clock = [], Clock()
    for now_s in (first_s, first_s - 86_400.0, 0.0, first_s + 1.0):
        clock.now_s = now_s
        context = OscoreContext(pairing.device.folder, now=clock)
        used += [context.new_sequence_number() for _ in range(5000)]
        context.abandon()
    assert used[0] == 3_600_000
    assert used == sorted(set(used))


def test_restored_robot_executes_no_recorded_request(sides: Sides, pairing: Pairing, tmp_path: Path) -> None:
    device, robot = sides.device, sides.robot
    answer_challenge(device, robot)
    robot.close()
    shutil.copytree(pairing.teacher, tmp_path / "backup")
    robot = OscoreContext(pairing.teacher)
    answer_challenge(device, robot)
    number = device.sender_sequence_number
    assert ask(device, robot, "recorded") == "recorded"
    robot.close()

    shutil.rmtree(pairing.teacher)
    shutil.copytree(tmp_path / "backup", pairing.teacher)
    sides.robot = robot = OscoreContext(pairing.teacher)
    device.sender_sequence_number = number  # what was recorded is bit for bit what was sent
    with pytest.raises(oscore.ReplayErrorWithEcho) as challenge:
        ask(device, robot, "recorded")
    # Its answer has a number of its own: with the request's it would be a second text under one nonce.
    assert carried(challenge.value.to_message()).opt.oscore[0] & 0b111
    device.sender_sequence_number = number + 1
    answer_challenge(device, robot)
