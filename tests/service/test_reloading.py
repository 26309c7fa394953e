"""Reload of settings while the robot runs: changeable ones are applied, the others are named and stay."""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import anyio
import pytest
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from kurt2rt.service.config_reload import ConfigReloader
from kurt2rt.service.settings import ServiceSettings, load_service, with_unit_priority
from kurt2rt.service.systemd.notifier import Notifier
from tests.service.systemd.manager import manager

SHIPPED = CONFIG_DIR / "runtime" / "default.yaml"


class Program:
    """A program whose settings stand in a file."""

    def __init__(self, path: Path, notifier: Notifier) -> None:
        self._path = path
        self.change()
        self.told: list[str] = []
        self.taken: list[ServiceSettings] = []
        self.reloading = ConfigReloader(
            lambda: load_service(str(path)), load_service(str(path)), notifier, self.told.append
        )

    def change(self, **changes: object) -> None:
        settings = yaml.safe_load(SHIPPED.read_text(encoding="utf-8"))
        self._path.write_text(yaml.safe_dump({**settings, **changes}), encoding="utf-8")

    async def reload(self, lines: Callable[[], None]) -> None:
        """Ask from another thread, as the one that hears signals does, and wait for a line."""
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(self.reloading.serve, self.taken.append)
            before = len(self.told)
            await anyio.to_thread.run_sync(lines)
            with anyio.fail_after(60):
                while len(self.told) == before:  # noqa: ASYNC110 - a list does not notify
                    await anyio.sleep(0.001)
            tasks.cancel_scope.cancel()


async def test_config_reload_applies_or_postpones_each_key(tmp_path: Path) -> None:
    with ExitStack() as around:
        systemd = around.enter_context(manager(tmp_path))
        program = Program(tmp_path / "mine.yaml", around.enter_context(Notifier(systemd.environment())))
        program.change(status_period_s=5.0, port=9, task="circle")
        await program.reload(program.reloading.request)
        assert [line.partition(": ")[2] for line in program.told] == ["status_period_s", "task, port"]
        (now,) = program.taken
        assert (now.status_period_s, now.port, now.task) == (5.0, 5683, "wall_following")
        (reloading, stamp, ready) = systemd.heard()
        assert (reloading, ready) == ("RELOADING=1", "READY=1")
        assert int(stamp.removeprefix("MONOTONIC_USEC=")) > 0


async def test_a_file_that_is_wrong_changes_nothing(tmp_path: Path) -> None:
    with Notifier({}) as notifier:
        program = Program(tmp_path / "mine.yaml", notifier)
        program.change(status_period_s=0.0)
        await program.reload(program.reloading.request)
        assert program.taken == []
        assert "status_period_s" in program.told[0]
        (tmp_path / "mine.yaml").unlink()
        await program.reload(program.reloading.request)
        assert program.taken == []
        assert len(program.told) == 2


async def test_config_reload_requested_before_serve_is_done(tmp_path: Path) -> None:
    with Notifier({}) as notifier:
        program = Program(tmp_path / "mine.yaml", notifier)
        asking = threading.Thread(target=program.reloading.request)
        asking.start()
        asking.join()
        await program.reload(lambda: None)
        assert len(program.told) == 1
        assert program.taken == [load_service()]


def test_settings_auto_priority_is_for_units_only() -> None:
    shipped = load_service()
    assert (shipped.priority, with_unit_priority(shipped).priority) == (0, 20)
    for given in (0, 5):
        mine = shipped.model_copy(update={"real_time_priority": given})
        assert (mine.priority, with_unit_priority(mine).priority) == (given, given)


@pytest.mark.parametrize("given", ["fast", 81, -1, 1.5, True, None])
def test_a_priority_that_is_none_is_told_in_one_line(tmp_path: Path, given: object) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({**yaml.safe_load(SHIPPED.read_text()), "real_time_priority": given}))
    with pytest.raises(SettingsError, match=r"real_time_priority: .* auto.* 0 to 80") as told:
        load_service(str(path))
    assert "\n" not in str(told.value)
