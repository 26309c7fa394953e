"""Startup gate: missing dependencies with their codes, until all are there."""

import errno
from collections.abc import Iterator

import pytest

from hal.bus import BusError
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.service.missing_dependency import DependencyName, MissingDependency, WaitReason
from kurt2rt.service.startup import Dependency, StartError, StartupGate
from kurt2rt.service.systemd.notifier import Notifier

ERRORS: dict[WaitReason, Exception] = {
    WaitReason.FOLDER: StartError("/disk is not there"),
    WaitReason.BUS: BusError("bus 'can0': no such network interface"),
    WaitReason.KNOWLEDGE: KnowledgeError(KnowledgeCode.ANOTHER_WRITER, error="flock"),
    WaitReason.CHANNEL: ChannelError("port 5683 is taken"),
    WaitReason.KEYS: CredentialsError("no key"),
    WaitReason.RECORDING: RecordingError("no room"),
    WaitReason.SYSTEM: OSError(errno.EIO, "Input/output error"),
}


class Gate:
    """Gate with one dependency whose checks raise the given errors, then succeed."""

    def __init__(self, *errors: Exception) -> None:
        self._errors: Iterator[Exception] = iter(errors)
        self.seen: list[tuple[MissingDependency, ...]] = []
        dependency = Dependency(DependencyName.KNOWLEDGE, self._check)
        self.gate = StartupGate([dependency], Notifier({}), self._log, lambda: None, retry_s=0.0)

    def _check(self) -> None:
        error = next(self._errors, None)
        if error is not None:
            raise error

    def _log(self, _: str) -> None:
        self.seen.append(self.gate.missing)


@pytest.mark.parametrize("reason", WaitReason)
async def test_gate_with_a_missing_dependency_has_its_reason(reason: WaitReason) -> None:
    gate = Gate(ERRORS[reason])
    await gate.gate.wait_for_all()
    missing = MissingDependency(DependencyName.KNOWLEDGE, reason, str(ERRORS[reason]))
    assert gate.seen == [(missing,), ()]


async def test_gate_with_one_error_twice_logs_it_once() -> None:
    gate = Gate(BusError("off"), BusError("off"), BusError("down"))
    await gate.gate.wait_for_all()
    assert [each.says for missing in gate.seen for each in missing] == ["off", "down"]


async def test_gate_with_another_error_raises_it() -> None:
    with pytest.raises(ExceptionGroup) as raised:
        await Gate(ZeroDivisionError()).gate.wait_for_all()
    assert raised.group_contains(ZeroDivisionError)
