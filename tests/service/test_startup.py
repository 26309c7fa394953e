"""Startup gate: missing dependencies with their errors, until all are there."""

import errno
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from config.settings import SettingsError
from hal.bus import BusError
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.service.settings import load_service, with_unit_priority
from kurt2rt.service.startup import Dependency, DependencyName, StartError, StartupGate
from kurt2rt.service.systemd.notifier import Notifier

ERRORS = (
    StartError("/disk is not there"),
    BusError("bus 'can0': no such network interface"),
    KnowledgeError(KnowledgeCode.ANOTHER_WRITER, error="flock"),
    ChannelError("port 5683 is taken"),
    CredentialsError("no key"),
    RecordingError("no room"),
    OSError(errno.EIO, "Input/output error"),
)


async def errors_of(*errors: Exception) -> list[str]:
    """Return the missing dependency's errors at each line of the log, of checks that raise these and then succeed."""
    waiting: Iterator[Exception] = iter(errors)
    seen: list[str] = []

    def check() -> None:
        error = next(waiting, None)
        if error is not None:
            raise error

    dependency = Dependency(DependencyName.KNOWLEDGE, check)
    gate = StartupGate(
        [dependency], Notifier({}), lambda _: seen.extend(gate.missing.values()), lambda: None, retry_s=0.0
    )
    await gate.wait_for_all()
    assert gate.missing == {}
    return seen


async def test_gate_waits_for_each_error_and_logs_it_once() -> None:
    each_twice = [error for error in ERRORS for _ in (1, 2)]
    assert await errors_of(*each_twice) == list(map(str, ERRORS))


async def test_gate_with_another_error_raises_it() -> None:
    with pytest.raises(ExceptionGroup) as raised:
        await errors_of(ZeroDivisionError())
    assert raised.group_contains(ZeroDivisionError)


@pytest.mark.parametrize("given", ["fast", 81, -1, 1.5])
def test_priority_that_is_none_is_told_in_one_line(tmp_path: Path, given: object) -> None:
    shipped = load_service()
    assert (shipped.priority, with_unit_priority(shipped).priority) == (0, 20)  # auto
    content = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({**content, "real_time_priority": given}), encoding="utf-8")
    with pytest.raises(SettingsError, match=r"real_time_priority: .* auto.* 0 to 80"):
        load_service(str(path))
