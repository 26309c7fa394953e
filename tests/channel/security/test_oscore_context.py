import json
import random
import threading
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from aiocoap import oscore

from kurt2rt.channel.security.context_folder import ContextFolder, CredentialsError
from kurt2rt.channel.security.oscore_context import CHUNK, OscoreContext
from kurt2rt.channel.security.pairing import Pairing, renew
from tests.channel.sides import Sides, answer_challenge, ask, ask_until_fresh, sequence_of
from tests.cli.helpers import ROOT, started
from tests.patience import PATIENCE_S


def opened(folder: Path, chunk: int = CHUNK) -> OscoreContext:
    """Open a context with a clock before the pairing, so that the stored numbers count."""
    return OscoreContext(folder, chunk=chunk, now=lambda: 0.0)


class SlowDisk:
    """Each store waits until the test lets it through; counts those that were made in the test's own thread."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.may_store = threading.Event()
        self.may_store.set()
        self.asked = threading.Event()
        self.in_place = 0
        self.broken = False
        write = ContextFolder.write_sequence
        here = threading.get_ident()

        def slow(folder: ContextFolder, next_to_send: int) -> None:
            self.in_place += threading.get_ident() == here
            self.asked.set()
            assert self.may_store.wait(timeout=PATIENCE_S)
            if self.broken:
                raise OSError(28, "No space left on device")
            write(folder, next_to_send)

        monkeypatch.setattr(ContextFolder, "write_sequence", slow)

    def wait(self) -> None:
        """Wait until no thread stores any more."""
        for thread in threading.enumerate():
            if thread.name.startswith("oscore"):
                thread.join(timeout=PATIENCE_S)


def test_a_number_that_is_not_stored_yet_is_not_given_out(pairing: Pairing, monkeypatch: pytest.MonkeyPatch) -> None:
    context = opened(pairing.teacher, chunk=10)
    disk = SlowDisk(monkeypatch)
    disk.may_store.clear()
    for _ in range(10):
        context.new_sequence_number()
    assert disk.asked.wait(timeout=PATIENCE_S)
    threading.Timer(0.05, disk.may_store.set).start()
    assert context.new_sequence_number() == 10  # waited for the thread
    assert json.loads(sequence_of(pairing.teacher))["next-to-send"] == 20
    assert disk.in_place == 0
    context.close()


def test_a_full_disk_is_told_and_the_last_number_is_not_passed(
    pairing: Pairing, monkeypatch: pytest.MonkeyPatch
) -> None:
    context = opened(pairing.teacher, chunk=10)
    disk = SlowDisk(monkeypatch)
    disk.broken = True
    for _ in range(10):
        context.new_sequence_number()
    disk.wait()
    with pytest.raises(oscore.ContextUnavailable, match="No space left"):
        context.new_sequence_number()
    assert "No space left" in context.trouble
    disk.broken = False
    assert context.new_sequence_number() == 11  # the one that was refused was not sent
    context.abandon()


@pytest.mark.parametrize("kills", [2, pytest.param(60, marks=pytest.mark.deep)])
def test_killed_over_and_over_it_never_uses_a_number_twice(pairing: Pairing, kills: int) -> None:
    chance = random.Random(2004)
    used: list[int] = []
    folder = pairing.device.folder
    for _ in range(kills):
        chunk = str(chance.randint(1, 9))
        with started("tests.channel.send_until_killed", str(folder), chunk, folder=ROOT) as child:
            assert child.stdout is not None
            assert child.stderr is not None
            said = [child.stdout.readline() for _ in range(chance.randint(1, 60))]
            child.kill()
            said += child.stdout.readlines()
            assert child.stderr.read() == ""
        used += [int(line) for line in said if line.endswith("\n")]
    assert used == sorted(set(used))
    with closing(Sides(pairing)) as with_state_lost:
        assert with_state_lost.device.sender_sequence_number > used[-1]
        assert ask_until_fresh(with_state_lost.device, with_state_lost.robot, "same teacher") == "same teacher"


def test_context_after_kill_refuses_replay_until_challenge(sides: Sides, pairing: Pairing) -> None:
    answer_challenge(sides.device, sides.robot)
    sides.robot.abandon()  # leaves the folder as a kill does: the reservation, and a window that is not known
    sides.robot = OscoreContext(pairing.teacher)
    with pytest.raises(oscore.ReplayErrorWithEcho):
        ask(sides.device, sides.robot, "forward")
    assert ask_until_fresh(sides.device, sides.robot, "left") == "left"
    assert ask(sides.device, sides.robot, "right") == "right"


def test_a_closed_context_sends_nothing_more(pairing: Pairing) -> None:
    context = OscoreContext(pairing.teacher)
    context.close()
    context.close()
    with pytest.raises(oscore.ContextUnavailable, match="revoked"):
        context.new_sequence_number()


def test_context_of_old_pairing_writes_not_into_renewed(pairing: Pairing, tmp_path: Path) -> None:
    old = OscoreContext(pairing.teacher, chunk=10)
    renewed = renew(tmp_path / "teachers", tmp_path / "devices", "phone")
    before = sequence_of(renewed.teacher)
    for _ in range(9):
        old.new_sequence_number()
    old.close()
    assert sequence_of(renewed.teacher) == before


def test_a_folder_that_is_not_there_is_told_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(CredentialsError, match="kurt2rt pair absent"):
        OscoreContext(tmp_path / "absent")


def _write(name: str, text: str) -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        (folder / name).write_text(text, encoding="utf-8")

    return damage


@pytest.mark.parametrize(
    "damage",
    [
        _write("sequence.json", ""),
        _write("sequence.json", "[]"),
        _write("sequence.json", '{"next-to-send": -1, "received": "unknown"}'),
        _write("sequence.json", '{"next-to-send": 1}'),
        _write("sequence.json", '{"next-to-send": 1, "received": 5}'),
        _write("settings.json", '{"sender-id_hex": "01", "recipient-id_hex": "02", "paired-at": "today"}'),
        _write("settings.json", '{"sender-id_hex": "01", "recipient-id_hex": "02", "paired-at": []}'),
        _write("settings.json", '{"sender-id_hex": "01", "recipient-id_hex": "02"}'),
        _write("secret.json", '{"secret_hex": "no hex"}'),
        _write("secret.json", "{}"),
        _write("settings.json", '{"sender-id_hex": "00112233445566778899"}'),
        lambda folder: (folder / "secret.json").unlink(),
        lambda folder: (folder / "sequence.json").unlink(),
    ],
)
def test_a_damaged_pairing_is_refused_in_one_line(pairing: Pairing, damage: Callable[[Path], None]) -> None:
    damage(pairing.teacher)
    with pytest.raises(CredentialsError) as refused:
        OscoreContext(pairing.teacher)
    assert str(refused.value).startswith(str(pairing.teacher))
    assert str(refused.value).endswith("kurt2rt pair phone --renew")
    assert "\n" not in str(refused.value)
    with pytest.raises(CredentialsError, match="renew"):  # and it let go of the lock
        OscoreContext(pairing.teacher)
