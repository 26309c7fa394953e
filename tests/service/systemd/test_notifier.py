"""Messages to the service manager: they arrive, and a manager that is gone or deaf delays no thread."""

import os
import secrets
from pathlib import Path

from kurt2rt.service.systemd.notifier import Notifier
from tests.service.systemd.manager import Manager, manager


def test_a_life_as_the_manager_hears_it(tmp_path: Path) -> None:
    with manager(tmp_path) as systemd, Notifier(systemd.environment(4.0)) as notifier:
        assert notifier.watchdog_s == 4.0
        notifier.ready()
        notifier.status("waits for\nthe bus")
        notifier.status("waits for the bus")
        notifier.ping()
        notifier.stopping()
        assert systemd.heard() == ["READY=1", "STATUS=waits for the bus", "WATCHDOG=1", "STOPPING=1"]


def test_a_socket_without_a_file_is_found() -> None:
    systemd = Manager(f"@kurt2rt-test-{secrets.token_hex(8)}")
    with Notifier(systemd.environment()) as notifier:
        notifier.ready()
    assert systemd.heard() == ["READY=1"]
    systemd.close()


def test_without_a_manager_nothing_is_said() -> None:
    with Notifier({"WATCHDOG_USEC": "1000"}) as notifier:
        notifier.ready()
        assert notifier.watchdog_s is None
        assert notifier.lost == 0


def test_the_watchdog_of_another_process_is_not_ours(tmp_path: Path) -> None:
    with manager(tmp_path) as systemd:
        others = {**systemd.environment(4.0), "WATCHDOG_PID": str(os.getpid() + 1)}
        with Notifier(others) as notifier:
            assert notifier.watchdog_s is None
